//! A closed box whose walls all emit and reflect alike: the radiance inside is known in closed form.

use glam::Vec3;

use super::builder::{Builder, SceneBuilder};
use crate::{Camera, Material, Scene};

/// Emitted radiance of the walls in W/(m2 sr).
const EMISSION: f32 = 0.5;
/// Reflectance of the walls.
const ALBEDO: f32 = 0.5;

/// A cube of 2 m about the origin. Every wall emits 0.5 W/(m2 sr) and reflects half of what arrives, so the radiance
/// everywhere inside, in every direction, is `emission / (1 - albedo)` = 1; `0.5` of it is direct.
pub fn furnace(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let wall = Material { emission: Vec3::splat(EMISSION), ..Material::matte("wall", Vec3::splat(ALBEDO)) };
    let wall = scene.material(wall);
    let steps = 1 << detail;
    let mut walls = Builder::default();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [axis, -axis] {
            // `u x v` points inwards.
            let u = Vec3::new(axis.y, axis.z, axis.x);
            let v = -side.cross(u);
            walls.grid(side - u - v, 2.0 * u, 2.0 * v, [steps; 2], Vec3::ONE);
        }
    }
    scene.add("walls", walls, wall);
    scene.camera(Camera::look("inside", Vec3::new(0.0, 0.0, 0.8), Vec3::new(0.0, 0.0, -1.0), 60.0));
    scene.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_face_inwards_and_close_the_cube() {
        let scene = furnace(1);
        let mesh = &scene.meshes[0];
        let mut area = 0.0;
        for t in &mesh.indices {
            let [a, b, c] = t.map(|i| Vec3::from(mesh.positions[i as usize]));
            let n = (b - a).cross(c - a);
            area += 0.5 * n.length();
            assert!(n.dot(a) < 0.0 && n.normalize_or_zero().dot(mesh.normals[t[0] as usize].into()) > 0.999);
        }
        assert!((area - 24.0).abs() < 1e-4);
        assert_eq!(scene.bounds().size(), Vec3::splat(2.0));
    }
}
