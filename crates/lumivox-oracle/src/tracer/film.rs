//! Paths for each pixel, pixels in parallel, in as many rounds as it takes.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::camera::Pinhole;
use super::path::{Gathered, gather};
use super::random::Random;
use super::world::World;
use super::{Layer, PixelFilter, Rendering, Settings, Sum, Tracer};
use crate::picture::Picture;
use crate::scene::{Camera, SceneError};

/// A picture in the making, to which paths are added until its noise is low enough. Rounds go on with the random
/// numbers of the round before: two of 8 paths are, bit for bit, one of 16. About 400 bytes per pixel.
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
        let done = AtomicU32::new(0);
        pixels.par_chunks_mut(settings.width as usize).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                pixel.trace(world, pinhole, settings, Vec2::new(x as f32, y as f32), samples);
            }
            progress(f64::from(done.fetch_add(1, Ordering::Relaxed) + 1) / f64::from(settings.height));
        });
        self.samples += samples;
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
        let layer = |n: usize| Layer {
            radiance: picture(&|p| p.radiance[n].mean(samples)),
            irradiance: picture(&|p| p.irradiance[n].mean(p.hits)),
            radiance_error: picture(&|p| p.radiance[n].error(samples)),
            irradiance_error: picture(&|p| {
                if p.hits == 0 { Vec3::ZERO } else { p.irradiance[n].error(p.hits) }
            }),
        };
        Rendering {
            direct: layer(0),
            first_bounce: layer(1),
            indirect: layer(2),
            emitted: picture(&|p| p.emitted.mean(samples)),
            albedo: picture(&|p| p.albedo.mean(p.hits)),
            coverage: self.pixels.iter().map(|p| p.hits as f32 / samples.max(1) as f32).collect(),
        }
    }
}

/// Sums over the paths of one pixel.
struct Pixel {
    random: Random,
    radiance: [Sum; 3],
    irradiance: [Sum; 3],
    emitted: Sum,
    albedo: Sum,
    hits: u32,
}

impl Pixel {
    fn new(seed: u64, x: u32, y: u32) -> Self {
        let sums = [Sum::default(); 3];
        let (radiance, irradiance) = (sums, sums);
        let [emitted, albedo, _] = sums;
        let random = Random::new(seed, u64::from(y) << 32 | u64::from(x));
        Self { random, radiance, irradiance, emitted, albedo, hits: 0 }
    }

    fn trace(
        &mut self,
        world: &World<'_>,
        pinhole: &Pinhole,
        settings: &Settings,
        corner: Vec2,
        samples: u32,
    ) {
        for _ in 0..samples {
            let within = match settings.filter {
                PixelFilter::Box => self.random.square(),
                PixelFilter::Center => Vec2::splat(0.5),
            };
            let direction = pinhole.direction(corner + within);
            let Some(surface) = world.trace(pinhole.eye, direction, false) else {
                self.emitted.add(world.sky);
                continue;
            };
            self.hits += 1;
            self.emitted.add(surface.emission);
            self.albedo.add(surface.albedo);
            let Gathered { direct, first_bounce, indirect } =
                gather(world, surface, settings.bounces, &mut self.random);
            let reflected = surface.albedo / std::f32::consts::PI;
            for (n, irradiance) in [direct, first_bounce, indirect].into_iter().enumerate() {
                self.irradiance[n].add(irradiance);
                self.radiance[n].add(reflected * irradiance);
            }
        }
    }
}
