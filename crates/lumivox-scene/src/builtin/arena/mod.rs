//! A walled court under the open sky: gates, towers, tiers of seats, banners and a dais.
//!
//! ```text
//!   (o)-----[ gate ]-----(o)     x -14..14, z -11..11 inside; walls 1.2 m thick and 5 m high, towers at the corners
//!    |  ====        ====  |      tiers of seats along both long sides
//!   [g]      ( o )       [g]     a round dais in the middle
//!    |  ====        ====  |      the sun stands over +x, -z: the -x and +z walls are in the light
//!   (o)-----[ gate ]-----(o)
//! ```

mod furnishings;

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat4, Vec2, Vec3};

use super::builder::{Builder, SceneBuilder, pick};
use super::{bodies, masonry::Masonry, masonry::weathered};
use crate::{Camera, Light, Material, Scene};

/// Half sizes of the court inside the walls, and the walls' thickness and height.
const HALF: [f32; 2] = [14.0, 11.0];
const THICK: f32 = 1.2;
const WALL: f32 = 5.0;
/// Half width of a gate, and the height of its arch's springing.
const GATE: f32 = 1.5;
const SPRING: f32 = 2.2;

/// An enclosed arena, the typical outdoor scene of games, after the one of Gaitatzes' dissertation (2012), section 5.6:
/// sun and sky, walls partly in the shade, and banners whose colours reach the sand.
///
/// | detail | 0 | 1 | 2 | 3 | 4 |
/// | --- | --- | --- | --- | --- | --- |
/// | triangles | 6 452 | 9 224 | 19 308 | 41 228 | 84 284 |
pub fn arena(detail: u32) -> Scene {
    let mut scene = SceneBuilder::default();
    let palette = Palette::new(&mut scene);
    let d = Cuts {
        longest: pick(detail, [f32::INFINITY, 3.0, 1.4, 0.8, 0.5]),
        steps: pick(detail, [1, 1, 2, 3, 5]),
        sides: pick(detail, [8, 12, 20, 32, 48]),
        arch: pick(detail, [4, 6, 10, 16, 24]),
    };
    walls(&mut scene, &palette, &d);
    gates(&mut scene, &palette, &d);
    towers(&mut scene, &palette, &d);
    furnishings::banners(&mut scene, &palette, &d);
    furnishings::dais(&mut scene, &palette, &d);
    furnishings::props(&mut scene, &palette, &d);
    scene.light(Light::Directional {
        direction: Vec3::new(-0.52, -0.72, 0.46).normalize_or_zero(),
        irradiance: Vec3::new(14.0, 12.6, 10.5),
    });
    scene.sky(Vec3::new(0.30, 0.42, 0.62));
    scene.camera(Camera::look("court", Vec3::new(-12.2, 2.9, -7.2), Vec3::new(1.5, 1.6, 1.2), 58.0));
    scene.camera(Camera::look("gate", Vec3::new(7.5, 1.7, 1.5), Vec3::new(14.0, 2.1, -0.8), 60.0));
    scene.camera(Camera::look("from the wall", Vec3::new(-11.0, 7.5, 11.6), Vec3::new(2.0, 0.5, -2.0), 60.0));
    scene.finish()
}

/// How finely things are cut.
struct Cuts {
    longest: f32,
    steps: u32,
    sides: u32,
    arch: u32,
}

/// Material indices.
struct Palette {
    sand: usize,
    grass: usize,
    stone: usize,
    pale: usize,
    seats: usize,
    roof: usize,
    wood: usize,
    iron: usize,
    gold: usize,
    cloth: [usize; 4],
}

