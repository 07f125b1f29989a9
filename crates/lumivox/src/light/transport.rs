//! What propagation needs of each cell: whether it is occupied, which faces are open, normal and albedo (5.5.2).

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::{ALBEDO, NORMAL, VolumeBuffer};
use crate::wgsl::{FACE, GRID, PACK, SH, TRANSPORT, linear_groups};

use super::PropagationUniform;

pub(super) const SHADER: Shader = Shader {
    name: "light/transport",
    parts: &[GRID, PACK, SH, FACE, TRANSPORT, include_str!("transport.wgsl")],
};

#[derive(Debug)]
pub(super) struct Transport(ComputePass);

impl Transport {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, settings): (&VolumeBuffer, &Uniform<PropagationUniform>),
        transport: &mut Buffer,
    ) -> Result<(), GpuError> {
        let (Some(normal), Some(albedo)) = (volume.channel(NORMAL), volume.channel(ALBEDO)) else {
            let reason = format!("needs a volume with the channels {NORMAL} and {ALBEDO}");
            return Err(GpuError::Binding { pass: SHADER.name, reason });
        };
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("settings", settings)
            .read("normal", normal)
            .read("albedo", albedo)
            .write("transport", transport);
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
