//! A plain path tracer for Lambertian scenes.
//!
//! Radiance that leaves a surface is `L = emission + albedo / pi * E`, on both sides, with the irradiance `E` of
//! everything it sees. [`Tracer::render`] estimates `E` in each pixel by random paths and keeps apart what came straight
//! from a light (*direct*), after one reflection (*first bounce*) and after any number (*indirect*), as irradiance and as
//! the radiance that it adds to the picture, each with its standard error.
//!
//! - The same seed gives the same bits, whatever the number of threads.
//! - Paths are unclamped and unbiased; only pinhole cameras, no lens, no filter but the pixel's square.
//! - Direct light converges faster than with random numbers: the first steps of paths follow eight scrambled sequences in turn,
//!   and standard errors come from how far these differ. So a handful of paths knows little of its error.
//! - Interpolated normals change how much light is reflected, not where the surface is: light from below the triangle
//!   does not count, so a little energy is lost where they lean far.
//! - Each path asks every point, spot and directional light at each of its points; dozens of them are slow.
//! - Alpha is a mask: a surface is there or not. Coordinates are `f32`; a gap below a ten-thousandth of the distance
//!   to the origin may close.

mod camera;
mod film;
mod geometry;
mod lights;
mod path;
pub(crate) mod random;
mod render;
mod sequence;
#[cfg(test)]
mod tests;
mod texture;
mod world;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::scene::{Scene, SceneError};
use path::{Start, gather};
use random::Random;
use sequence::{REPLICATES, Sequences};
use world::{Surface, World};

pub use film::Film;
pub use render::{Layer, PixelFilter, Rendering, Settings};

/// A scene ready to be rendered.
pub struct Tracer<'a> {
    world: World<'a>,
}

/// Irradiance at a point in W/m2: mean and standard error of a number of paths.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Irradiance {
    /// Straight from lights, emissive surfaces and the sky.
    pub direct: Vec3,
    /// After exactly one reflection.
    pub first_bounce: Vec3,
    /// After one or more reflections.
    pub indirect: Vec3,
    /// Standard errors of `direct`, `first_bounce` and `indirect`.
    pub errors: [Vec3; 3],
}

impl<'a> Tracer<'a> {
    /// Builds the tree over a scene's triangles.
    ///
    /// # Errors
    /// When [`Scene::check`] finds something.
    pub fn new(scene: &'a Scene) -> Result<Self, SceneError> {
        Ok(Self { world: World::new(scene)? })
    }

    /// The irradiance of a small surface at `point` that faces the unit vector `normal`, from `samples` paths of at
    /// most `bounces` reflections (`None`: any number).
    pub fn irradiance(
        &self,
        point: Vec3,
        normal: Vec3,
        bounces: Option<u32>,
        samples: u32,
        seed: u64,
    ) -> Irradiance {
        let start = Surface {
            position: point,
            face: normal,
            normal,
            albedo: Vec3::ONE,
            emission: Vec3::ZERO,
            light_density: 0.0,
        };
        let start = Start::new(&self.world, start);
        let sequences = Sequences::new(seed, 0);
        let parts: Vec<Sums<3>> = (0..samples.div_ceil(256))
            .into_par_iter()
            .map(|part| {
                let mut sums = Sums::default();
                for n in 256 * part..samples.min(256 * (part + 1)) {
                    let first = sequences.first_steps(n);
                    let random = &mut Random::new(seed, n.into());
                    let path = gather(&self.world, &start, bounces, &first, random);
                    sums.add(n, [path.direct, path.first_bounce, path.indirect]);
                }
                sums
            })
            .collect();
        let mut sums = Sums::default();
        parts.iter().for_each(|part| sums.merge(part));
        let values = [0, 1, 2].map(|layer| sums.mean_and_error(layer));
        let [direct, first_bounce, indirect] = values.map(|(mean, _)| mean);
        Irradiance { direct, first_bounce, indirect, errors: values.map(|(_, error)| error) }
    }
}

/// Sums of `N` values over paths, apart for each sequence.
#[derive(Clone, Debug)]
struct Sums<const N: usize> {
    values: [[DVec3; N]; REPLICATES as usize],
    counts: [u32; REPLICATES as usize],
}

impl<const N: usize> Default for Sums<N> {
    fn default() -> Self {
        Self { values: [[DVec3::ZERO; N]; REPLICATES as usize], counts: [0; REPLICATES as usize] }
    }
}

impl<const N: usize> Sums<N> {
    /// Adds the values of path number `n`.
    fn add(&mut self, n: u32, values: [Vec3; N]) {
        let replicate = (n % REPLICATES) as usize;
        self.counts[replicate] += 1;
        self.values[replicate].iter_mut().zip(values).for_each(|(sum, value)| *sum += value.as_dvec3());
    }

    fn merge(&mut self, other: &Self) {
        let all = self.values.iter_mut().flatten().zip(other.values.iter().flatten());
        all.for_each(|(sum, more)| *sum += *more);
        self.counts.iter_mut().zip(other.counts).for_each(|(sum, more)| *sum += more);
    }

    /// How many paths were added.
    fn count(&self) -> u32 {
        self.counts.iter().sum()
    }

    /// Mean of one value and its standard error, both per path added.
    fn mean_and_error(&self, value: usize) -> (Vec3, Vec3) {
        self.mean_and_error_over(value, &self.counts)
    }

    /// Sum of one value over that of `weights`, one for each sequence, and its standard error: infinite from one sequence.
    /// Each sequence strays by what its sum is more or less than its weight makes of the mean.
    fn mean_and_error_over(&self, value: usize, weights: &[u32]) -> (Vec3, Vec3) {
        let weights = || weights.iter().map(|&w| f64::from(w));
        let total: f64 = weights().sum();
        let sums = || self.values.iter().map(|values| values[value]);
        let mean = sums().sum::<DVec3>() / total.max(1.0);
        let squares: DVec3 = sums().zip(weights()).map(|(sum, w)| (sum - w * mean).powf(2.0)).sum();
        // 1 - 1/n for n equal weights: what the mean has taken of the scatter around it.
        let left = 1.0 - weights().map(|w| w * w).sum::<f64>() / (total * total).max(1.0);
        let error = if left > 0.0 { (squares / left).map(f64::sqrt) / total } else { DVec3::INFINITY };
        (mean.as_vec3(), error.as_vec3())
    }
}
