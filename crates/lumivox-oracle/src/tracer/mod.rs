//! A plain path tracer for Lambertian scenes.
//!
//! Radiance that leaves a surface is `L = emission + albedo / pi * E`, on both sides, with the irradiance `E` of
//! everything it sees. [`Tracer::render`] estimates `E` in each pixel by random paths and keeps apart what came straight
//! from a light (*direct*), after one reflection (*first bounce*) and after any number (*indirect*), as irradiance and as
//! the radiance that it adds to the picture, each with its standard error.
//!
//! - The same seed gives the same bits, whatever the number of threads.
//! - Paths are independent, unclamped and unbiased; only pinhole cameras, no lens, no filter but the pixel's square.
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
#[cfg(test)]
mod tests;
mod texture;
mod world;

use glam::Vec3;
use rayon::prelude::*;

use crate::scene::{Scene, SceneError};
use path::{Gathered, gather};
use random::Random;
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
        let parts: Vec<[Sum; 3]> = (0..samples.div_ceil(256))
            .into_par_iter()
            .map(|part| {
                let mut sums = [Sum::default(); 3];
                for sample in 256 * part..samples.min(256 * (part + 1)) {
                    let path = gather(&self.world, start, bounces, &mut Random::new(seed, sample.into()));
                    add(&mut sums, &path);
                }
                sums
            })
            .collect();
        let mut sums = [Sum::default(); 3];
        for part in &parts {
            sums.iter_mut().zip(part).for_each(|(sum, part)| sum.merge(part));
        }
        let [direct, first_bounce, indirect] = sums.map(|sum| sum.mean(samples));
        Irradiance { direct, first_bounce, indirect, errors: sums.map(|sum| sum.error(samples)) }
    }
}

fn add(sums: &mut [Sum; 3], path: &Gathered) {
    for (sum, value) in sums.iter_mut().zip([path.direct, path.first_bounce, path.indirect]) {
        sum.add(value);
    }
}

/// Sum and sum of squares of samples.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    values: glam::DVec3,
    squares: glam::DVec3,
}

impl Sum {
    fn add(&mut self, value: Vec3) {
        let value = value.as_dvec3();
        self.values += value;
        self.squares += value * value;
    }

    fn merge(&mut self, other: &Self) {
        self.values += other.values;
        self.squares += other.squares;
    }

    fn mean(&self, samples: u32) -> Vec3 {
        (self.values / f64::from(samples.max(1))).as_vec3()
    }

    /// Standard error of the mean: infinite from a single sample.
    fn error(&self, samples: u32) -> Vec3 {
        if samples < 2 {
            return Vec3::INFINITY;
        }
        let n = f64::from(samples);
        let variance = (self.squares - self.values * self.values / n).max(glam::DVec3::ZERO) / (n - 1.0);
        (variance / n).map(f64::sqrt).as_vec3()
    }
}
