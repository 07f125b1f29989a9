//! Light that a new surfel begins with, from those around it: without it, what moves would boil, since each cell that it comes into
//! would begin with the grain of its own rays, and without direct light where views bring surfaces.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, OCTAHEDRON, PACK};

use super::{BESIDE, GatherUniform, MARCH, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/inherit",
    parts: &[GRID, FACE, PACK, OCTAHEDRON, SURFEL, MARCH, BESIDE, TURN, include_str!("inherit.wgsl")],
};

#[derive(Debug)]
pub(super) struct Inherit(ComputePass);

impl Inherit {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    /// After new surfels got their places, before those that are no more lose theirs.
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
            .read("hits", &store.hits)
            .write("light", &mut store.light)
            .write("shine", &mut store.shine)
            .write("shown", &mut store.shown);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_SURFELS)
    }
}
