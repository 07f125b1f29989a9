//! Propagation is linear, has no scale and no preferred side, whatever its surfaces are like.

use libtest_mimic::Failed;
use lumivox::glam::{UVec3, Vec3};
use lumivox::gpu::GpuError;

use lumivox::light::Reflection;

use crate::cells::{Cells, Incident, REFLECTIONS, incident, incident_by};
use crate::support::Random;
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("light: propagation is linear", linear),
    ("light: propagation is scale-free", scale_free),
    ("light: a mirrored scene is lit like its mirror image", mirrored),
    ("light: the same light gives the same bits, on every tier", same_bits),
];

/// Scattered surfaces that look into all directions, some of them lit, some of which let light through.
fn clutter(seed: u64) -> Cells {
    let mut random = Random::new(seed);
    let mut cells = Cells::new(16);
    for cell in cells.grid.cells() {
        if random.unit() < 0.2 {
            let normal = (random.cube() - 0.5).try_normalize().unwrap_or(Vec3::Y);
            let albedo = 0.7 * random.unit();
            let occupancy = if random.unit() < 0.3 { random.unit().max(0.01) } else { 1.0 };
            cells.veil(cell, normal, albedo, occupancy);
        }
    }
    cells
}

fn lit_at_random(cells: &Cells, seed: u64) -> Cells {
    let (mut cells, mut random) = (cells.clone(), Random::new(seed));
    for index in 0..cells.normal.len() {
        if cells.occupied(index) && random.unit() < 0.3 {
            cells.light(index, 8.0 * random.cube());
        }
    }
    cells
}

/// Differences over values, summed over all coefficients of all cells; and the same for the worst cell, over the mean of
/// the cells that have light.
fn distance(a: &Incident, b: &Incident) -> (f64, f64) {
    let magnitude = |cell: &[[f32; 4]; 3]| cell.iter().flatten().map(|v| f64::from(v.abs())).sum::<f64>();
    let difference = |(a, b): (&[[f32; 4]; 3], &[[f32; 4]; 3])| -> f64 {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from((a - b).abs())).sum()
    };
    let total: f64 = b.iter().map(magnitude).sum();
    let lit = b.iter().filter(|c| magnitude(c) > 0.0).count() as f64;
    let off: Vec<f64> = a.iter().zip(b).map(difference).collect();
    (off.iter().sum::<f64>() / total, off.iter().fold(0.0, |a: f64, b| a.max(*b)) / (total / lit))
}

const STEPS: u32 = 24;
/// Each step rounds every coefficient to a half float, by half a unit in the last of 11 places at most. Such errors
/// grow with the root of their number.
fn half_float_bound(runs: u32) -> f64 {
    f64::from(runs) * f64::from(STEPS).sqrt() / 4096.0
}

fn linear(labs: &Labs) -> Result<(), Failed> {
    REFLECTIONS.into_iter().try_for_each(|(name, kind)| linear_by(labs, name, kind))
}

fn linear_by(labs: &Labs, name: &str, kind: Reflection) -> Result<(), Failed> {
    let incident = |cells| incident_by(&labs.core, cells, kind, STEPS);
    let empty = clutter(1);
    let (a, b) = (lit_at_random(&empty, 2), lit_at_random(&empty, 3));
    let mut both = empty;
    for (index, direct) in both.direct.iter_mut().enumerate() {
        *direct = std::array::from_fn(|band| a.direct[index][band] + 2.0 * b.direct[index][band]);
    }
    let [of_a, of_b] = [incident(&a)?, incident(&b)?];
    let of_both = incident(&both)?;
    let mut sum = of_a;
    for (cell, b) in sum.iter_mut().flatten().flatten().zip(of_b.iter().flatten().flatten()) {
        *cell += 2.0 * b;
    }
    let (total, worst) = distance(&sum, &of_both);
    eprintln!("linearity, {name}: off by {total:.2e} in all, by {worst:.2e} of a mean cell at worst");
    assert!(of_both.iter().flatten().flatten().any(|v| *v > 1.0), "nothing is lit");
    let bound = half_float_bound(3);
    assert!(total < bound && worst < bound, "off by {total} in all, {worst} at worst");
    Ok(())
}

