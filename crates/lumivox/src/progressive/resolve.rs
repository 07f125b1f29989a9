//! The end of injection: sums of attributes become means, in the cells that got samples; all others keep what they hold.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, VIEW, linear_groups};

use super::ViewInput;
use super::injection::ATTRIBUTE_SUM_WORDS;

pub(super) const SHADER: Shader =
    Shader { name: "progressive/resolve", parts: &[GRID, VIEW, PACK, include_str!("resolve.wgsl")] };

#[derive(Debug)]
pub(super) struct Resolve(ComputePass);

impl Resolve {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[("ATTRIBUTE_SUM_WORDS", ATTRIBUTE_SUM_WORDS as f64)]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        attribute_sums: &Buffer,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let groups = linear_groups(volume.grid().cell_count() as u32);
        let (grid, mut channels) = volume.current_mut();
        let [normal, albedo, emission] = channels.as_mut_slice() else {
            return Err(wrong_channels(SHADER.name));
        };
        let bindings = Bindings::new()
            .read("grid", grid)
            .read("view", &view.uniform)
            .read("attribute_sums", attribute_sums)
            .write("normal_out", normal)
            .write("albedo_out", albedo)
            .write("emission_out", emission);
        self.0.record(gpu, encoder, &bindings, groups)
    }
}

/// The volume was not made with [`super::CHANNELS`].
pub(super) fn wrong_channels(pass: &'static str) -> GpuError {
    GpuError::Binding {
        pass,
        reason: format!("needs a volume of the channels {}", super::CHANNELS.join(", ")),
    }
}
