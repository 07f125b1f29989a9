//! The sums of one light become means, or are taken as they are, and are added to the direct light of their cells, or replace it
//! when they come from the camera: see [`light_rule`](super::light_rule).

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, VIEW, ViewUniform, linear_groups};

use super::light_injection::Summed;
use super::{DirectLight, LIGHT_SUM_WORDS, LightRule};

const PASS: &str = include_str!("light_resolve.wgsl");
pub(super) const PULLED: Shader =
    Shader { name: "progressive/light_resolve", parts: &[GRID, VIEW, PACK, LightRule::PULLED, PASS] };
pub(super) const STORED: Shader =
    Shader { name: "progressive/light_resolve stored", parts: &[GRID, VIEW, PACK, LightRule::STORED, PASS] };

/// What happens to the light that a cell already has this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Replace {
    /// What one light brings is added to it.
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
    pub(super) fn new(gpu: &Gpu, rule: LightRule, replace: Replace, summed: Summed) -> Self {
        let shader = if rule == LightRule::Stored { STORED } else { PULLED };
        let own = [("ADDS", replace.adds()), ("LIGHT_SUM_WORDS", LIGHT_SUM_WORDS as f64)];
        Self(ComputePass::new(gpu, &shader, &[own, summed.constants()].concat()))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, volume): (&Uniform<ViewUniform>, &VolumeBuffer),
        light_sums: &Buffer,
        (light, reached): (&mut DirectLight, Option<&mut Buffer>),
    ) -> Result<(), GpuError> {
        let mut bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", view)
            .read("light_sums", light_sums)
            .write("light", &mut light.sh);
        if let Some(reached) = reached {
            bindings = bindings.write("reached", reached);
        }
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
