//! The ways of light through the volume, and what each takes of a frame.

use glam::Vec3;
use lumivox::VolumeBuffer;
use lumivox::gather::{GatherSettings, GatheredLight};
use lumivox::gpu::{Gpu, GpuError, Texture};
use lumivox::irradiance::{IrradianceSource, IrradianceVolume};
use lumivox::light::{IndirectLight, LightSettings};
use lumivox::lpv::LightPropagationVolume;
use lumivox::progressive::{DirectLight, ViewInput};
use lumivox::wgpu::CommandEncoder;

use super::injected_lights::InjectedLight;
use super::{GiMethod, Settings};
use crate::composite::Layer;
use crate::lights::Sky;

/// Rays of a pixel that mirrors.
const GLOSSY_RAYS: u32 = 32;
/// Rays of a point whose light is shown.
const LOBE_RAYS: u32 = 128;

/// How much of the light is new in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// That of the surfels whose turn it is.
    Turns,
    /// All in every `every`-th frame; this is the `n`-th.
    Nth { n: u32, every: u32 },
}

impl Pace {
    /// All, shown at once.
    pub(super) const WHOLE: Self = Self::Nth { n: 0, every: 1 };

    /// Whether anything is new.
    pub(super) fn updates(self) -> bool {
        match self {
            Self::Turns => true,
            Self::Nth { n, .. } => n == 0,
        }
    }
}

/// Light of the volume.
#[derive(Debug)]
pub(super) enum Indirect {
    /// From cell to cell through everything.
    Lpv(Box<LightPropagationVolume>),
    /// From cell to cell.
    Propagated(Box<IndirectLight>),
    /// Along rays.
    Gathered(Box<GatheredLight>),
}

impl Indirect {
    pub(super) fn new(
        gpu: &Gpu,
        volume: &VolumeBuffer,
        settings: &Settings,
        sky: &Sky,
    ) -> Result<Self, GpuError> {
        // Whether samples of the sky light the picture; else it comes with the rest of the light.
        let sampled = settings.area_samples > 0;
        if settings.gi == GiMethod::Gather {
            let gather = GatherSettings { sky_apart: sampled, ..settings.gather };
            let light = GatheredLight::new(gpu, volume, gather)?;
            light.set_sky(gpu, |direction| sky.radiance(direction));
            return Ok(Self::Gathered(Box::new(light)));
        }
        if settings.gi == GiMethod::Lpv {
            let lpv = LightPropagationVolume::new(gpu, volume, settings.lpv_blocking)?;
            return Ok(Self::Lpv(Box::new(lpv)));
        }
        let mut propagated = IndirectLight::with_reflection(gpu, volume, settings.reflection)?;
        if settings.layer == Layer::Lobes {
            propagated = propagated.with_free_space(gpu);
        }
        let of_sky = if sampled { Vec3::ZERO } else { sky.mean() };
        propagated.update(gpu, &LightSettings { sky: of_sky, ..settings.light });
        Ok(Self::Propagated(Box::new(propagated)))
    }

    /// Gathered light, if that is the way.
    pub(super) fn gathered_mut(&mut self) -> Option<&mut GatheredLight> {
        match self {
            Self::Lpv(_) | Self::Propagated(_) => None,
            Self::Gathered(light) => Some(light),
        }
    }

    /// The stage that steps start from, and theirs.
    pub(super) fn stages(&self) -> [&'static str; 2] {
        match self {
            Self::Lpv(_) => ["lpv/seed", "lpv/propagation"],
            Self::Propagated(_) => ["light/seed", "light/propagation"],
            Self::Gathered(_) => ["gather/trace", "gather/bounce"],
        }
    }

    /// Once per frame, before recording.
    pub(super) fn update(&mut self, gpu: &Gpu, pace: Pace) {
        let Self::Gathered(light) = self else { return };
        match pace {
            Pace::Turns => light.begin_frame(gpu),
            Pace::Nth { n, every } => light.begin_nth_frame(gpu, n, every),
        }
    }

    /// How many frames a round of turns takes, from the next frame on.
    pub(super) fn set_frames(&mut self, frames: f32) {
        if let Self::Gathered(light) = self {
            light.set_frames(frames);
        }
    }

    /// No direct light yet.
    pub(super) fn record_dark(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder) -> Result<(), GpuError> {
        match self {
            Self::Lpv(light) => light.record_begin(encoder),
            Self::Gathered(light) => light.record_dark(gpu, encoder)?,
            Self::Propagated(_) => {}
        }
        Ok(())
    }

    /// In a frame without new light, what pixels see goes on towards the last.
    pub(super) fn record_fade(&mut self, gpu: &Gpu, encoder: &mut CommandEncoder) -> Result<(), GpuError> {
        let Self::Gathered(light) = self else { return Ok(()) };
        light.record_fade(gpu, encoder)
    }

    /// Surfels of the volume as it is now.
    pub(super) fn record_surfels(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Self::Gathered(light) = self else { return Ok(()) };
        light.record_surfels(gpu, encoder, volume)
    }

