//! The lighting rule (6.3): the sums of one light become means, which are added to the direct light of their cells, or
//! replace it when they come from the camera.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, VIEW, ViewUniform, linear_groups};

use super::{DirectLight, LIGHT_SUM_WORDS};

pub(super) const SHADER: Shader = Shader {
    name: "progressive/light_resolve",
    parts: &[GRID, VIEW, PACK, include_str!("light_resolve.wgsl")],
};

/// What happens to the light that a cell already has this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Replace {
    /// The mean of one light is added to it.
    No,
    /// The mean of the camera's samples, which hold all lights, takes its place.
    Yes,
}

impl Replace {
    /// The shaders' constant `ADDS`, a truth value.
    pub(super) fn adds(self) -> f64 {
        match self {
            Self::No => 1.0,
            Self::Yes => 0.0,
        }
    }
}

#[derive(Debug)]
pub(super) struct LightResolve(ComputePass);

impl LightResolve {
    pub(super) fn new(gpu: &Gpu, replace: Replace) -> Self {
        let constants = [("ADDS", replace.adds()), ("LIGHT_SUM_WORDS", LIGHT_SUM_WORDS as f64)];
        Self(ComputePass::new(gpu, &SHADER, &constants))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, volume): (&Uniform<ViewUniform>, &VolumeBuffer),
        light_sums: &Buffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", view)
            .read("light_sums", light_sums)
            .write("light", &mut light.sh);
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
