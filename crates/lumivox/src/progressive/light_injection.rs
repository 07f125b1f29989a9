//! Injection of light (6.3): the radiance that a view's points reflect, times the clamped cosine about their normal, is
//! added to the sums of the cells they fall in. The points are those of [`injection`](super::injection).
//!
//! It is a stage of its own, so that views can bring light without touching attributes.
//!
//! Points of which sums are asked, and not means, count by the share of a cell's face that they stand for: as virtual point
//! lights, by the areas of light propagation volumes and in steps as fine as theirs.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::lpv::{AREA, LIGHT_STEPS};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, POINT, SH, VIEW, VISIBILITY, linear_groups};

use super::{LightView, SURFACE_SHIFT};

/// Words of a cell's light sums.
pub const LIGHT_SUM_WORDS: u64 = 13;

pub(super) const SHADER: Shader = Shader {
    name: "progressive/light_injection",
    parts: &[GRID, VIEW, POINT, VISIBILITY, SH, AREA, include_str!("light_injection.wgsl")],
};

/// What a cell takes of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Summed {
    /// Their mean.
    Mean,
    /// Their sum, each by the share of a cell's face that it stands for.
    ByArea,
}

impl Summed {
    /// The shaders' constants.
    pub(super) fn constants(self) -> [(&'static str, f64); 2] {
        [("BY_AREA", if self == Self::ByArea { 1.0 } else { 0.0 }), ("LIGHT_STEPS", LIGHT_STEPS)]
    }
}

#[derive(Debug)]
pub(super) struct LightInjection(ComputePass);

impl LightInjection {
    pub(super) fn new(gpu: &Gpu, summed: Summed) -> Self {
        let own = [("SURFACE_SHIFT", SURFACE_SHIFT), ("LIGHT_SUM_WORDS", LIGHT_SUM_WORDS as f64)];
        Self(ComputePass::new(gpu, &SHADER, &[own, summed.constants()].concat()))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: LightView<'_>,
        volume: &VolumeBuffer,
        light_sums: &mut Buffer,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", view.uniform)
            .read("depth", view.depth)
            .read("normal", view.normal)
            .read("radiance", view.radiance)
            .write("light_sums", light_sums);
        self.0.record(gpu, encoder, &bindings, linear_groups(view.invocations))
    }
}
