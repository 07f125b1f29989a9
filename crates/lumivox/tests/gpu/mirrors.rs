//! One beam on one cell: where each kind of surface sends it, by closed form.

use std::f32::consts::PI;

use libtest_mimic::Failed;
use lumivox::glam::{UVec3, Vec3, Vec4};
use lumivox::light::{LightSettings, Reflection};

use crate::cells::{Cells, Incident, REFLECTIONS, propagate_by};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("mirrors: a wall sends a beam where its kind says", walls),
    ("mirrors: a veil sends its part of a beam where its kind says", veils),
];

const SIDE: u32 = 8;
/// The empty cell that the beam comes through.
const MIDDLE: UVec3 = UVec3::new(3, 3, 3);
const ALBEDO: f32 = 0.5;

/// A beam along an axis, and two directions across.
#[derive(Clone, Copy, Debug)]
struct Beam {
    along: Vec3,
    across: [Vec3; 2],
}

/// Along each axis, both ways, each on two of the surfaces.
fn beams() -> impl Iterator<Item = (Beam, Vec3, Vec3)> {
    (0..6).flat_map(|n| {
        let axes: [Vec3; 3] = std::array::from_fn(|axis| Vec3::AXES[(n / 2 + axis) % 3]);
        let along = if n % 2 == 0 { axes[0] } else { -axes[0] };
        let beam = Beam { along, across: [axes[1], axes[2]] };
        [n, n + 1].map(|which| MIRRORED[which % MIRRORED.len()]).map(|(n, mirrored)| (beam, n, mirrored))
    })
}

impl Beam {
    /// From the frame of the beam.
    fn turn(self, v: Vec3) -> Vec3 {
        v.x * self.along + v.y * self.across[0] + v.z * self.across[1]
    }

    fn faces(self) -> [Vec3; 6] {
        [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|face| self.turn(face))
    }
}

/// Normals towards a beam along x, and where a mirror about them sends it: v - 2 (v.n) n of v = x.
const MIRRORED: [(Vec3, Vec3); 4] = [
    (Vec3::NEG_X, Vec3::NEG_X),
    // At 45 degrees: wholly to the side.
    (Vec3::new(-std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2, 0.0), Vec3::Y),
    (Vec3::new(-0.8, 0.0, 0.6), Vec3::new(-0.28, 0.0, 0.96)),
    (Vec3::new(-2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0), Vec3::new(1.0 / 9.0, 8.0 / 9.0, -4.0 / 9.0)),
];

fn beside(cell: UVec3, face: Vec3) -> UVec3 {
    (cell.as_ivec3() + face.as_ivec3()).as_uvec3()
}

/// A lamp before an empty cell, what it shines on behind that, and black walls around.
fn scene(beam: Beam, normal: Vec3, occupancy: f32) -> Cells {
    let mut cells = Cells::new(SIDE);
    let target = beside(MIDDLE, beam.along);
    for face in beam.faces() {
        cells.surface(beside(MIDDLE, face), -face, 0.0);
        if occupancy < 1.0 {
            cells.surface(beside(target, face), -face, 0.0);
        }
    }
    let lamp = beside(MIDDLE, -beam.along);
    cells.surface(lamp, beam.along, 0.0);
    // Behind the lamp: nothing goes there.
    cells.surface(beside(lamp, -beam.along), -beam.along, 0.0);
    cells.light(cells.grid.index(lamp), Vec3::ONE);
    cells.veil(target, beam.turn(normal), ALBEDO, occupancy);
    if occupancy < 1.0 {
        // The empty cell, which is a neighbour of what it shines on, too.
        let middle = cells.grid.index(MIDDLE);
        cells.normal[middle] = Vec4::ZERO;
    }
    cells
}

/// Flux that each wall around `cell` receives in step `step`, in the order of the beam's faces, as parts of the lamp's.
fn received(cells: &Cells, beam: Beam, cell: UVec3, frames: &[(f64, Incident)], step: usize) -> [f32; 6] {
    beam.faces().map(|face| {
        let wall = cells.grid.index(beside(cell, face));
        let [before, now] = [&frames[step - 1], &frames[step]].map(|(_, light)| light[wall][0][0]);
        (now - before) * PI.sqrt() / PI
    })
}

