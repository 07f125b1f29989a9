//! Rays from surfels through the sub-cells.
//!
//! A ray goes from box to box: a whole block of 16 sub-cells a side where that is empty, a cell of four, a sub-cell. Directions are
//! as dense as the cosine about the surfel's normal, on a spiral that is turned differently for each surfel, and start at all of its
//! sub-cells in turn.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, OCTAHEDRON};

use super::{GatherUniform, MARCH, MET, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/trace",
    parts: &[GRID, FACE, OCTAHEDRON, SURFEL, MARCH, MET, TURN, include_str!("trace.wgsl")],
};

#[derive(Debug)]
pub(super) struct Trace(ComputePass);

impl Trace {
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
            .write("hits", &mut store.hits);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_RAYS)
    }
}