    /// Sub-cells that a view proves empty, or all if none are kept.
    pub(super) fn record_cleanup(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
        keeps: bool,
    ) -> Result<(), GpuError> {
        match self {
            Self::Lpv(_) | Self::Propagated(_) => Ok(()),
            Self::Gathered(light) if keeps => light.record_cleanup(gpu, encoder, view, volume),
            Self::Gathered(light) => {
                light.record_clear_subcells(encoder);
                Ok(())
            }
        }
    }

    /// The stage that takes light from lights' views, of the ways that ask these by themselves.
    pub(super) fn light_stage(&self) -> Option<&'static str> {
        match self {
            Self::Lpv(_) => Some("lpv/injection"),
            Self::Propagated(_) => None,
            Self::Gathered(_) => Some("gather/direct"),
        }
    }

    /// Light that a light's views show.
    pub(super) fn record_light(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        source: &InjectedLight,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let mut views = source.views.iter().map(|v| &v.input);
        match self {
            Self::Lpv(light) => views.try_for_each(|view| {
                if source.is_full {
                    light.record_geometry(gpu, encoder, view, volume)?;
                }
                light.record_light(gpu, encoder, view, volume)
            }),
            Self::Propagated(_) => Ok(()),
            // Its light comes by rays.
            Self::Gathered(_) if source.is_sky() => Ok(()),
            Self::Gathered(light) => {
                views.try_for_each(|view| light.record_light(gpu, encoder, view, volume))
            }
        }
    }

    /// Surfaces that a light's views show, after those that they prove gone.
    pub(super) fn record_surfaces(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        source: &InjectedLight,
        volume: &VolumeBuffer,
        keeps: bool,
    ) -> Result<(), GpuError> {
        let Self::Gathered(light) = self else { return Ok(()) };
        if !source.is_full {
            return Ok(());
        }
        source.views.iter().try_for_each(|v| {
            if keeps {
                light.record_cleanup(gpu, encoder, &v.input, volume)?;
            }
            light.record_injection(gpu, encoder, &v.input, volume)
        })
    }

    /// Surfaces that a view shows.
    pub(super) fn record_injection(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Self::Gathered(light) = self else { return Ok(()) };
        light.record_injection(gpu, encoder, view, volume)
    }

    /// What steps start from: virtual point lights and what `camera` shows in their way, flux, or what rays meet.
    pub(super) fn record_seed(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (volume, direct): (&VolumeBuffer, &DirectLight),
        camera: &ViewInput,
    ) -> Result<(), GpuError> {
        match self {
            Self::Lpv(light) => {
                light.record_geometry(gpu, encoder, camera, volume)?;
                light.record_seed(gpu, encoder, camera, volume)
            }
            Self::Propagated(light) => {
                light.record_transport(gpu, encoder, volume)?;
                light.record_seed(gpu, encoder, volume, direct)
            }
            Self::Gathered(light) => light.record_trace(gpu, encoder, volume),
        }
    }

    /// Steps of propagated light that goes on from the frame before.
    pub(super) fn record_flow(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        (volume, direct): (&VolumeBuffer, &DirectLight),
        steps: u32,
    ) -> Result<(), GpuError> {
        let Self::Propagated(light) = self else { return Ok(()) };
        light.record_transport(gpu, encoder, volume)?;
        light.record_flow(gpu, encoder, volume, direct, steps)
    }

    /// Steps from cell to cell, or bounces.
    pub(super) fn record_steps(
        &mut self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
        steps: u32,
    ) -> Result<(), GpuError> {
        match self {
            Self::Lpv(light) => light.record_propagation(gpu, encoder, volume, steps),
            Self::Propagated(light) => light.record_propagation(gpu, encoder, volume, steps),
            Self::Gathered(light) => light.record_bounces(gpu, encoder, volume, steps),
        }
    }

    /// Light in free space; none of propagation that was not made for [`Layer::Lobes`].
    pub(super) fn record_irradiance_volume(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
        target: &mut IrradianceVolume,
    ) -> Result<(), GpuError> {
        let light: &dyn IrradianceSource = match self {
            Self::Lpv(light) => &**light,
            Self::Propagated(light) if light.keeps_free_space() => &**light,
            Self::Propagated(_) => return Ok(()),
            Self::Gathered(light) => &**light,
        };
        light.record_irradiance_volume(gpu, encoder, volume, target, (LOBE_RAYS, 0, 1))
    }

    /// Where gathered light may leak; black for the other ways, which do not look.
    pub(super) fn record_leaks(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let Self::Gathered(light) = self else { return Ok(()) };
        light.record_leaks(gpu, encoder, volume, view, target)
    }

    /// What rough mirrors show of gathered light; black for the other ways, which have no rays.
    pub(super) fn record_glossy(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
        roughness: f32,
    ) -> Result<(), GpuError> {
        let Self::Gathered(light) = self else { return Ok(()) };
        light.record_glossy(gpu, encoder, volume, view, target, (roughness, GLOSSY_RAYS))
    }

    /// Irradiance at the pixels of a view.
    pub(super) fn record_reconstruction(
        &self,
        gpu: &Gpu,
        encoder: &mut CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        match self {
            Self::Lpv(light) => light.record_reconstruction(gpu, encoder, volume, view, target),
            Self::Propagated(light) => light.record_reconstruction(gpu, encoder, volume, view, target),
            Self::Gathered(light) => light.record_reconstruction(gpu, encoder, volume, view, target),
        }
    }
}
