//! No direct light yet, of the surfels whose turn it is to ask for it.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{FACE, GRID, OCTAHEDRON};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader =
    Shader { name: "gather/dark", parts: &[GRID, FACE, OCTAHEDRON, SURFEL, TURN, include_str!("dark.wgsl")] };

#[derive(Debug)]
pub(super) struct Dark(ComputePass);

impl Dark {
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
        let bindings = Bindings::new()
            .read("settings", settings)
            .read("surfels", &store.surfels)
            .write("light", &mut store.light);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_SURFELS)
    }
}
