//! The first state of propagation: the sums of all virtual point lights, as half floats.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::progressive::ViewInput;
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, VIEW, linear_groups};

use super::injection::LIGHT_STEPS;

pub(super) const SHADER: Shader =
    Shader { name: "lpv/seed", parts: &[GRID, VIEW, PACK, include_str!("seed.wgsl")] };

#[derive(Debug)]
pub(super) struct Seed(ComputePass);

impl Seed {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[("LIGHT_STEPS", LIGHT_STEPS)]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, volume): (&ViewInput, &VolumeBuffer),
        light_sums: &Buffer,
        state: &mut Buffer,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("light_sums", light_sums)
            .write("state", state);
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
