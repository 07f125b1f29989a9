//! Pictures: layers apart, each with its standard error.

use super::Tracer;
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
        if settings.samples == 0 {
            return Err(SceneError::EmptyPicture);
        }
        let mut film = self.film(camera, settings)?;
        film.expose(settings.samples, progress);
        Ok(film.rendering())
    }
}
