//! Light that surfels send out by themselves, direct and emitted: taken up in each frame by all, whoever's turn it is.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::{ALBEDO, EMISSION, VolumeBuffer};
use crate::wgsl::{GRID, OCTAHEDRON, PACK};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/own light",
    parts: &[GRID, PACK, OCTAHEDRON, SURFEL, TURN, include_str!("own_light.wgsl")],
};

#[derive(Debug)]
pub(super) struct OwnLight(ComputePass);

impl OwnLight {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, settings): (&VolumeBuffer, &Uniform<GatherUniform>),
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("settings", settings)
            .read("albedo", volume.require(SHADER.name, ALBEDO)?)
            .read("emission", volume.require(SHADER.name, EMISSION)?)
            .read("surfels", &store.surfels)
            .read("light", &store.light)
            .read("sky_light", &store.sky_light)
            .write("shine", &mut store.shine)
            .write("next_shine", &mut store.next_shine);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_SURFELS)
    }
}
