//! The lights as the volume sees them: reflective shadow maps that all lights share.
//!
//! However many lights there are, there is one set of maps for whole views and six of half their size for cubes and for the
//! samples of area lights. A light's views are drawn, injected and drawn over by the next.

use glam::{UVec2, Vec3};
use lumivox::core::{Bounds, View};
use lumivox::gpu::{Gpu, GpuError, Uniform};
use lumivox::progressive::{InjectionScale, ViewTextures};

use super::{GiMethod, Settings};
use crate::lights::{self, LIGHT_SKY, LightSample, LightUniform, ViewShape};
use crate::surface::{self, HDR_FORMAT, SurfaceView};

/// Samples of an area light that bring attributes and clean up, of those from above; the others bring light alone.
pub(super) const FULL_SAMPLES: usize = 8;

/// All lights of the volume.
#[derive(Debug)]
pub(super) struct InjectedLights {
    pub(super) sources: Vec<InjectedLight>,
}

/// A light or sample.
#[derive(Debug)]
pub(super) struct InjectedLight {
    pub(super) uniform: Uniform<LightUniform>,
    pub(super) views: Vec<SurfaceView>,
    /// Whether it brings attributes and cleans up, or light alone.
    pub(super) is_full: bool,
    sample: LightSample,
}

/// Whether a light's views use the half-size maps: there are several of them, or many samples.
fn is_half(sample: &LightSample) -> bool {
    sample.is_area || sample.shape.count() > 1
}

fn is_sky(sample: &LightSample) -> bool {
    sample.uniform.kind == LIGHT_SKY
}

impl InjectedLight {
    /// Whether it is a sample of the sky.
    pub(super) fn is_sky(&self) -> bool {
        is_sky(&self.sample)
    }
}

impl InjectedLights {
    /// Uniforms and maps for these samples.
    pub(super) fn new(gpu: &Gpu, samples: &[LightSample], settings: &Settings) -> Result<Self, GpuError> {
        Ok(Self { sources: sources(gpu, samples, settings)? })
    }

    /// Moves and changes the samples: as many and of the same kinds as before.
    pub(super) fn set(&mut self, gpu: &Gpu, samples: &[LightSample]) {
        for (source, sample) in self.sources.iter_mut().zip(samples) {
            source.uniform.write(gpu, &sample.uniform);
            source.sample = *sample;
        }
    }

    /// Writes where all views stand. Once per frame, before recording.
    ///
    /// Sums of light begin anew with each light, so each has steps as fine as its own brightness allows: else one bright
    /// lamp would round a sample of the sky to nothing.
    pub(super) fn update(&mut self, gpu: &Gpu, bounds: &Bounds, scale: InjectionScale) {
        for source in &mut self.sources {
            let bound = lights::radiance_bound([&source.sample.uniform], bounds);
            let points: u32 = source.views.iter().map(|v| v.input.point_count()).sum();
            let share = (bound / scale.radiance_max).min(1.0);
            let light_points = ((points as f32 * share).ceil() as u32).max(1);
            let scale = InjectionScale { light_points, ..scale };
            let texels = source.views.first().map_or(1, |v| v.input.textures.depth.size()[0]);
            let views = lights::light_views(&source.sample, bounds, &[], texels);
            for (target, view) in source.views.iter_mut().zip(views) {
                target.view = view;
                target.update(gpu, scale);
            }
        }
    }

    /// The range of the frame's sums, with the camera's points and the brightest emission.
    pub(super) fn scale(&self, bounds: &Bounds, camera: &SurfaceView, emission: f32) -> InjectionScale {
        let points = |s: &InjectedLight| s.views.iter().map(|v| v.input.point_count()).sum::<u32>();
        let of_camera = camera.input.point_count();
        let full = self.sources.iter().filter(|s| s.is_full);
        let reflected = lights::radiance_bound(self.sources.iter().map(|s| &s.sample.uniform), bounds);
        InjectionScale {
            attribute_points: full.map(points).sum::<u32>() + of_camera,
            light_points: self.sources.iter().map(points).fold(of_camera, u32::max),
            radiance_max: reflected.max(emission).max(1e-3),
        }
    }
}

fn sources(gpu: &Gpu, samples: &[LightSample], settings: &Settings) -> Result<Vec<InjectedLight>, GpuError> {
    let nowhere = View::perspective(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0, 1.0, 0.1, 1.0);
    let half_size = (settings.rsm_size / 2).max(1);
    let mut whole: Option<ViewTextures> = None;
    let mut halves: Vec<ViewTextures> = Vec::new();
    let usual = (settings.area_maps as usize).div_ceil(FULL_SAMPLES).max(1);
    let mut sources = Vec::with_capacity(samples.len());
    for (n, sample) in samples.iter().enumerate() {
        let mut views = Vec::new();
        for k in 0..sample.shape.count() {
            let (textures, points) = if is_half(sample) {
                if halves.len() <= k {
                    halves.push(surface::targets(gpu, "rsm half", UVec2::splat(half_size), HDR_FORMAT)?);
                }
                (halves[k].clone(), settings.points / 2)
            } else {
                let made = match whole.take() {
                    Some(textures) => textures,
                    None => surface::targets(gpu, "rsm", UVec2::splat(settings.rsm_size), HDR_FORMAT)?,
                };
                (whole.insert(made).clone(), settings.points)
            };
            views.push(SurfaceView::new(gpu, "rsm", textures, UVec2::splat(points.max(1)), nowhere));
        }
        // What comes from below would show the undersides of floors, which lie in other cells than their tops.
        let from_above = sample.shape != ViewShape::Parallel || sample.uniform.direction.y < 0.0;
        // Where light is gathered the sky has no others.
        let every = if settings.gi == GiMethod::Gather && is_sky(sample) { 1 } else { usual };
        let is_full = !sample.is_area || (n % every == 0 && from_above);
        let uniform = Uniform::new(gpu, "render/light", &sample.uniform);
        sources.push(InjectedLight { uniform, views, is_full, sample: *sample });
    }
    Ok(sources)
}
