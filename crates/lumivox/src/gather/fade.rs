//! Light that pixels see: where surfels take turns, theirs changes by a jump when it is their turn, and this goes there in even
//! steps, so that nobody sees turns (the dissertation's 5.7 asks for that). Where all have theirs in every frame, it is the same.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{FACE, GRID, OCTAHEDRON, PACK};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/fade",
    parts: &[GRID, FACE, PACK, OCTAHEDRON, SURFEL, TURN, include_str!("fade.wgsl")],
};

#[derive(Debug)]
pub(super) struct Fade(ComputePass);

impl Fade {
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
            .read("light", &store.light)
            .read("shine", &store.shine)
            .read("smoothed", &store.smoothed)
            .write("shown", &mut store.shown);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_SURFELS)
    }
}
