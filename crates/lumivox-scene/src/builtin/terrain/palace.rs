//! The palace: a podium with steps, a hall behind a portico, a storey above it, a wing across the court.

use glam::{Mat4, Vec3};

use super::land::LEVEL;
use super::{Cuts, Palette};
use crate::builtin::builder::{Builder, SceneBuilder};
use crate::builtin::masonry::{Masonry, weathered};

/// Heights: the hall's roof, the roof above the storey on it, and the wing's roof.
const HALL: f32 = 3.4;
const STOREY: f32 = 6.2;
const WING: f32 = 2.9;
/// Floors inside lie this high over the paving.
const FLOOR: f32 = 0.06;
/// Thickness of a roof, and how far it hangs over.
const ROOF: f32 = 0.36;
const OVER: f32 = 0.3;

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    podium(scene, palette, cuts);
    hall(scene, palette, cuts);
    wing(scene, palette, cuts);
    columns(scene, palette, cuts);
    horns(scene, palette, cuts);
    jars(scene, palette, cuts);
}

/// A paved platform, nine broad steps up to it between low walls.
fn podium(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let foot = LEVEL - 0.6;
    let mut m = Masonry::default();
    m.fill([-11.0, foot, -9.0], [11.0, 0.0, 5.0], palette.podium);
    m.fill([-10.7, -0.2, -8.7], [10.7, 0.0, 4.7], palette.paving);
    // Later boxes win, so the highest steps come last.
    for i in (0..9).rev() {
        let (top, near) = (-0.18 * (i + 1) as f32, 5.0 + 0.36 * (i + 1) as f32);
        m.fill([-3.0, foot, 5.0], [3.0, top, near], palette.pale);
    }
    for side in [-1.0, 1.0] {
        let (a, b): (f32, f32) = (side * 3.0, side * 3.7);
        m.fill([a.min(b), foot, 4.3], [a.max(b), 0.45, 5.0], palette.podium);
        m.fill([a.min(b), foot, 5.0], [a.max(b), -0.1, 6.8], palette.podium);
        m.fill([a.min(b), foot, 6.8], [a.max(b), -1.0, 8.5], palette.podium);
    }
    m.finish(scene, "podium", cuts.longest, weathered);
}

/// Walls of a room with a floor of its own, open above; roofs go on top.
fn shell(m: &mut Masonry, min: [f32; 3], max: [f32; 3], thick: f32, material: usize) {
    m.fill(min, max, material);
    m.cut([min[0] + thick, FLOOR, min[2] + thick], [max[0] - thick, max[1], max[2] - thick]);
}

/// A roof with a painted edge and a low parapet.
fn roof(m: &mut Masonry, [x0, x1]: [f32; 2], top: f32, [z0, z1]: [f32; 2], edge: usize, flat: usize) {
    m.fill([x0 - OVER, top, z0 - OVER], [x1 + OVER, top + ROOF, z1 + OVER], edge);
    m.fill([x0 - 0.1, top + 0.1, z0 - 0.1], [x1 + 0.1, top + ROOF, z1 + 0.1], flat);
    m.fill([x0 - OVER, top - 0.14, z0 - OVER], [x1 + OVER, top, z1 + OVER], flat);
}

fn hall(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let mut m = Masonry::default();
    shell(&mut m, [-9.5, -0.1, -8.2], [1.5, HALL, -2.2], 0.45, palette.plaster);
    // A painted band at the foot, as high as a bench.
    m.fill([-9.5, -0.1, -2.65], [1.5, 0.9, -2.2], palette.ochre);
    for x in [-8.0, -5.0, -2.0] {
        m.cut([x - 0.7, FLOOR, -2.7], [x + 0.7, 2.4, -2.1]);
    }
    m.cut([0.2, 0.9, -2.7], [1.0, 2.3, -2.1]);
    for z in [-7.0, -5.0] {
        m.cut([1.0, 0.9, z], [1.6, 2.3, z + 1.1]);
    }
    roof(&mut m, [-9.5, 1.5], HALL, [-8.2, 1.0], palette.red, palette.plaster);
    // The storey above stands on the roof.
    let low = HALL + ROOF;
    m.fill([-9.5, low, -8.2], [-2.5, STOREY, -3.6], palette.plaster);
    m.cut([-9.1, low, -7.8], [-2.9, STOREY, -4.0]);
    for x in [-8.3, -6.4, -4.5] {
        m.cut([x, low + 0.7, -4.1], [x + 0.95, low + 2.0, -3.5]);
    }
    m.cut([-3.0, low, -6.4], [-2.4, low + 2.1, -5.3]);
    roof(&mut m, [-9.5, -2.5], STOREY, [-8.2, -3.6], palette.blue, palette.plaster);
    m.finish(scene, "hall", cuts.longest, weathered);
}

/// A long low building at the right of the court, open to it between square piers.
fn wing(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let mut m = Masonry::default();
    shell(&mut m, [5.2, -0.1, -8.2], [10.2, WING, 1.6], 0.4, palette.ochre);
    for i in 0..4 {
        let z = -7.4 + 2.25 * i as f32;
        m.cut([5.1, FLOOR, z], [5.7, 2.3, z + 1.55]);
    }
    m.cut([6.8, FLOOR, 1.1], [8.2, 2.3, 1.7]);
    roof(&mut m, [5.2, 10.2], WING, [-8.2, 1.6], palette.red, palette.plaster);
    m.finish(scene, "wing", cuts.longest, weathered);
}