/// Powers of two change no digit of a floating-point number, so the result is the same but for numbers below the
/// smallest normal half float.
fn scale_free(labs: &Labs) -> Result<(), Failed> {
    let one = lit_at_random(&clutter(4), 5);
    let mut many = one.clone();
    many.direct.iter_mut().flatten().for_each(|band| *band *= 64.0);
    let one = incident(&labs.core, &one, STEPS)?;
    let many = incident(&labs.core, &many, STEPS)?;
    let subnormal_step = 2f32.powi(-24);
    let tolerance = subnormal_step * 6.0 * (STEPS * STEPS) as f32;
    for (cell, (a, b)) in one.iter().flatten().zip(many.iter().flatten()).enumerate() {
        for i in 0..4 {
            let off = (64.0 * a[i] - b[i]).abs() / 64.0;
            assert!(off <= tolerance, "cell {}: {} becomes {}", cell / 3, a[i], b[i]);
        }
    }
    Ok(())
}

fn mirrored(labs: &Labs) -> Result<(), Failed> {
    REFLECTIONS.into_iter().try_for_each(|(name, kind)| mirrored_by(labs, name, kind))
}

fn mirrored_by(labs: &Labs, name: &str, kind: Reflection) -> Result<(), Failed> {
    let scene = lit_at_random(&clutter(6), 7);
    for axis in 0..3 {
        let flip = |cell: UVec3| {
            let mut cell = cell;
            cell[axis] = scene.grid.dims[axis] - 1 - cell[axis];
            scene.grid.index(cell)
        };
        let mut image = scene.clone();
        for (index, cell) in scene.grid.cells().enumerate() {
            let from = flip(cell);
            image.normal[index] = scene.normal[from];
            image.normal[index][axis] *= -1.0;
            image.albedo[index] = scene.albedo[from];
            image.direct[index] = scene.direct[from];
            image.direct[index].iter_mut().for_each(|band| band[axis + 1] *= -1.0);
        }
        let expected = incident_by(&labs.core, &scene, kind, STEPS)?;
        let got = incident_by(&labs.core, &image, kind, STEPS)?;
        let back: Incident = scene
            .grid
            .cells()
            .map(|cell| {
                got[flip(cell)].map(|mut band| {
                    band[axis + 1] *= -1.0;
                    band
                })
            })
            .collect();
        let (total, worst) = distance(&back, &expected);
        eprintln!(
            "{name}, mirrored along {axis}: off by {total:.2e} in all, by {worst:.2e} of a mean cell at worst"
        );
        // The neighbours are added up in another order, and two runs are rounded.
        let bound = half_float_bound(2);
        assert!(total < bound && worst < bound, "along {axis}: off by {total} in all, {worst} at worst");
    }
    Ok(())
}

fn same_bits(labs: &Labs) -> Result<(), Failed> {
    REFLECTIONS.into_iter().try_for_each(|(_, kind)| same_bits_by(labs, kind))
}

fn same_bits_by(labs: &Labs, kind: Reflection) -> Result<(), Failed> {
    let scene = lit_at_random(&clutter(8), 9);
    let bits = |lab| -> Result<Vec<u32>, GpuError> {
        let light = incident_by(lab, &scene, kind, STEPS)?;
        Ok(light.iter().flatten().flatten().map(|v| v.to_bits()).collect())
    };
    let first = bits(&labs.core)?;
    assert!(first.iter().filter(|b| **b != 0).count() > 1000);
    assert!(first == bits(&labs.core)?, "two runs on one device differ");
    assert!(first == bits(&labs.native)?, "two tiers differ");
    Ok(())
}
