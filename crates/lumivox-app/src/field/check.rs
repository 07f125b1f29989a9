//! A field against true rays.

use glam::Vec3;
use lumivox_field::{Baker, Field, Ray};
use rayon::prelude::*;
use serde::Serialize;

/// How far look-ups are from true rays, over lines through the bounding sphere that are even over all such lines.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Errors {
    /// Lines tried.
    pub(crate) lines: u32,
    /// The part of lines of which the verdict is wrong.
    pub(crate) wrong: f64,
    /// Root mean square of the distance's error over the sphere's diameter, where both meet the object.
    pub(crate) distance_rms: f64,
    /// Million rays or look-ups per second on all cores.
    pub(crate) million_per_second: f64,
}

/// Random lines through a sphere, the same every time.
pub(crate) fn lines(center: Vec3, radius: f32, count: u32) -> Vec<Ray> {
    let mut state = 0x853c_49e6_748f_ea9bu64;
    let mut unit = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    let mut on_sphere = move || {
        let (z, turn) = (2.0 * unit() - 1.0, std::f32::consts::TAU * unit());
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * turn.cos(), r * turn.sin(), z)
    };
    let line = |_| {
        let (a, b) = (on_sphere(), on_sphere());
        let direction = (b - a).normalize_or(-a);
        Ray::new(center + radius * (a - direction), direction)
    };
    (0..count).map(line).collect()
}

/// What rays meet, and million rays per second on all cores.
pub(crate) fn timed(
    rays: &[Ray],
    answer: impl Fn(&[Ray], &mut [Option<f32>]) + Sync,
) -> (Vec<Option<f32>>, f64) {
    let mut answers = vec![None; rays.len()];
    let start = crate::clock::millis();
    rays.par_chunks(4096).zip(answers.par_chunks_mut(4096)).for_each(|(rays, answers)| answer(rays, answers));
    (answers, rays.len() as f64 / (crate::clock::millis() - start).max(1e-6) / 1e3)
}

/// The true distances of rays.
pub(crate) fn traced(baker: &Baker, rays: &[Ray]) -> (Vec<Option<f32>>, f64) {
    timed(rays, |rays, answers| {
        answers.iter_mut().zip(rays).for_each(|(answer, ray)| *answer = baker.trace(ray));
    })
}

/// The errors of the nearest map, and of three, of an object with one field or several, whose nearest hit counts. Distances are held
/// against `diameter`.
pub(crate) fn errors(fields: &[Field], diameter: f32, rays: &[Ray], exact: &[Option<f32>]) -> [Errors; 2] {
    let nearer = |a: Option<f32>, b: Option<f32>| match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    };
    let nearest = timed(rays, |rays, answers| {
        let Some((first, others)) = fields.split_first() else { return };
        first.nearest_many(rays, answers);
        let mut other = vec![None; if others.is_empty() { 0 } else { rays.len() }];
        for field in others {
            field.nearest_many(rays, &mut other);
            answers.iter_mut().zip(&other).for_each(|(a, b)| *a = nearer(*a, *b));
        }
    });
    let blended = timed(rays, |rays, answers| {
        answers.iter_mut().zip(rays).for_each(|(answer, ray)| {
            *answer = fields.iter().fold(None, |found, field| nearer(found, field.blend(ray).hit()));
        });
    });
    [nearest, blended].map(|(found, million_per_second)| {
        let pairs = || found.iter().zip(exact);
        let wrong = pairs().filter(|(a, b)| a.is_some() != b.is_some()).count();
        let apart = pairs().filter_map(|(a, b)| Some(f64::from((*a)? - (*b)?) / f64::from(diameter)));
        let (sum, count) = apart.fold((0.0, 0u32), |(sum, count), d| (sum + d * d, count + 1));
        Errors {
            lines: rays.len() as u32,
            wrong: wrong as f64 / rays.len().max(1) as f64,
            distance_rms: (sum / f64::from(count.max(1))).sqrt(),
            million_per_second,
        }
    })
}
