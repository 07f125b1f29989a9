//! Pictures: paths for each pixel, pixels in parallel, layers apart.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::camera::Pinhole;
use super::path::{Gathered, gather};
use super::random::Random;
use super::world::World;
use super::{Sum, Tracer};
use crate::picture::Picture;
use crate::scene::{Camera, SceneError};

/// Where in a pixel its camera rays run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelFilter {
    /// Anywhere in the pixel's square, all with the same weight: an anti-aliased picture.
    #[default]
    Box,
    /// Through its centre: what a rasterizer with one sample per pixel sees.
    Center,
}

/// How a picture is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Paths per pixel.
    pub samples: u32,
    /// Most reflections of indirect light; `None`: any number.
    pub bounces: Option<u32>,
    /// Same seed, same picture.
    pub seed: u64,
    /// Where in a pixel its rays run.
    pub filter: PixelFilter,
}

impl Default for Settings {
    fn default() -> Self {
        Self { width: 256, height: 256, samples: 64, bounces: None, seed: 0, filter: PixelFilter::Box }
    }
}

/// Light of one kind on its way to the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Radiance that it adds to the picture, W/(m2 sr).
    pub radiance: Picture,
    /// Irradiance of the surfaces seen, W/m2: no albedo in it. Mean over those rays of a pixel that meet a surface.
    pub irradiance: Picture,
    /// Standard error of each channel of `radiance`; infinite from a single sample.
    pub radiance_error: Picture,
    /// Standard error of each channel of `irradiance`.
    pub irradiance_error: Picture,
}

/// What [`Tracer::render`] makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// Light straight from an emitter or the sky onto the surfaces seen.
    pub direct: Layer,
    /// Light after exactly one reflection.
    pub first_bounce: Layer,
    /// Light after one up to [`Settings::bounces`] reflections; contains the first bounce.
    pub indirect: Layer,
    /// What the surfaces seen emit themselves, and the sky where none is seen, W/(m2 sr).
    pub emitted: Picture,
    /// Reflectance of the surfaces seen, mean over those rays of a pixel that meet one.
    pub albedo: Picture,
    /// Share of a pixel's rays that meet a surface, 0..=1, row by row. Rectangular lights are not seen.
    pub coverage: Vec<f32>,
}

impl Rendering {
    /// The whole picture: emitted, direct and indirect radiance.
    pub fn total(&self) -> Picture {
        self.emitted.plus(&self.direct.radiance).plus(&self.indirect.radiance)
    }

    /// The pixels that show surfaces and nothing else: not background, not partly background.
    pub fn foreground(&self) -> Vec<bool> {
        self.coverage.iter().map(|&c| c >= 1.0).collect()
    }
}

impl Tracer<'_> {
    /// Takes a picture on all threads of the current rayon pool. `progress` hears the finished share, 0..=1, after each
    /// row, from any thread.
    ///
    /// # Errors
    /// When the camera looks nowhere or there are no pixels or samples.
    pub fn render(
        &self,
        camera: &Camera,
        settings: &Settings,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Rendering, SceneError> {
        let Settings { width, height, samples, .. } = *settings;
        if width == 0 || height == 0 || samples == 0 {
            return Err(SceneError::EmptyPicture);
        }
        let pinhole = Pinhole::new(camera, Vec2::new(width as f32, height as f32))?;
        let done = AtomicU32::new(0);
        let rows = (0..height).into_par_iter().map(|y| {
            let row: Vec<Pixel> =
                (0..width).map(|x| Pixel::trace(&self.world, &pinhole, settings, x, y)).collect();
            progress(f64::from(done.fetch_add(1, Ordering::Relaxed) + 1) / f64::from(height));
            row
        });
        let pixels: Vec<Pixel> = rows.collect::<Vec<_>>().into_iter().flatten().collect();
        let picture = |value: &dyn Fn(&Pixel) -> Vec3| Picture {
            width,
            height,
            pixels: pixels.iter().map(value).collect(),
        };
        let layer = |n: usize| Layer {
            radiance: picture(&|p| p.radiance[n].mean(samples)),
            irradiance: picture(&|p| p.irradiance[n].mean(p.hits)),
            radiance_error: picture(&|p| p.radiance[n].error(samples)),
            irradiance_error: picture(&|p| {
                if p.hits == 0 { Vec3::ZERO } else { p.irradiance[n].error(p.hits) }
            }),
        };
        Ok(Rendering {
            direct: layer(0),
            first_bounce: layer(1),
            indirect: layer(2),
            emitted: picture(&|p| p.emitted.mean(samples)),
            albedo: picture(&|p| p.albedo.mean(p.hits)),
            coverage: pixels.iter().map(|p| p.hits as f32 / samples as f32).collect(),
        })
    }
}

/// Sums over the paths of one pixel.
#[derive(Clone, Default)]
struct Pixel {
    radiance: [Sum; 3],
    irradiance: [Sum; 3],
    emitted: Sum,
    albedo: Sum,
    hits: u32,
}

impl Pixel {
    fn trace(world: &World<'_>, pinhole: &Pinhole, settings: &Settings, x: u32, y: u32) -> Self {
        let mut pixel = Self::default();
        let mut random = Random::new(settings.seed, u64::from(y) << 32 | u64::from(x));
        for _ in 0..settings.samples {
            let within = match settings.filter {
                PixelFilter::Box => random.square(),
                PixelFilter::Center => Vec2::splat(0.5),
            };
            let direction = pinhole.direction(Vec2::new(x as f32, y as f32) + within);
            let Some(surface) = world.trace(pinhole.eye, direction, false) else {
                pixel.emitted.add(world.sky);
                continue;
            };
            pixel.hits += 1;
            pixel.emitted.add(surface.emission);
            pixel.albedo.add(surface.albedo);
            let Gathered { direct, first_bounce, indirect } =
                gather(world, surface, settings.bounces, &mut random);
            let reflected = surface.albedo / std::f32::consts::PI;
            for (n, irradiance) in [direct, first_bounce, indirect].into_iter().enumerate() {
                pixel.irradiance[n].add(irradiance);
                pixel.radiance[n].add(reflected * irradiance);
            }
        }
        pixel
    }
}
