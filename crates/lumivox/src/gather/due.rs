//! The surfels that are served in a frame, as a list: a frame costs what it does, not what all surfels would.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{FACE, GRID, OCTAHEDRON};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader =
    Shader { name: "gather/due", parts: &[GRID, FACE, OCTAHEDRON, SURFEL, TURN, include_str!("due.wgsl")] };

/// Bytes of the list before its surfels, and of each of these.
pub(super) const HEADER_BYTES: u64 = 8;
pub(super) const ENTRY_BYTES: u64 = 8;

#[derive(Debug)]
pub(super) struct Due(ComputePass);

impl Due {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Uniform<GatherUniform>,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&store.due.raw, 0, Some(HEADER_BYTES));
        let bindings = Bindings::new()
            .read("settings", settings)
            .read("surfels", &store.surfels)
            .read("light", &store.light)
            .read("hits", &store.hits)
            .write("due", &mut store.due);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_SURFELS)
    }
}
