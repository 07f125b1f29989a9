//! A broad tree on a meadow: wood as tapered tubes, leaves as alpha-masked cards.

mod leaves;
mod wood;

use glam::{Mat4, Vec3, Vec4};

use super::builder::{Builder, SceneBuilder, pick};
use crate::{AlphaMode, Camera, Light, Material, Scene};

/// A tree 9 m high with 160 000 leaves, each a card of two triangles whose texture says where the leaf is: opacity 0 or 1,
/// to be cut at 0.5. At details 0 and 1 there are fewer leaves, which are larger for it; from detail 2 on all of them, and
/// the wood and the ground get finer. Cards have no thickness; all else is closed.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | leaves | 10 000 | 40 000 | 160 000 | 160 000 | 160 000 |
/// | triangles | 53 880 | 114 238 | 355 460 | 360 638 | 380 500 |
pub fn tree(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let bark = scene.material(Material::matte("bark", Vec3::new(0.24, 0.17, 0.11)));
    let grass = scene.material(Material::matte("grass", Vec3::new(0.20, 0.32, 0.09)));
    let stone = scene.material(Material::matte("pale stone", Vec3::new(0.68, 0.65, 0.58)));
    let texture = scene.texture(leaves::texture());
    let leaf = scene.material(Material {
        base_color: Vec4::ONE,
        base_color_texture: Some(texture),
        alpha: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::matte("leaves", Vec3::ONE)
    });
    let sides = pick(detail, [4, 5, 6, 9, 14]);
    let steps = pick(detail, [2, 4, 8, 16, 32]);

    let branches = wood::grow();
    let mut b = Builder::default();
    wood::mesh(&mut b, &branches, sides);
    scene.add("trunk and branches", b, bark);
    let mut b = Builder::default();
    leaves::mesh(&mut b, &branches, pick(detail, [10_000, 40_000, 160_000, 160_000, 160_000]));
    scene.add("leaves", b, leaf);
    let mut b = Builder::default();
    b.brick(Mat4::IDENTITY, Vec3::new(-8.0, -0.5, -8.0), Vec3::new(8.0, 0.0, 8.0), steps, Vec3::ONE);
    scene.add("meadow", b, grass);
    // A ring wall and a bench of stone show the size.
    let mut b = Builder::default();
    let seat = Mat4::from_translation(Vec3::new(2.1, 0.0, 2.6)) * Mat4::from_rotation_y(-0.55);
    b.brick(seat, Vec3::new(-0.8, 0.38, -0.22), Vec3::new(0.8, 0.48, 0.22), steps, Vec3::ONE);
    for x in [-0.6, 0.6] {
        b.brick(
            seat,
            Vec3::new(x - 0.08, -0.02, -0.18),
            Vec3::new(x + 0.08, 0.40, 0.18),
            1,
            Vec3::splat(0.9),
        );
    }
    scene.add("bench", b, stone);
    scene.light(Light::Directional {
        direction: Vec3::new(0.50, -0.74, -0.45).normalize_or_zero(),
        irradiance: Vec3::new(14.0, 12.6, 10.4),
    });
    scene.sky(Vec3::new(0.34, 0.48, 0.72));
    scene.camera(Camera::look("meadow", Vec3::new(4.2, 2.0, 10.0), Vec3::new(0.0, 4.0, 0.0), 48.0));
    scene.camera(Camera::look("under the crown", Vec3::new(-2.6, 1.5, 3.2), Vec3::new(0.4, 4.6, 0.0), 62.0));
    scene.finish()
}

/// Numbers that look like chance but are always the same.
struct Chance(u32);

impl Chance {
    /// Evenly between -1 and 1.
    fn signed(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        let word = (word >> 22) ^ word;
        word as f32 / u32::MAX as f32 * 2.0 - 1.0
    }

    /// Evenly between 0 and 1.
    fn unit(&mut self) -> f32 {
        0.5 * self.signed() + 0.5
    }

    /// A direction, evenly over the sphere.
    fn direction(&mut self) -> Vec3 {
        let y = self.signed();
        let (sin, cos) = (std::f32::consts::PI * self.signed()).sin_cos();
        let ring = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(ring * cos, y, ring * sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_but_the_leaves_is_closed() {
        assert_eq!(
            [0, 1, 2, 3, 4].map(|d| tree(d).triangle_count()),
            [53880, 114238, 355460, 360638, 380500]
        );
        for detail in [0, 2] {
            let solids = checks::world_triangles(&tree(detail), |n| n != "leaves");
            assert_eq!(checks::open_edges(&solids), 0);
        }
    }

    #[test]
    fn there_are_160_000_masked_leaves_around_the_branches() {
        let scene = tree(2);
        let leaves = scene.meshes.iter().find(|m| m.name == "leaves").unwrap();
        assert_eq!(leaves.indices.len(), 2 * 160_000);
        assert_eq!(scene.materials[leaves.material].alpha, AlphaMode::Mask { cutoff: 0.5 });
        let texture = &scene.textures[scene.materials[leaves.material].base_color_texture.unwrap()];
        assert_eq!(texture.pixels.len() as u32, 4 * texture.width * texture.height);
        let covered = texture.pixels.chunks(4).filter(|p| p[3] >= 128).count() as f32;
        let share = covered / (texture.width * texture.height) as f32;
        assert!((0.3..0.7).contains(&share), "{share}");
        let bounds = lumivox_core::Bounds::of_points(leaves.positions.iter().map(|&p| p.into()));
        assert!(
            bounds.min.y > 1.2 && bounds.max.y < 10.0 && bounds.size().max_element() < 12.0,
            "{bounds:?}"
        );
    }

    #[test]
    fn it_grows_the_same_every_time() {
        assert_eq!(tree(1).meshes, tree(1).meshes);
    }
}
