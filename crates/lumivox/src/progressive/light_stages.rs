//! What brings light into cells by a [`LightRule`]: injection, resolution, and the end of a frame.

use crate::gpu::{Buffer, Gpu, GpuError, Uniform};
use crate::volume::{VolumeBuffer, check_grid};
use crate::wgsl::ViewUniform;

use super::light_injection::{LightInjection, Summed};
use super::light_resolve::{LightResolve, Replace};
use super::light_store::LightStore;
use super::{DirectLight, LIGHT_SUM_WORDS, LightRule, LightView};

/// Whose samples are injected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sampler {
    /// One light: what it brings is added.
    Light,
    /// The camera: its mean replaces what lights have brought.
    Camera,
}

/// One kind of samples, from injection to light.
#[derive(Debug)]
struct Way {
    inject: LightInjection,
    resolve: LightResolve,
}

/// The stages, and what they work in.
#[derive(Debug)]
pub(super) struct LightStages {
    lights: Way,
    camera: Way,
    sums: Buffer,
    /// None where light is of one frame.
    store: Option<LightStore>,
}

impl LightStages {
    pub(super) fn new(gpu: &Gpu, volume: &VolumeBuffer, rule: LightRule) -> Result<Self, GpuError> {
        check_grid(gpu, "the sums of injected light", volume.grid(), LIGHT_SUM_WORDS * 4)?;
        let bytes = volume.grid().cell_count() * LIGHT_SUM_WORDS * 4;
        let way = |replace, summed| Way {
            inject: LightInjection::new(gpu, summed),
            resolve: LightResolve::new(gpu, rule, replace, summed),
        };
        let of_lights = if rule.adds_up() { Summed::ByArea } else { Summed::Mean };
        let store = (rule == LightRule::Stored).then(|| LightStore::new(gpu, volume));
        Ok(Self {
            lights: way(Replace::No, of_lights),
            camera: way(Replace::Yes, Summed::Mean),
            sums: Buffer::storage(gpu, "injection/light sums", bytes)?,
            store: store.transpose()?,
        })
    }

    /// Begins a frame: no samples yet, and by the rule `pulled` no light.
    pub(super) fn record_begin(&mut self, encoder: &mut wgpu::CommandEncoder, light: &mut DirectLight) {
        let cleared = self.store.as_ref().map_or(&light.sh, |store| &store.reached);
        encoder.clear_buffer(&cleared.raw, 0, None);
    }

    /// Begins one light, or the camera.
    pub(super) fn record_clear(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.sums.raw, 0, None);
    }

    /// Adds the points of a view to the sums.
    pub(super) fn record_points(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        from: Sampler,
        view: LightView<'_>,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Self { lights, camera, sums, .. } = self;
        let way = if from == Sampler::Light { lights } else { camera };
        way.inject.record(gpu, encoder, view, volume, sums)
    }

    /// Sums to light.
    pub(super) fn record_resolve(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        from: Sampler,
        (view, volume): (&Uniform<ViewUniform>, &VolumeBuffer),
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let Self { lights, camera, sums, store } = self;
        let way = if from == Sampler::Light { lights } else { camera };
        let reached = store.as_mut().map(|store| &mut store.reached);
        way.resolve.record(gpu, encoder, (view, volume), sums, (light, reached))
    }

    /// Ends a frame, before attributes are resolved.
    pub(super) fn record_end(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        self.store.as_ref().map_or(Ok(()), |store| store.record(gpu, encoder, volume, light))
    }
}