impl Palette {
    fn new(scene: &mut SceneBuilder) -> Self {
        let mut matte = |name: &str, r, g, b| scene.material(Material::matte(name, Vec3::new(r, g, b)));
        Self {
            sand: matte("sand", 0.66, 0.53, 0.36),
            grass: matte("grass", 0.22, 0.32, 0.10),
            stone: matte("wall stone", 0.62, 0.55, 0.45),
            pale: matte("pale stone", 0.74, 0.70, 0.62),
            seats: matte("seat stone", 0.66, 0.62, 0.55),
            roof: matte("roof tiles", 0.55, 0.21, 0.11),
            wood: matte("wood", 0.34, 0.20, 0.10),
            iron: matte("iron", 0.14, 0.14, 0.15),
            gold: matte("gold", 0.78, 0.55, 0.16),
            cloth: [
                matte("red cloth", 0.68, 0.06, 0.05),
                matte("blue cloth", 0.06, 0.14, 0.58),
                matte("gold cloth", 0.80, 0.50, 0.08),
                matte("green cloth", 0.06, 0.42, 0.12),
            ],
        }
    }
}

/// The ground, the four walls with holes for the gates, and the seats, in one piece.
fn walls(scene: &mut SceneBuilder, palette: &Palette, d: &Cuts) {
    let [x, z] = HALF;
    let (ox, oz) = (x + THICK, z + THICK);
    let mut m = Masonry::default();
    m.fill([-ox - 2.0, -0.6, -oz - 2.0], [ox + 2.0, 0.0, oz + 2.0], palette.grass);
    m.fill([-ox, -0.3, -oz], [ox, 0.0, oz], palette.sand);
    m.fill([-ox, 0.0, -oz], [ox, WALL, oz], palette.stone);
    m.cut([-x, 0.0, -z], [x, WALL, z]);
    let clear = GATE + 0.12;
    let top = SPRING + GATE + 0.15;
    m.cut([-clear, 0.0, -oz], [clear, top, oz]);
    m.cut([-ox, 0.0, -clear], [ox, top, clear]);
    for side in [-1.0, 1.0] {
        for [left, right] in [[-10.5, -3.5], [3.5, 10.5]] {
            for (tier, depth) in [(1, 2.7f32), (2, 1.8), (3, 0.9)] {
                let (a, b) = (side * z, side * (z - depth));
                m.fill([left, 0.0, a.min(b)], [right, 0.48 * tier as f32, a.max(b)], palette.seats);
            }
        }
    }
    m.finish(scene, "arena", d.longest, weathered);

    // Merlons along the outer edge; where the towers are there are none.
    let mut merlons = Builder::default();
    let size = Vec3::new(0.55, 0.5, 0.28);
    let mut merlon = |center: Vec3, turn: f32| {
        let place = Mat4::from_translation(center) * Mat4::from_rotation_y(turn);
        merlons.brick(place, -size, size, d.steps, Vec3::splat(0.96));
    };
    for i in -6..=6 {
        let at = 2.0 * i as f32;
        for side in [-1.0, 1.0] {
            merlon(Vec3::new(at, WALL + 0.45, side * (oz - 0.33)), 0.0);
            if i32::abs(i) < 5 {
                merlon(Vec3::new(side * (ox - 0.33), WALL + 0.45, at), FRAC_PI_2);
            }
        }
    }
    scene.add("merlons", merlons, palette.stone);
}

