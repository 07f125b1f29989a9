//! What encloses the colonnade: outer walls of coursed stone, slabs, cornices and the roof.

use glam::Vec3;

use super::{BAY, CEILING, COURT, Detail, EAVES, GALLERY, Palette, RIM, UPPER_CEILING, WALL, shade};
use crate::builtin::builder::{Builder, SceneBuilder};

/// Thickness of the outer walls.
const THICK: f32 = 0.4;
/// Height of the glazed tiles at the foot of the walls.
const DADO: f32 = 1.1;

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let mut wall = Builder::default();
    let mut dado = Builder::default();
    // Seen from inside, from left to right: `origin + s along`, with `in` towards the court.
    for (inwards, length) in
        [(Vec3::Z, WALL[0]), (Vec3::NEG_Z, WALL[0]), (Vec3::X, WALL[1]), (Vec3::NEG_X, WALL[1])]
    {
        let along = Vec3::Y.cross(inwards);
        let distance = if inwards.z == 0.0 { WALL[0] } else { WALL[1] };
        let origin = -distance * inwards - length * along;
        courses(&mut dado, origin, along, 2.0 * length, [0.0, DADO], [0.6, DADO / 3.0], 0.3, detail);
        for heights in [[DADO, CEILING], [GALLERY, UPPER_CEILING]] {
            courses(&mut wall, origin, along, 2.0 * length, heights, [1.2, 0.6], 0.2, detail);
        }
        let back = origin - THICK * inwards - THICK * along + (2.0 * length + 2.0 * THICK) * along;
        wall.grid(back, -(2.0 * length + 2.0 * THICK) * along, RIM * Vec3::Y, [1, 1], Vec3::splat(0.95));
    }
    scene.add("outer walls", wall, palette.wall);
    scene.add("glazed tiles", dado, palette.dado);

    let mut ceilings = Builder::default();
    let mut trim = Builder::default();
    ring(&mut ceilings, [CEILING, GALLERY], [COURT[0] - 0.2, COURT[1] - 0.2], WALL, detail);
    ring(&mut ceilings, [UPPER_CEILING, UPPER_CEILING + 0.05], COURT, WALL, detail);
    scene.add("slabs", ceilings, palette.plaster);
    // String course at the gallery and a stepped cornice under the eaves, in front of the colonnade's face.
    for (heights, reach) in [
        ([CEILING - 0.02, CEILING + 0.1], 0.30),
        ([CEILING + 0.1, GALLERY + 0.05], 0.38),
        ([UPPER_CEILING - 0.05, UPPER_CEILING + 0.1], 0.32),
        ([UPPER_CEILING + 0.1, UPPER_CEILING + 0.25], 0.42),
        ([UPPER_CEILING + 0.25, EAVES], 0.52),
    ] {
        let inner = [COURT[0] - reach, COURT[1] - reach];
        ring(&mut trim, heights, inner, [COURT[0] + 0.2, COURT[1] + 0.2], detail);
    }
    ring(&mut trim, [RIM - 0.05, RIM + 0.1], WALL, [WALL[0] + THICK, WALL[1] + THICK], detail);
    scene.add("cornices", trim, palette.trim);
    roof(scene, palette, detail);
    beams(scene, palette, detail);
}

/// Stones of `size` in running bond over a wall face, each with its own shade.
#[expect(
    clippy::too_many_arguments,
    reason = "a private function with few callers; a struct would only rename them"
)]
fn courses(
    b: &mut Builder,
    origin: Vec3,
    along: Vec3,
    length: f32,
    heights: [f32; 2],
    size: [f32; 2],
    spread: f32,
    detail: &Detail,
) {
    let coarse = detail.pick([6.0, 3.0, 1.0, 1.0, 1.0f32]);
    let steps = detail.pick([1, 1, 1, 1, 2]);
    let [low, high] = heights;
    let rows = ((high - low) / (size[1] * coarse.min(4.0))).round().max(1.0);
    let row_height = (high - low) / rows;
    let width = size[0] * coarse;
    for row in 0..rows as u32 {
        let mut start = 0.0;
        let mut column = 0;
        while start < length - 1e-3 {
            // Odd rows start with half a stone.
            let stone = if row % 2 == 1 && column == 0 { 0.5 * width } else { width };
            let end = (start + stone).min(length);
            let corner = origin + start * along + (low + row as f32 * row_height) * Vec3::Y;
            let seed = (origin.x * 31.0 + origin.z * 17.0 + low * 53.0) as i32 as u32;
            let color = shade(seed ^ (row * 8191 + column), spread);
            b.grid(corner, (end - start) * along, row_height * Vec3::Y, [steps; 2], color);
            start = end;
            column += 1;
        }
    }
}

