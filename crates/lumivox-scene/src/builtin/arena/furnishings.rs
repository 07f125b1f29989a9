//! What hangs and stands in the court: banners, the dais, crates, barrels and broken columns.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat4, Vec3};

use super::{Cuts, HALF, Palette};
use crate::builtin::builder::{Builder, SceneBuilder};

/// Cloths on rods, 6 cm in front of the walls: red and gold along the +z wall, blue and green along the -z wall.
pub(super) fn banners(scene: &mut SceneBuilder, palette: &Palette, d: &Cuts) {
    let mut cloths: [Builder; 4] = Default::default();
    let mut rods = Builder::default();
    let wave = |b: &mut Builder, place: Mat4| {
        // A pennon with a point, thick enough to be a solid.
        let outline = [[-0.7, 0.5], [0.0, 0.0], [0.7, 0.5], [0.7, 2.6], [-0.7, 2.6]];
        b.prism(place, &outline, 0.05, d.steps, Vec3::ONE);
    };
    let [x, z] = HALF;
    for i in 0..6 {
        let along = [-11.5, -7.0, -2.9, 2.9, 7.0, 11.5][i];
        for (side, cloth) in [(1.0, [0, 2]), (-1.0, [1, 3])] {
            let turn = if side > 0.0 { PI } else { 0.0 };
            let at = Vec3::new(along, 1.95, side * (z - 0.06));
            let place = Mat4::from_translation(at) * Mat4::from_rotation_y(turn);
            wave(&mut cloths[cloth[i % 2]], place);
            rods.brick(place, Vec3::new(-0.85, 2.56, -0.08), Vec3::new(0.85, 2.64, 0.07), d.steps, Vec3::ONE);
        }
    }
    for (i, along) in [-6.6f32, -3.4, 3.4, 6.6].into_iter().enumerate() {
        for (side, cloth) in [(1.0, [0, 1]), (-1.0, [2, 3])] {
            let at = Vec3::new(side * (x - 0.06), 1.95, along);
            let place = Mat4::from_translation(at) * Mat4::from_rotation_y(-side * FRAC_PI_2);
            wave(&mut cloths[cloth[i % 2]], place);
            rods.brick(place, Vec3::new(-0.85, 2.56, -0.08), Vec3::new(0.85, 2.64, 0.07), d.steps, Vec3::ONE);
        }
    }
    for (cloth, (builder, name)) in cloths.into_iter().zip(["red", "blue", "gold", "green"]).enumerate() {
        scene.add(&format!("{name} banners"), builder, palette.cloth[cloth]);
    }
    scene.add("banner rods", rods, palette.wood);
}

/// Three round steps with a column and a golden ball, and braziers around.
pub(super) fn dais(scene: &mut SceneBuilder, palette: &Palette, d: &Cuts) {
    let (mut stone, mut gold, mut iron) = (Builder::default(), Builder::default(), Builder::default());
    let steps = [
        [0.0, -0.05],
        [3.9, -0.05],
        [3.9, 0.22],
        [3.3, 0.22],
        [3.3, 0.46],
        [2.7, 0.46],
        [2.7, 0.7],
        [0.0, 0.7],
    ];
    stone.turned(Mat4::IDENTITY, &steps, 2 * d.sides, Vec3::ONE);
    let column = [
        [0.0, 0.66],
        [0.75, 0.66],
        [0.75, 0.9],
        [0.55, 1.0],
        [0.42, 1.15],
        [0.36, 3.2],
        [0.42, 3.3],
        [0.62, 3.45],
        [0.62, 3.6],
        [0.0, 3.6],
    ];
    stone.turned(Mat4::IDENTITY, &column, d.sides, Vec3::ONE);
    let ball = Mat4::from_translation(Vec3::new(0.0, 4.07, 0.0)) * Mat4::from_scale(Vec3::splat(0.5));
    gold.ball(ball, d.sides, Vec3::ONE);
    for i in 0..4 {
        let (sin, cos) = (FRAC_PI_2 * (i as f32 + 0.5)).sin_cos();
        let foot = Mat4::from_translation(Vec3::new(2.0 * cos, 0.69, 2.0 * sin));
        let bowl = [
            [0.0, 0.0],
            [0.22, 0.0],
            [0.06, 0.1],
            [0.05, 0.8],
            [0.12, 0.86],
            [0.36, 1.1],
            [0.3, 1.1],
            [0.0, 0.98],
        ];
        iron.turned(foot, &bowl, d.sides, Vec3::ONE);
    }
    scene.add("dais and column", stone, palette.pale);
    scene.add("golden ball", gold, palette.gold);
    scene.add("braziers", iron, palette.iron);
}

/// Crates, barrels and broken columns.
pub(super) fn props(scene: &mut SceneBuilder, palette: &Palette, d: &Cuts) {
    let (mut wood, mut barrels, mut stone) = (Builder::default(), Builder::default(), Builder::default());
    for (x, y, z, half, turn) in [
        (-12.3, 0.6, -4.2, 0.62f32, 0.2f32),
        (-12.1, 1.66, -4.1, 0.45, -0.3),
        (-12.5, 0.48, -2.6, 0.5, 0.5),
        (12.4, 0.58, 4.4, 0.6, 0.35),
        (11.2, 0.43, 5.3, 0.45, -0.2),
        (-5.2, 0.43, 4.6, 0.45, 0.6),
    ] {
        let place = Mat4::from_translation(Vec3::new(x, y, z)) * Mat4::from_rotation_y(turn);
        wood.brick(place, Vec3::splat(-half), Vec3::splat(half), d.steps, Vec3::ONE);
    }
    let barrel = [
        [0.0, -0.02],
        [0.3, -0.02],
        [0.37, 0.25],
        [0.39, 0.5],
        [0.37, 0.75],
        [0.3, 1.0],
        [0.27, 1.0],
        [0.27, 0.95],
    ];
    let barrel: Vec<_> = barrel.into_iter().chain([[0.0, 0.95]]).collect();
    for (x, z) in [(12.6, -4.0), (12.3, -4.9), (11.6, -4.2), (-4.4, 5.4), (-12.4, 4.6)] {
        barrels.turned(Mat4::from_translation(Vec3::new(x, 0.0, z)), &barrel, d.sides, Vec3::ONE);
    }
    let drum = [[0.0, -0.05], [0.5, -0.05], [0.5, 0.2], [0.4, 0.3], [0.38, 2.2], [0.3, 2.35], [0.0, 2.2]];
    for (x, z) in [(-7.0, -5.2), (7.0, -5.2), (7.0, 5.2), (-7.0, 5.2)] {
        stone.turned(Mat4::from_translation(Vec3::new(x, 0.0, z)), &drum, d.sides, Vec3::ONE);
    }
    let lying = Mat4::from_translation(Vec3::new(4.2, 0.37, -4.3))
        * Mat4::from_rotation_y(0.5)
        * Mat4::from_rotation_z(FRAC_PI_2);
    stone.bar(lying, 0.39, 2.1, d.sides, Vec3::ONE);
    scene.add("crates", wood, palette.wood);
    scene.add("barrels", barrels, palette.wood);
    scene.add("broken columns", stone, palette.pale);
}