/// Stone frames with round arches that fill the walls' holes, and open wooden leaves.
fn gates(scene: &mut SceneBuilder, palette: &Palette, d: &Cuts) {
    let mut inner = vec![Vec2::new(GATE, -0.1)];
    inner.extend(bodies::arc(Vec2::new(0.0, SPRING), GATE, [0.0, PI], d.arch));
    inner.push(Vec2::new(-GATE, -0.1));
    // Straight up from the feet and over the arch, on the lines from its middle.
    let half = GATE + 0.42;
    let rise = GATE + 0.45;
    let outer: Vec<Vec2> = (0..inner.len())
        .map(|i| match i {
            0 => Vec2::new(half, -0.1),
            i if i + 1 == inner.len() => Vec2::new(-half, -0.1),
            i => {
                let way = Vec2::from_angle(PI * (i - 1) as f32 / d.arch as f32);
                let reach = (half / way.x.abs().max(1e-6)).min(rise / way.y.max(1e-6));
                Vec2::new(0.0, SPRING) + reach * way
            }
        })
        .collect();
    let depth = THICK + 0.24;
    let mut frame = Builder::default();
    let centered = Mat4::from_translation(Vec3::new(0.0, 0.0, -0.5 * depth));
    frame.band(centered, [&inner, &outer], false, [depth, d.steps as f32], Vec3::ONE);
    let [x, z] = HALF.map(|h| h + 0.5 * THICK);
    let places: Vec<Mat4> =
        [(Vec3::new(0.0, 0.0, z), 0.0), (Vec3::new(x, 0.0, 0.0), FRAC_PI_2), (Vec3::new(0.0, 0.0, -z), PI)]
            .into_iter()
            .chain([(Vec3::new(-x, 0.0, 0.0), -FRAC_PI_2)])
            .map(|(at, turn)| Mat4::from_translation(at) * Mat4::from_rotation_y(turn))
            .collect();
    scene.add_at("gate frame", frame, palette.pale, &places);

    // Leaves of planks that stand open outside.
    let mut leaves = Builder::default();
    for side in [-1.0, 1.0] {
        let hinge = Mat4::from_translation(Vec3::new(side * (GATE - 0.02), 0.03, 0.5 * depth - 0.1));
        let place = hinge * Mat4::from_rotation_y(-side * 0.35);
        for i in 0..5 {
            let from = 0.05 + 0.27 * i as f32;
            let min = Vec3::new(-0.04 - 0.012 * (i % 2) as f32, 0.0, from);
            leaves.brick(place, min, Vec3::new(0.04, 2.1, from + 0.262), d.steps, Vec3::splat(0.9));
        }
        for y in [0.4, 1.6] {
            leaves.brick(
                place,
                Vec3::new(-0.07, y, 0.08),
                Vec3::new(0.07, y + 0.14, 1.36),
                1,
                Vec3::splat(0.6),
            );
        }
    }
    scene.add_at("gate leaves", leaves, palette.wood, &places);
}

fn towers(scene: &mut SceneBuilder, palette: &Palette, d: &Cuts) {
    let [x, z] = HALF.map(|h| h + 0.5 * THICK);
    let places: Vec<Mat4> = [(-x, -z), (-x, z), (x, z), (x, -z)]
        .map(|(x, z)| Mat4::from_translation(Vec3::new(x, 0.0, z)))
        .to_vec();
    let (mut tower, mut roof) = (Builder::default(), Builder::default());
    let profile = [
        [0.0, -0.4],
        [2.35, -0.4],
        [2.3, 0.5],
        [2.05, 0.7],
        [2.0, 5.9],
        [2.35, 6.3],
        [2.35, 7.0],
        [0.0, 7.0],
    ];
    tower.turned(Mat4::IDENTITY, &profile, 2 * d.sides, Vec3::ONE);
    roof.turned(
        Mat4::IDENTITY,
        &[[0.0, 6.9], [2.7, 6.9], [2.7, 7.02], [1.2, 8.6], [0.0, 10.1]],
        2 * d.sides,
        Vec3::ONE,
    );
    scene.add_at("tower", tower, palette.stone, &places);
    scene.add_at("tower roof", roof, palette.roof, &places);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::checks;

    #[test]
    fn triangles_are_as_documented_and_all_is_closed() {
        assert_eq!([0, 1, 2, 3, 4].map(|d| arena(d).triangle_count()), [6452, 9224, 19308, 41228, 84284]);
        for detail in [0, 2] {
            assert_eq!(checks::open_edges(&checks::world_triangles(&arena(detail), |_| true)), 0);
        }
    }

    #[test]
    fn one_can_walk_out_through_every_gate_and_nowhere_else() {
        let triangles = checks::world_triangles(&arena(1), |n| n != "gate leaves");
        let from = Vec3::new(0.0, 1.2, 0.0);
        for (way, reach) in [(Vec3::X, HALF[0]), (Vec3::Z, HALF[1])] {
            for way in [way, -way] {
                // Past the column in the middle.
                let start = from + 5.0 * way;
                assert_eq!(checks::hit(&triangles, start, way), None, "{way}");
                let aside = start + 2.5 * Vec3::new(way.z, 0.0, way.x).abs();
                let wall = checks::hit(&triangles, aside, way).map(|d| d + 5.0);
                assert!(wall.is_some_and(|d| d < reach + 0.01), "{way}: {wall:?}");
            }
        }
    }
}