/// Columns that taper downwards, red with black cushions, as the Minoans had them.
fn columns(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let height = HALL - 0.14;
    let feet: Vec<Mat4> = [-8.9, -6.5, -4.1, -1.7, 0.7]
        .into_iter()
        .map(|x| Mat4::from_translation(Vec3::new(x, 0.0, 0.55)))
        .collect();
    let (mut base, mut shaft, mut cushion) = (Builder::default(), Builder::default(), Builder::default());
    base.turned(
        Mat4::IDENTITY,
        &[[0.0, -0.03], [0.36, -0.03], [0.36, 0.1], [0.3, 0.14], [0.0, 0.14]],
        cuts.sides,
        Vec3::ONE,
    );
    let top = height - 0.42;
    let outline = [[0.0, 0.12], [0.215, 0.12], [0.245, 0.5 * top], [0.275, top], [0.0, top]];
    shaft.turned(Mat4::IDENTITY, &outline, cuts.sides, Vec3::ONE);
    let outline = [
        [0.0, top - 0.02],
        [0.30, top - 0.02],
        [0.30, top + 0.05],
        [0.40, top + 0.12],
        [0.42, top + 0.2],
        [0.36, top + 0.28],
        [0.0, top + 0.28],
    ];
    cushion.turned(Mat4::IDENTITY, &outline, cuts.sides, Vec3::ONE);
    let abacus = Vec3::new(0.42, height + 0.05, 0.42);
    cushion.brick(Mat4::IDENTITY, Vec3::new(-0.42, top + 0.26, -0.42), abacus, 1, Vec3::ONE);
    scene.add_at("column base", base, palette.pale, &feet);
    scene.add_at("column shaft", shaft, palette.red, &feet);
    scene.add_at("column cushion", cushion, palette.black, &feet);
}

/// Stone horns along the edges of the roofs.
fn horns(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let mut b = Builder::default();
    let depth = 0.26;
    b.brick(
        Mat4::IDENTITY,
        Vec3::new(-0.44, -0.04, -0.15),
        Vec3::new(0.44, 0.2, 0.15),
        cuts.steps,
        Vec3::ONE,
    );
    let place = Mat4::from_translation(Vec3::new(0.0, 0.0, -0.5 * depth));
    let horn = [[0.14, 0.18], [0.42, 0.18], [0.47, 0.72], [0.40, 0.72]];
    b.prism(place, &horn, depth, cuts.steps, Vec3::ONE);
    let mirrored = [[-0.42, 0.18], [-0.14, 0.18], [-0.40, 0.72], [-0.47, 0.72]];
    b.prism(place, &mirrored, depth, cuts.steps, Vec3::ONE);
    let at = |x: f32, y: f32, z: f32| Mat4::from_translation(Vec3::new(x, y + ROOF, z));
    let mut places: Vec<Mat4> = (0..5).map(|i| at(-8.6 + 2.3 * i as f32, HALL, 1.05)).collect();
    places.extend((0..4).map(|i| at(-8.6 + 1.75 * i as f32, STOREY, -3.55)));
    let turn = Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2);
    places.extend((0..4).map(|i| at(5.15, WING, -7.0 + 2.5 * i as f32) * turn));
    scene.add_at("horns", b, palette.pale, &places);
}

/// Storage jars in the court and a round altar.
fn jars(scene: &mut SceneBuilder, palette: &Palette, cuts: &Cuts) {
    let mut b = Builder::default();
    let outline = [
        [0.0, -0.02],
        [0.22, -0.02],
        [0.36, 0.35],
        [0.46, 0.75],
        [0.44, 1.05],
        [0.30, 1.25],
        [0.27, 1.32],
        [0.34, 1.4],
        [0.29, 1.4],
        [0.22, 1.28],
        [0.0, 1.1],
    ];
    b.turned(Mat4::IDENTITY, &outline, cuts.sides, Vec3::ONE);
    let places: Vec<Mat4> =
        [(4.5, -6.9, 1.0), (4.55, -5.9, 0.85), (2.3, -1.7, 1.0), (4.4, 2.4, 0.9), (8.9, 2.6, 1.05)]
            .into_iter()
            .map(|(x, z, size)| {
                Mat4::from_translation(Vec3::new(x, 0.0, z)) * Mat4::from_scale(Vec3::splat(size))
            })
            .collect();
    scene.add_at("jar", b, palette.clay, &places);

    let mut b = Builder::default();
    let altar = [
        [0.0, -0.02],
        [0.8, -0.02],
        [0.8, 0.15],
        [0.55, 0.3],
        [0.5, 0.8],
        [0.75, 0.95],
        [0.75, 1.1],
        [0.0, 1.1],
    ];
    b.turned(Mat4::from_translation(Vec3::new(3.1, 0.0, -3.4)), &altar, cuts.sides, Vec3::ONE);
    scene.add("altar", b, palette.pale);
    let mut b = Builder::default();
    for (x, z, turn) in [(-5.2, 3.2, 0.1f32), (-7.0, 3.0, -0.2)] {
        let place = Mat4::from_translation(Vec3::new(x, 0.0, z)) * Mat4::from_rotation_y(turn);
        b.brick(place, Vec3::new(-0.7, 0.38, -0.2), Vec3::new(0.7, 0.46, 0.2), cuts.steps, Vec3::ONE);
        for x in [-0.55, 0.55] {
            b.brick(
                place,
                Vec3::new(x - 0.06, -0.02, -0.17),
                Vec3::new(x + 0.06, 0.4, 0.17),
                1,
                Vec3::splat(0.9),
            );
        }
    }
    scene.add("benches", b, palette.wood);
}