fn frames_of(labs: &Labs, cells: &Cells, kind: Reflection) -> Result<Vec<(f64, Incident)>, Failed> {
    let mut frames = Vec::new();
    let way = (kind, LightSettings::default());
    propagate_by(&labs.core, cells, way, (1, 4), |flux, light| frames.push((flux, light)))?;
    Ok(frames)
}

/// The shares of a lobe that sends nothing straight back, in the order of [`Beam::faces`], in the beam's frame.
fn shares(direction: Vec3) -> [f32; 6] {
    let d = direction;
    [d.x, -d.x, d.y, -d.y, d.z, -d.z].map(|along| (1.0 + along) / 6.0)
}

/// Half floats: a few roundings by 1/2048 of what is there.
const TOLERANCE: f32 = 1e-3;

fn alike(found: &[f32], expected: &[f32]) -> bool {
    found.iter().zip(expected).all(|(f, e)| (f - e).abs() < TOLERANCE)
}

/// Step 1 fills the empty cell, step 2 its walls: a third ahead, a sixth to each side, nothing back. What a mirror has of it is in
/// the empty cell again in the same step, and on its walls in step 3; what another surface has, one step later.
fn walls(labs: &Labs) -> Result<(), Failed> {
    let mut wrong = Vec::new();
    for (beam, normal, mirrored) in beams() {
        for (name, kind) in REFLECTIONS {
            let cells = scene(beam, normal, 1.0);
            let frames = frames_of(labs, &cells, kind)?;
            let [sent, again] = [2, 3].map(|step| received(&cells, beam, MIDDLE, &frames, step));
            let returned = match kind {
                Reflection::Lambertian => [0.0; 6],
                Reflection::AxisMirror => shares(Vec3::NEG_X),
                Reflection::NormalMirror => shares(mirrored),
            };
            let returned = returned.map(|share| share * ALBEDO / 3.0);
            // What a slanted surface receives counts by how it faces the light; the walls at its sides do not.
            let on_walls = alike(&sent[1..], &shares(Vec3::X)[1..]) && alike(&again[1..], &returned[1..]);
            let ratio = again[0] / sent[0];
            let on_target = (ratio - 3.0 * returned[0]).abs() < TOLERANCE;
            if !on_walls || !on_target {
                wrong.push(format!(
                        "{name}, {beam:?}, normal {normal}: {sent:.4?}, then {again:.4?} in place of {returned:.4?}"
                    ));
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n").into()) }
}

/// A surface that lets a part through has its part of the beam in step 2, and its neighbours that in step 3: one lobe onwards, and one
/// about where the surface reflects.
fn veils(labs: &Labs) -> Result<(), Failed> {
    const OCCUPANCY: f32 = 102.0 / 255.0;
    let persistence = LightSettings::default().persistence;
    let mut wrong = Vec::new();
    for (beam, normal, mirrored) in beams() {
        for (name, kind) in REFLECTIONS {
            let cells = scene(beam, normal, OCCUPANCY);
            let frames = frames_of(labs, &cells, kind)?;
            let target = beside(MIDDLE, beam.along);
            let found = received(&cells, beam, target, &frames, 3);
            let about = shares(match kind {
                Reflection::Lambertian => normal,
                Reflection::AxisMirror => Vec3::NEG_X,
                Reflection::NormalMirror => mirrored,
            });
            let expected: [f32; 6] = std::array::from_fn(|face| {
                let ahead = [1.0, -1.0, 0.0, 0.0, 0.0, 0.0][face];
                let passing = 1.0 / 6.0 + 0.5 * persistence * ahead;
                ((1.0 - OCCUPANCY) * passing + OCCUPANCY * ALBEDO * about[face]) / 3.0
            });
            // The second face is that of the empty cell, which keeps no light.
            let [found, expected] = [found, expected].map(|all| [all[0], all[2], all[3], all[4], all[5]]);
            if !alike(&found, &expected) {
                wrong.push(format!(
                    "{name}, {beam:?}, normal {normal}: {found:.4?} in place of {expected:.4?}"
                ));
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n").into()) }
}
