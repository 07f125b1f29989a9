//! What stands about: a fountain in the court, vases, crates and balls.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::{COURT, Detail, Palette};
use crate::builtin::builder::{Builder, SceneBuilder};

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let sides = detail.pick([6, 9, 14, 24, 36]);
    let rings = detail.pick([3, 5, 8, 13, 20]);

    let mut stone = Builder::default();
    let mut water = Builder::default();
    let middle = Vec3::ZERO;
    stone.lathe(middle, &FOUNTAIN.map(Vec2::from), sides, Vec3::ONE);
    stone.lathe(middle, &BOWL.map(Vec2::from), sides, Vec3::ONE);
    for (radius, height) in [(1.0, 0.36), (0.48, 1.14)] {
        water.lathe(middle, &[Vec2::new(radius, height), Vec2::new(0.0, height)], sides, Vec3::ONE);
    }
    let (mut clay, mut glaze, mut wood) = (Builder::default(), Builder::default(), Builder::default());
    // Beside the columns, out of every line that is walked.
    for (x, z, size) in
        [(-7.2, -2.75, 1.0), (-4.8, 2.8, 0.95), (2.4, 2.8, 0.9), (7.2, 2.7, 1.1), (4.8, -2.8, 1.0)]
    {
        vase(&mut clay, Vec3::new(x, 0.0, z), size, sides, rings);
    }
    for (x, z, size) in [(-2.4, 2.7, 0.8), (7.2, -2.75, 1.2), (8.6, 0.0, 1.3)] {
        vase(&mut glaze, Vec3::new(x, 0.0, z), size, sides, rings);
    }
    for (x, z, radius) in [(-3.3, 2.2, 0.28), (5.6, 1.5, 0.42), (-COURT[0] + 0.9, 2.4, 0.26)] {
        ball(&mut stone, Vec3::new(x, radius, z), radius, sides, rings);
    }
    let steps = detail.pick([1, 1, 2, 4, 8]);
    for (x, y, z, size, angle) in [
        (3.2, 0.0, -5.35, 0.75, 0.25),
        (4.05, 0.0, -5.5, 0.55, -0.2),
        (3.25, 0.75, -5.4, 0.45, 0.7),
        (-8.7, 0.0, 5.2, 0.8, 0.4),
        (-6.4, 0.0, 2.2, 0.5, 0.6),
    ] {
        wood.block(Vec3::new(x, y + 0.5 * size, z), Vec3::splat(size), angle, steps, Vec3::ONE);
    }
    scene.add("fountain and balls", stone, palette.stone);
    scene.add("water", water, palette.water);
    scene.add("clay vases", clay, palette.clay);
    scene.add("glazed vases", glaze, palette.glaze);
    scene.add("crates", wood, palette.wood);
}

/// The basin, outside up and inside down: radius and height.
const FOUNTAIN: [[f32; 2]; 9] = [
    [1.3, 0.0],
    [1.3, 0.1],
    [1.12, 0.14],
    [1.08, 0.36],
    [1.22, 0.44],
    [1.22, 0.52],
    [1.0, 0.52],
    [1.0, 0.3],
    [0.0, 0.3],
];

/// The stem in the basin and the bowl on it.
const BOWL: [[f32; 2]; 8] = [
    [0.26, 0.3],
    [0.14, 0.5],
    [0.11, 0.85],
    [0.2, 0.98],
    [0.56, 1.16],
    [0.58, 1.2],
    [0.48, 1.18],
    [0.3, 1.1],
];

/// A bellied vase about 0.9 m high at size 1.
fn vase(b: &mut Builder, foot: Vec3, size: f32, sides: u32, rings: u32) {
    let outline = |t: f32| {
        let belly = 0.16 + 0.17 * (PI * t.powf(0.8)).sin().max(0.0);
        let lip = 0.10 * ((t - 0.86) / 0.14).clamp(0.0, 1.0);
        let neck = 0.07 * (1.0 - ((t - 0.84).abs() / 0.2).min(1.0));
        size * Vec2::new(belly + lip - neck, 0.9 * t)
    };
    let mut profile: Vec<Vec2> = (0..=rings).map(|i| outline(i as f32 / rings as f32)).collect();
    // The inside, as far as one sees.
    profile.push(size * Vec2::new(0.19, 0.86));
    profile.push(size * Vec2::new(0.0, 0.7));
    b.lathe(foot, &profile, sides, Vec3::ONE);
}

fn ball(b: &mut Builder, center: Vec3, radius: f32, sides: u32, rings: u32) {
    b.sheet([sides, rings], Vec3::ONE, |s, t| {
        let (sin, cos) = (-s * 2.0 * PI).sin_cos();
        let (ring, y) = (PI * t).sin_cos();
        let normal = Vec3::new(ring * cos, -y, ring * sin);
        (center + radius * normal, normal)
    });
}
