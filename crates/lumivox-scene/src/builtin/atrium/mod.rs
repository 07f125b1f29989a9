//! The showpiece: a two-storey colonnade around a sunlit court, with hanging curtains. It stands in for the Sponza
//! atrium of the papers: one long wall and half the floor lie in the sun, everything else lives on bounced light.
//!
//! ```text
//!            z = -6   outer wall
//!   +-------------------------------+
//!   |  arcade, in the shade         |      x -12..12, z -6..6 inside the outer walls, eaves at 8.9 m, rim at 10 m
//!   |   o--o--o--o--o--o--o--o--o   |      columns every 2.4 m at z = +-3.6 and x = +-9.6
//!   |   |         court         |   |      gallery floor at 4.7 m
//!   |   o--o--o--o--o--o--o--o--o   |      the sun comes from -z and falls on the floor and the +z side
//!   |                               |
//!   +-------------------------------+
//! ```

mod arcade;
mod camera;
mod curtains;
mod floor;
mod shell;
mod sun;
mod things;

pub use camera::atrium_camera_path;

use glam::{Mat4, Vec3, Vec4};

use super::builder::SceneBuilder;
use crate::{Material, Scene};

/// Distance between columns, and from the columns to the outer wall.
const BAY: f32 = 2.4;
/// Inner faces of the outer walls lie at plus and minus this in x and z.
const WALL: [f32; 2] = [12.0, 6.0];
/// Column axes lie at plus and minus this in x and z.
const COURT: [f32; 2] = [9.6, 3.6];
/// Height of the ground floor's arch springing, of its ceiling, and of the gallery floor above.
const SPRING: f32 = 3.0;
const CEILING: f32 = 4.4;
const GALLERY: f32 = 4.7;
/// Height of the gallery's arch springing and ceiling, of the eaves and of the rim.
const UPPER_SPRING: f32 = 7.0;
const UPPER_CEILING: f32 = 8.55;
const EAVES: f32 = 8.9;
const RIM: f32 = 10.0;
/// Radius of all arches; leaves half a metre between them for the columns.
const ARCH: f32 = 0.95;

/// The atrium. About 9 K, 19 K, 32 K, 73 K and 168 K triangles at detail 0 to 4. Lit by the sun (irradiance about 14
/// W/m2) and a dim blue sky; the first camera is inside at eye height. In the clip `day`, 18 s, the sun goes over the sky.
pub fn atrium(detail: u32) -> Scene {
    let detail = Detail::new(detail);
    let mut scene = SceneBuilder::default();
    let palette = Palette::new(&mut scene);
    floor::add(&mut scene, &palette, &detail);
    shell::add(&mut scene, &palette, &detail);
    arcade::add(&mut scene, &palette, &detail);
    curtains::add(&mut scene, &palette, &detail);
    things::add(&mut scene, &palette, &detail);
    sun::add(&mut scene);
    scene.sky(Vec3::new(0.30, 0.42, 0.62));
    camera::views().into_iter().for_each(|c| scene.camera(c));
    scene.finish()
}

/// How finely things are cut. Level 0 also has fewer tiles, wall blocks and balusters.
struct Detail {
    level: usize,
}

impl Detail {
    fn new(level: u32) -> Self {
        Self { level: level.min(super::MAX_DETAIL) as usize }
    }

    /// The entry for this level.
    fn pick<T: Copy>(&self, values: [T; 5]) -> T {
        values[self.level]
    }
}

/// Material indices. Albedos are linear; vertex colours only darken them a little, stone by stone.
struct Palette {
    wall: usize,
    stone: usize,
    trim: usize,
    plaster: usize,
    wood: usize,
    roof: usize,
    tile_light: usize,
    tile_warm: usize,
    tile_dark: usize,
    dado: usize,
    clay: usize,
    glaze: usize,
    water: usize,
    cloth: [usize; 4],
}

