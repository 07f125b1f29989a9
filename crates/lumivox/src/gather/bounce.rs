//! A bounce: what the rays of a surfel that is due met shines on it, and its albedo's part of that leaves again. The others keep what
//! they have, which is the same in both states.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::{ALBEDO, EMISSION, VolumeBuffer};
use crate::wgsl::{GRID, OCTAHEDRON, PACK};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/bounce",
    parts: &[GRID, PACK, OCTAHEDRON, SURFEL, TURN, include_str!("bounce.wgsl")],
};

#[derive(Debug)]
pub(super) struct Bounce(ComputePass);

impl Bounce {
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
            .read("due", &store.due)
            .read("light", &store.light)
            .read("hits", &store.hits)
            .read("sky_light", &store.sky_light)
            .read("before", &store.shine)
            .write("after", &mut store.next_shine);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_DUE)
    }
}