/// A rectangular frame of four boxes between the half sizes `inner` and `outer`, mitred at the corners.
fn ring(b: &mut Builder, heights: [f32; 2], inner: [f32; 2], outer: [f32; 2], detail: &Detail) {
    let cells = detail.pick([1, 1, 2, 4, 8]);
    let corner = |half: [f32; 2], k: usize, y: f32| {
        let (sx, sz) = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)][k % 4];
        Vec3::new(sx * half[0], y, sz * half[1])
    };
    let [low, high] = heights;
    for k in 0..4 {
        let [a, b0] = [k, k + 1];
        let faces = [
            [
                corner(outer, a, high),
                corner(outer, b0, high),
                corner(inner, b0, high),
                corner(inner, a, high),
            ],
            [corner(inner, a, low), corner(inner, b0, low), corner(outer, b0, low), corner(outer, a, low)],
            [corner(inner, a, high), corner(inner, b0, high), corner(inner, b0, low), corner(inner, a, low)],
            [corner(outer, a, low), corner(outer, b0, low), corner(outer, b0, high), corner(outer, a, high)],
        ];
        for face in faces {
            b.quad(face, [cells, 1], Vec3::ONE);
        }
    }
}

/// Four slopes from the rim down to the eaves, in rows of tiles.
fn roof(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let mut b = Builder::default();
    let rows = detail.pick([1, 2, 6, 8, 12]);
    let cells = detail.pick([1, 2, 4, 12, 24]);
    let at = |k: usize, t: f32| {
        let (sx, sz) = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)][k % 4];
        let inner = Vec3::new(COURT[0] - 0.6, EAVES + 0.04, COURT[1] - 0.6);
        let p = Vec3::new(WALL[0], RIM, WALL[1]).lerp(inner, t);
        Vec3::new(sx * p.x, p.y, sz * p.z)
    };
    for k in 0..4 {
        for row in 0..rows {
            let (t, u) = (row as f32 / rows as f32, (row + 1) as f32 / rows as f32);
            // Each row lies on the next one.
            let lift = 0.03 * Vec3::Y;
            let corners = [at(k, t), at(k + 1, t), at(k + 1, u) + lift, at(k, u) + lift];
            b.quad(corners, [cells, 1], shade(row * 4 + k as u32, 0.25));
        }
        b.quad(
            [at(k, 1.0), at(k + 1, 1.0), at(k + 1, 1.0) - 0.06 * Vec3::Y, at(k, 1.0) - 0.06 * Vec3::Y],
            [cells, 1],
            Vec3::ONE,
        );
    }
    scene.add("roof", b, palette.roof);
}

/// Dark beams under the gallery's ceiling, two to a bay of the long sides.
fn beams(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let mut b = Builder::default();
    let per_bay = detail.pick([1, 2, 2, 2, 2]);
    let steps = detail.pick([1, 1, 1, 2, 3]);
    let count = (2.0 * COURT[0] / BAY).round() as u32 * per_bay;
    for side in [-1.0, 1.0] {
        for i in 0..=count {
            let x = -COURT[0] + 2.0 * COURT[0] * i as f32 / count as f32;
            let center = Vec3::new(x, UPPER_CEILING - 0.11, side * 0.5 * (COURT[1] + WALL[1]));
            b.block(center, Vec3::new(0.16, 0.22, WALL[1] - COURT[1]), 0.0, steps, shade(i, 0.3));
        }
    }
    scene.add("beams", b, palette.wood);
}