impl Palette {
    fn new(scene: &mut SceneBuilder) -> Self {
        let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
        Self {
            wall: matte("sandstone wall", 0.72, 0.61, 0.46),
            stone: matte("column stone", 0.74, 0.67, 0.56),
            trim: matte("trim", 0.75, 0.69, 0.60),
            plaster: matte("plaster", 0.75, 0.70, 0.62),
            wood: matte("wood", 0.26, 0.15, 0.08),
            roof: matte("roof tiles", 0.52, 0.23, 0.13),
            tile_light: matte("light floor tiles", 0.68, 0.62, 0.52),
            tile_warm: matte("warm floor tiles", 0.50, 0.34, 0.24),
            tile_dark: matte("dark floor tiles", 0.20, 0.17, 0.15),
            dado: matte("glazed wall tiles", 0.22, 0.44, 0.46),
            clay: matte("clay", 0.58, 0.28, 0.15),
            glaze: matte("blue glaze", 0.08, 0.17, 0.45),
            water: matte("water", 0.10, 0.26, 0.28),
            cloth: [
                matte("red cloth", 0.66, 0.045, 0.035),
                matte("gold cloth", 0.78, 0.46, 0.06),
                matte("green cloth", 0.05, 0.40, 0.10),
                matte("blue cloth", 0.05, 0.12, 0.58),
            ],
        }
    }
}

/// One opening between two columns, with its own axes: x along the colonnade from the left column's axis (seen from
/// the court), y up, z out into the court.
struct Bay {
    world_from_bay: Mat4,
}

impl Bay {
    fn new(origin: Vec3, out: Vec3) -> Self {
        let along = Vec3::Y.cross(out);
        let columns = [along, Vec3::Y, out].map(|v| v.extend(0.0));
        Self { world_from_bay: Mat4::from_cols(columns[0], columns[1], columns[2], origin.extend(1.0)) }
    }

    fn raised(&self, y: f32) -> Mat4 {
        self.world_from_bay * Mat4::from_translation(Vec3::new(0.0, y, 0.0))
    }
}

/// Bays of the long side in the shade (z = -3.6, from -x to +x), of the sunny long side (from +x to -x), and of the
/// ends at -x and +x.
fn sides() -> [Vec<Bay>; 4] {
    let side = |out: Vec3, count: u32| {
        let along = Vec3::Y.cross(out);
        let half = 0.5 * BAY * count as f32;
        let line = if out.z == 0.0 { COURT[0] } else { COURT[1] };
        (0..count).map(|i| Bay::new(-line * out + (BAY * i as f32 - half) * along, out)).collect()
    };
    let (long, short) = ((2.0 * COURT[0] / BAY).round() as u32, (2.0 * COURT[1] / BAY).round() as u32);
    [side(Vec3::Z, long), side(Vec3::NEG_Z, long), side(Vec3::X, short), side(Vec3::NEG_X, short)]
}

/// A shade from `1 - spread` to 1, different for each `seed` but always the same: stones are never quite alike.
fn shade(seed: u32, spread: f32) -> Vec3 {
    let hash = |n: u32| {
        let h = (n ^ (n >> 15)).wrapping_mul(0x2c1b_3c6d);
        let h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
        (h ^ (h >> 15)) as f32 / u32::MAX as f32
    };
    let value = 1.0 - spread * hash(seed.wrapping_mul(747_796_405).wrapping_add(1));
    let warmth = 0.3 * spread * hash(seed.wrapping_mul(277_803_737).wrapping_add(7));
    (Vec4::splat(value) - Vec4::new(0.0, 0.4 * warmth, warmth, 0.0)).truncate()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_as_documented_and_the_size_is_right() {
        let counts = [0, 1, 2, 3, 4].map(|d| atrium(d).triangle_count());
        println!("{counts:?}");
        for (count, about) in counts.into_iter().zip([9_200, 19_000, 32_400, 73_200, 167_600]) {
            assert!(count.abs_diff(about) < about / 20, "{counts:?}");
        }
        let size = atrium(0).bounds().size();
        assert!((size - Vec3::new(24.8, 10.1, 12.8)).abs().max_element() < 0.3, "{size}");
    }

    #[test]
    fn bays_are_right_handed_and_close_the_court() {
        let sides = sides();
        assert_eq!(sides.each_ref().map(Vec::len), [8, 8, 3, 3]);
        for bay in sides.iter().flatten() {
            let m = bay.world_from_bay;
            assert!((m.determinant() - 1.0).abs() < 1e-5);
            let middle = m.transform_point3(Vec3::new(0.5 * BAY, 0.0, 1.0));
            assert!(middle.x.abs() < COURT[0] && middle.z.abs() < COURT[1], "{middle}");
        }
    }
}
