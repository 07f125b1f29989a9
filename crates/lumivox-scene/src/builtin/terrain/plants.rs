//! Trees and rocks as simple closed shapes: cypresses, olives and boulders.

use glam::{Mat4, Vec3};

use super::land::height;
use super::{Cuts, Palette};
use crate::builtin::builder::{Builder, SceneBuilder};

/// Places (x, z) and sizes.
const CYPRESSES: [[f32; 3]; 16] = [
    [-13.2, 3.6, 1.0],
    [-13.4, 0.4, 1.12],
    [-13.0, -2.8, 0.95],
    [-13.3, -6.0, 1.08],
    [13.0, -7.2, 1.15],
    [13.3, -4.2, 0.95],
    [-16.5, -14.0, 1.2],
    [-8.0, -13.5, 1.05],
    [-5.4, -14.5, 1.3],
    [2.6, -13.0, 1.1],
    [5.2, -14.2, 0.95],
    [12.6, -15.5, 1.25],
    [19.0, -11.0, 1.05],
    [-20.5, -5.0, 1.0],
    [-6.4, 9.6, 0.85],
    [12.4, 7.0, 0.9],
];
const OLIVES: [[f32; 3]; 14] = [
    [-9.5, 11.2, 1.1],
    [-13.6, 12.8, 1.25],
    [-18.0, 8.5, 1.15],
    [-19.5, 15.5, 1.3],
    [-4.5, 15.5, 1.0],
    [2.8, 13.6, 0.95],
    [16.5, 9.0, 1.2],
    [20.5, 14.0, 1.3],
    [18.0, 1.0, 1.1],
    [22.0, -5.0, 1.25],
    [-22.5, 1.5, 1.15],
    [-12.5, -19.5, 1.35],
    [9.0, -19.0, 1.3],
    [21.0, -18.5, 1.2],
];
const ROCKS: [[f32; 3]; 12] = [
    [5.4, 11.6, 0.7],
    [6.4, 12.1, 0.4],
    [-1.8, 11.8, 0.35],
    [-7.8, 13.6, 0.8],
    [12.8, 5.6, 0.6],
    [14.6, 12.6, 0.9],
    [-15.2, 10.4, 0.7],
    [-21.0, 10.5, 1.0],
    [15.0, -9.6, 0.8],
    [-15.8, -9.2, 0.9],
    [0.4, -16.8, 1.1],
    [24.0, 4.0, 1.0],
];

/// On the ground, sunk by `sunk`, turned by something that looks like chance.
fn stand([x, z, size]: [f32; 3], sunk: f32) -> Mat4 {
    let foot = Vec3::new(x, height(x, z) - sunk, z);
    Mat4::from_translation(foot)
        * Mat4::from_rotation_y(7.0 * x + 3.0 * z)
        * Mat4::from_scale(Vec3::splat(size))
}

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let sides = cuts.sides;
    let (mut crown, mut trunk) = (Builder::default(), Builder::default());
    let outline = [
        [0.0, 0.45],
        [0.5, 0.6],
        [0.72, 1.2],
        [0.74, 2.2],
        [0.62, 3.5],
        [0.40, 4.8],
        [0.16, 5.8],
        [0.0, 6.3],
    ];
    crown.turned(Mat4::IDENTITY, &outline, sides, Vec3::ONE);
    trunk.bar(Mat4::from_translation(-0.5 * Vec3::Y), 0.14, 1.4, sides, Vec3::ONE);
    let places = CYPRESSES.map(|c| stand(c, 0.05));
    scene.add_at("cypress", crown, palette.cypress, &places);
    scene.add_at("cypress trunk", trunk, palette.bark, &places);

    // Three balls of leaves that reach into each other on a leaning trunk.
    let (mut crown, mut trunk) = (Builder::default(), Builder::default());
    for (x, y, z, radius, flat, shade) in [
        (0.0, 2.45, 0.0, 1.25, 0.80, 1.0),
        (0.85, 2.1, 0.35, 0.85, 0.82, 0.93),
        (-0.7, 2.2, -0.5, 0.9, 0.8, 0.88),
        (-0.1, 2.1, 0.85, 0.75, 0.8, 0.96),
    ] {
        let place = Mat4::from_translation(Vec3::new(x, y, z));
        let size = Mat4::from_scale(Vec3::new(radius, flat * radius, radius));
        crown.ball(place * size, sides, Vec3::splat(shade));
    }
    let outline = [[0.0, -0.6], [0.34, -0.6], [0.24, 0.1], [0.17, 0.8], [0.2, 1.9], [0.0, 1.95]];
    trunk.turned(Mat4::from_rotation_z(0.1), &outline, sides, Vec3::ONE);
    let places = OLIVES.map(|o| stand(o, 0.05));
    scene.add_at("olive tree", crown, palette.olive, &places);
    scene.add_at("olive trunk", trunk, palette.bark, &places);

    let mut rock = Builder::default();
    let tilted = Mat4::from_rotation_z(0.35) * Mat4::from_scale(Vec3::new(1.0, 0.62, 0.8));
    rock.ball(tilted, sides, Vec3::ONE);
    let places = ROCKS.map(|r| stand(r, 0.12 * r[2]));
    scene.add_at("rock", rock, palette.rock, &places);
}
