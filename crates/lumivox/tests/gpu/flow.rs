//! Light that flows: at rest it is the light of all bounces, and changes come without a jump.

use libtest_mimic::Failed;
use lumivox::glam::{UVec3, Vec3};

use crate::cells::{Cells, Incident, incident, uploaded};
use crate::support::{locked, run};
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("flow: at rest it is the light of all bounces, and stands still", at_rest),
    ("flow: a lamp that is switched comes and goes without a jump", switched),
];

const STEPS: u32 = 4;

fn room(lamp: f32) -> Cells {
    let mut cells = Cells::new(16);
    cells.room(0, 15, 0.6, 0.0);
    for (cell, power) in [(UVec3::new(6, 0, 5), 8.0), (UVec3::new(0, 9, 9), 4.0)] {
        cells.light(cells.grid.index(cell), lamp * power * Vec3::new(1.0, 0.5, 0.25));
    }
    cells
}

fn brightness(light: &Incident) -> f64 {
    light.iter().flatten().map(|band| f64::from(band[0])).sum()
}

/// Largest difference of two lights, over the mean of the cells that have any.
fn difference(a: &Incident, b: &Incident) -> f64 {
    let lit = b.iter().flatten().filter(|band| band[0] != 0.0).count().max(1);
    let mean = brightness(b) / lit as f64;
    let pairs = a.iter().flatten().flatten().zip(b.iter().flatten().flatten());
    pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max) / mean
}

/// Largest difference of a cell's irradiance without regard to direction, over its own; of cells that have a twentieth of the mean or
/// more.
fn unrest(a: &Incident, b: &Incident) -> f64 {
    let lit = b.iter().flatten().filter(|band| band[0] != 0.0).count().max(1);
    let mean = brightness(b) / lit as f64;
    let pairs = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (f64::from(a[0]), f64::from(b[0])));
    pairs.filter(|(_, b)| *b > 0.05 * mean).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

fn at_rest(labs: &Labs) -> Result<(), Failed> {
    let lab = &labs.core;
    let gpu = &lab.gpu;
    let all_bounces = incident(lab, &room(1.0), 400)?;
    let (world, stages) = uploaded(lab, &room(1.0))?;
    let light = &mut locked(&stages).light;
    let mut flow = |steps| -> Result<Incident, Failed> {
        run(gpu, |e| {
            light.record_transport(gpu, e, &world.volume)?;
            light.record_flow(gpu, e, &world.volume, &world.light, steps)
        })?;
        Ok(light.read_incident(gpu)?)
    };
    let settled = flow(400)?;
    let frames = [flow(STEPS)?, flow(STEPS)?];
    let (off, restless) = (difference(&settled, &all_bounces), unrest(&frames[0], &frames[1]));
    let sums = brightness(&settled) / brightness(&all_bounces);
    eprintln!(
        "flow at rest: {sums:.5} of all bounces, off by {off:.2e} at worst, frames differ by {restless:.2e}"
    );
    // Both round each step to half floats; what flows does so where the light of many bounces is already together.
    assert!((sums - 1.0).abs() < 2e-3 && off < 0.05, "{sums}, {off}");
    // A quarter of a level of 255 where it shows most, in white: sRGB is 1.055 L^(1/2.4) there, so a change of L by a part `r` is
    // one of 255 * 1.055 / 2.4 * r levels.
    assert!(restless < 0.25 / (255.0 * 1.055 / 2.4), "frames at rest differ by {restless}");
    Ok(())
}

/// Brightness frame by frame, over that at rest: the lamp comes on and goes out again.
fn switched(labs: &Labs) -> Result<(), Failed> {
    let lab = &labs.core;
    let gpu = &lab.gpu;
    let rest = brightness(&incident(lab, &room(1.0), 400)?);
    let (mut world, stages) = uploaded(lab, &room(0.0))?;
    let light = &mut locked(&stages).light;
    run(gpu, |e| {
        light.record_transport(gpu, e, &world.volume)?;
        light.record_flow(gpu, e, &world.volume, &world.light, 1000)
    })?;
    let mut frames = |world: &mut crate::support::World, cells: &Cells| -> Result<Vec<f64>, Failed> {
        world.light.upload(gpu, &cells.direct);
        let mut seen = Vec::new();
        for _ in 0..60 {
            run(gpu, |e| light.record_flow(gpu, e, &world.volume, &world.light, STEPS))?;
            seen.push(brightness(&light.read_incident(gpu)?) / rest);
        }
        Ok(seen)
    };
    let (on, off) = (frames(&mut world, &room(1.0))?, frames(&mut world, &room(0.0))?);
    eprintln!("on: {:.3?}\noff: {:.3?}", &on[..24], &off[..24]);
    let largest = |seen: &[f64]| seen.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    // A pulse that is shown when it has died down would come in one frame.
    assert!(largest(&on) < 0.2 && largest(&off) < 0.2, "{on:?}, {off:?}");
    assert!((on[59] - 1.0).abs() < 0.005, "{}", on[59]);
    assert!(off[59].abs() < 0.005, "{}", off[59]);
    Ok(())
}
