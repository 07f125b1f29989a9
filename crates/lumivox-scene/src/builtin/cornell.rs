//! The Cornell box, lit by a spot under its ceiling.

use glam::Vec3;

use super::builder::{Builder, SceneBuilder};
use crate::{Camera, Light, Material, Scene, SpotFalloff};

/// The classic five-walled box: x -1..1, y 0..2, z -1..1 metres, open towards +z. White floor, ceiling and back wall,
/// red on the left, green on the right, a tall and a short block, a wide spot light in the middle of the ceiling.
pub fn cornell(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let white = scene.material(Material::matte("white", Vec3::splat(0.73)));
    let red = scene.material(Material::matte("red", Vec3::new(0.63, 0.06, 0.05)));
    let green = scene.material(Material::matte("green", Vec3::new(0.14, 0.45, 0.09)));

    let (x, y, z) = (2.0 * Vec3::X, 2.0 * Vec3::Y, 2.0 * Vec3::Z);
    let low = Vec3::new(-1.0, 0.0, -1.0);
    let steps = [1 << detail; 2];
    for (name, material, origin, u, v) in [
        ("floor", white, low, z, x),
        ("ceiling", white, low + y, x, z),
        ("back", white, low, x, y),
        ("left", red, low, y, z),
        ("right", green, low + x, z, y),
    ] {
        let mut wall = Builder::default();
        wall.grid(origin, u, v, steps, Vec3::ONE);
        scene.add(name, wall, material);
    }
    for (name, center, size, degrees) in [
        ("tall block", Vec3::new(-0.33, 0.6, -0.32), Vec3::new(0.6, 1.2, 0.6), 17.0f32),
        ("short block", Vec3::new(0.33, 0.3, 0.3), Vec3::splat(0.6), -17.0),
    ] {
        let mut block = Builder::default();
        block.block(center, size, degrees.to_radians(), (1 << detail) / 2, Vec3::ONE);
        scene.add(name, block, white);
    }
    scene.light(Light::Spot {
        position: Vec3::new(0.0, 1.96, 0.0),
        direction: Vec3::NEG_Y,
        intensity: Vec3::new(8.0, 7.0, 5.5),
        beam: 60f32.to_radians(),
        cutoff: 80f32.to_radians(),
        falloff: SpotFalloff::LinearAngle,
    });
    scene.camera(Camera::look("front", Vec3::new(0.0, 1.0, 3.4), Vec3::Y, 39.3));
    scene.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_has_its_size_and_the_walls_face_inwards() {
        let scene = cornell(2);
        let bounds = scene.bounds();
        assert!((bounds.min - Vec3::new(-1.0, 0.0, -1.0)).length() < 1e-6);
        assert!((bounds.max - Vec3::new(1.0, 2.0, 1.0)).length() < 1e-6);
        for mesh in &scene.meshes[..5] {
            let to_middle = Vec3::Y - Vec3::from(mesh.positions[0]);
            assert!(to_middle.dot(mesh.normals[0].into()) > 0.9, "{}", mesh.name);
        }
        assert_eq!(cornell(0).triangle_count(), 5 * 2 + 2 * 12);
    }
}
