//! Paths for each pixel, pixels in parallel, in as many rounds as it takes.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::camera::Pinhole;
use super::path::{Gathered, Start, gather};
use super::random::Random;
use super::sequence::{REPLICATES, Sequences};
use super::world::World;
use super::{Layer, PixelFilter, Rendering, Settings, Sums, Tracer};
use crate::picture::Picture;
use crate::scene::{Camera, SceneError};

/// A picture in the making, to which paths are added until its noise is low enough. Rounds go on with the random
/// numbers of the round before: two of 8 paths are, bit for bit, one of 16. About 1300 bytes per pixel.
pub struct Film<'a> {
    world: &'a World<'a>,
    pinhole: Pinhole,
    settings: Settings,
    pixels: Vec<Pixel>,
    samples: u32,
}

impl<'a> Tracer<'a> {
    /// A film without any light on it. [`Settings::samples`] plays no part.
    ///
    /// # Errors
    /// When the camera looks nowhere or there are no pixels.
    pub fn film(&'a self, camera: &Camera, settings: &Settings) -> Result<Film<'a>, SceneError> {
        let Settings { width, height, seed, .. } = *settings;
        if width == 0 || height == 0 {
            return Err(SceneError::EmptyPicture);
        }
        let pinhole = Pinhole::new(camera, Vec2::new(width as f32, height as f32))?;
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels = places.map(|(x, y)| Pixel::new(seed, x, y)).collect();
        Ok(Film { world: &self.world, pinhole, settings: *settings, pixels, samples: 0 })
    }
}

impl Film<'_> {
    /// Adds `samples` paths to every pixel, on all threads of the current rayon pool. `progress` hears the finished
    /// share, 0..=1, after each row, from any thread.
    pub fn expose(&mut self, samples: u32, progress: &(dyn Fn(f64) + Sync)) {
        let Self { world, pinhole, settings, pixels, .. } = self;
        let film = (*world, &*pinhole, &*settings);
        let numbers = self.samples..self.samples.saturating_add(samples);
        let done = AtomicU32::new(0);
        pixels.par_chunks_mut(settings.width as usize).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                pixel.trace(film, Vec2::new(x as f32, y as f32), numbers.clone());
            }
            progress(f64::from(done.fetch_add(1, Ordering::Relaxed) + 1) / f64::from(settings.height));
        });
        self.samples = numbers.end;
    }

    /// Paths per pixel so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The picture so far: black, with infinite errors, before the first path.
    pub fn rendering(&self) -> Rendering {
        let Settings { width, height, .. } = self.settings;
        let samples = self.samples;
        let picture = |value: &dyn Fn(&Pixel) -> Vec3| Picture {
            width,
            height,
            pixels: self.pixels.iter().map(value).collect(),
        };
        let layer = |n: usize| {
            let radiance = |p: &Pixel| p.light.mean_and_error_over(n, &p.paths);
            let irradiance = |p: &Pixel| p.light.mean_and_error(3 + n);
            Layer {
                radiance: picture(&|p| radiance(p).0),
                irradiance: picture(&|p| irradiance(p).0),
                radiance_error: picture(&|p| radiance(p).1),
                // Where nothing is seen there is nothing to be wrong about.
                irradiance_error: picture(&|p| if p.hits() == 0 { Vec3::ZERO } else { irradiance(p).1 }),
            }
        };
        let mean = |sum: DVec3, count: u32| (sum / f64::from(count.max(1))).as_vec3();
        Rendering {
            direct: layer(0),
            first_bounce: layer(1),
            indirect: layer(2),
            emitted: picture(&|p| mean(p.emitted, samples)),
            albedo: picture(&|p| mean(p.albedo, p.hits())),
            coverage: self.pixels.iter().map(|p| p.hits() as f32 / samples.max(1) as f32).collect(),
        }
    }
}

/// Sums over the paths of one pixel.
struct Pixel {
    random: Random,
    sequences: Sequences,
    /// Paths so far, of each sequence.
    paths: [u32; REPLICATES as usize],
    /// Radiance of the three layers, then irradiance, of paths that met a surface.
    light: Sums<6>,
    emitted: DVec3,
    albedo: DVec3,
}

impl Pixel {
    fn new(seed: u64, x: u32, y: u32) -> Self {
        let stream = u64::from(y) << 32 | u64::from(x);
        Self {
            random: Random::new(seed, stream),
            sequences: Sequences::new(seed, stream),
            paths: Default::default(),
            light: Sums::default(),
            emitted: DVec3::ZERO,
            albedo: DVec3::ZERO,
        }
    }

    /// Paths that met a surface.
    fn hits(&self) -> u32 {
        self.light.count()
    }

    /// Adds paths `numbers` of the pixel whose upper left corner is `corner`.
    fn trace(&mut self, film: (&World<'_>, &Pinhole, &Settings), corner: Vec2, numbers: Range<u32>) {
        let (world, pinhole, settings) = film;
        let start = |within: Vec2| {
            let seen = world.trace(pinhole.eye, pinhole.direction(corner + within), false);
            seen.map(|surface| Start::new(world, surface))
        };
        // All paths through the centre begin alike.
        let center = match settings.filter {
            PixelFilter::Center => Some(start(Vec2::splat(0.5))),
            PixelFilter::Box => None,
        };
        for n in numbers {
            let first = self.sequences.first_steps(n);
            self.paths[(n % REPLICATES) as usize] += 1;
            let Some(start) = center.unwrap_or_else(|| start(first.pixel)) else {
                let within = if center.is_some() { Vec2::splat(0.5) } else { first.pixel };
                self.emitted += world.sky(pinhole.direction(corner + within)).as_dvec3();
                continue;
            };
            let albedo = start.surface.albedo;
            self.emitted += start.surface.emission.as_dvec3();
            self.albedo += albedo.as_dvec3();
            let Gathered { direct, first_bounce, indirect } =
                gather(world, &start, settings.bounces, &first, &mut self.random);
            let reflected = albedo / std::f32::consts::PI;
            let irradiances = [direct, first_bounce, indirect];
            let [a, b, c] = irradiances.map(|irradiance| reflected * irradiance);
            self.light.add(n, [a, b, c, direct, first_bounce, indirect]);
        }
    }
}
