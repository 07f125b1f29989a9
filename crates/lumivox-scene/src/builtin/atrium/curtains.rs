//! Long curtains between the columns of the ground floor: thin single sheets with soft folds, whole or tied back.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

use super::{BAY, Detail, Palette, SPRING, sides};
use crate::builtin::builder::{Builder, SceneBuilder};

/// How a bay is hung.
#[derive(Clone, Copy)]
enum Hanging {
    Open,
    Whole(usize),
    Tied(usize),
}
use Hanging::{Open, Tied, Whole};

/// Clear edges of the opening, and the heights of the rod, the tie and the hem.
const EDGES: [f32; 2] = [0.27, BAY - 0.27];
const ROD: f32 = SPRING - 0.16;
const TIE: f32 = 1.25;
const HEM: f32 = 0.12;

/// Bay by bay, in the order of [`sides`]; numbers are cloths. Bay 3 of the first side stays open: the walk leads there.
const HANGINGS: [&[Hanging]; 4] = [
    &[Open, Tied(3), Whole(1), Open, Tied(2), Tied(3), Open, Tied(0)],
    &[Whole(0), Tied(1), Whole(3), Tied(2), Whole(0), Open, Tied(1), Whole(2)],
    &[Tied(0), Open, Tied(0)],
    &[Tied(3), Tied(1), Tied(3)],
];

pub(super) fn add(scene: &mut SceneBuilder, palette: &Palette, detail: &Detail) {
    let mut cloths: [Builder; 4] = Default::default();
    let mut rods = Builder::default();
    for (bays, hangings) in sides().iter().zip(HANGINGS) {
        for (i, (bay, hanging)) in bays.iter().zip(hangings).enumerate() {
            let place = |p: Vec3| bay.world_from_bay.transform_point3(p);
            let turn = |v: Vec3| bay.world_from_bay.transform_vector3(v);
            let phase = i as f32 * 1.7;
            match *hanging {
                Open => continue,
                Whole(cloth) => sheet(&mut cloths[cloth], detail, phase, 5.0, 1.0, place, turn, |s, _| {
                    EDGES[0] + s * (EDGES[1] - EDGES[0])
                }),
                Tied(cloth) => {
                    for side in [0usize, 1] {
                        let edge = EDGES[side];
                        let inwards = if side == 0 { 1.0 } else { -1.0 };
                        sheet(&mut cloths[cloth], detail, phase, 3.0, 0.6, place, turn, move |s, y| {
                            edge + inwards * s * tied_width(y)
                        });
                    }
                }
            }
            let (a, b) = (
                place(Vec3::new(EDGES[0] - 0.1, ROD + 0.01, -0.02)),
                place(Vec3::new(EDGES[1] + 0.1, ROD + 0.05, 0.02)),
            );
            rods.slab(a.min(b), a.max(b), Vec3::ONE);
        }
    }
    for (cloth, (builder, name)) in cloths.into_iter().zip(["red", "gold", "green", "blue"]).enumerate() {
        scene.add(&format!("{name} curtains"), builder, palette.cloth[cloth]);
    }
    scene.add("curtain rods", rods, palette.wood);
}

/// Width of half a tied curtain at a height: full at the rod, narrow at the tie, falling open below.
fn tied_width(y: f32) -> f32 {
    let full = 0.5 * (EDGES[1] - EDGES[0]);
    let above = ((y - TIE) / (ROD - TIE)).clamp(0.0, 1.0);
    let below = ((TIE - y) / (TIE - HEM)).clamp(0.0, 1.0);
    0.22 + (full - 0.22) * above.powf(1.6) + 0.2 * (0.5 - 0.5 * (PI * below).cos())
}

/// One cloth: `x_at(s, y)` spreads `s` in 0..1 over the bay. Folds deepen towards the hem and lean a little.
#[expect(
    clippy::too_many_arguments,
    reason = "a private function with few callers; a struct would only rename them"
)]
fn sheet(
    b: &mut Builder,
    detail: &Detail,
    phase: f32,
    folds: f32,
    share: f32,
    place: impl Fn(Vec3) -> Vec3,
    turn: impl Fn(Vec3) -> Vec3,
    x_at: impl Fn(f32, f32) -> f32,
) {
    let across = (detail.pick([15, 20, 25, 40, 60]) as f32 * share).round() as u32;
    let down = detail.pick([2, 3, 5, 9, 15]);
    let point = |s: f32, t: f32| {
        let y = ROD + t * (HEM - ROD);
        // Narrow folds are shallow ones: steeper cloth would need more triangles than it is worth.
        let width = (x_at(1.0, y) - x_at(0.0, y)).abs() / folds;
        let depth = (0.035 + 0.05 * t).min(0.2 * width);
        let wave = (TAU * folds * s + phase + 0.9 * (2.2 * t + phase).sin()).sin();
        let drift = 0.03 * t * (PI * s * 2.0 + phase).sin();
        Vec3::new(x_at(s, y), y, depth * wave + drift)
    };
    b.sheet([across, down], Vec3::ONE, |s, t| {
        // Between the neighbouring vertices: the normals then fit the faces, however coarse.
        let (ds, dt) = (1.0 / across as f32, 1.0 / down as f32);
        let normal = (point(s, t - dt) - point(s, t + dt)).cross(point(s - ds, t) - point(s + ds, t));
        (place(point(s, t)), turn(normal))
    });
}
