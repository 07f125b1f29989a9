//! Less grain in what pixels see: surfels beside each other share what their rays found.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, OCTAHEDRON, PACK};

use super::{BESIDE, GatherUniform, MARCH, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/smooth",
    parts: &[GRID, FACE, PACK, OCTAHEDRON, SURFEL, MARCH, BESIDE, TURN, include_str!("smooth.wgsl")],
};

#[derive(Debug)]
pub(super) struct Smooth(ComputePass);

impl Smooth {
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
            .read("grid", volume.grid_uniform())
            .read("settings", settings)
            .read("mask", &store.mask)
            .read("blocks", &store.blocks)
            .read("table", &store.table)
            .read("surfels", &store.surfels)
            .read("due", &store.due)
            .read("sky_light", &store.sky_light)
            .read("shine", &store.shine)
            .write("smoothed", &mut store.smoothed);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_DUE)
    }
}
