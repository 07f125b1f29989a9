//! One step of propagation (5.5.2, equation 11): every cell gathers what its six neighbours send through the shared faces.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, GRID, PACK, SH, TRANSPORT, linear_groups};

use super::{PropagationUniform, Reflection};

pub(super) const SHADER: Shader = Shader {
    name: "light/propagation",
    parts: &[GRID, PACK, SH, FACE, TRANSPORT, include_str!("propagation.wgsl")],
};

/// What light travels through.
#[derive(Debug)]
pub(super) struct Media<'a> {
    pub(super) volume: &'a VolumeBuffer,
    pub(super) transport: &'a Buffer,
    pub(super) settings: &'a Uniform<PropagationUniform>,
}

#[derive(Debug)]
pub(super) struct Propagation(ComputePass);

impl Propagation {
    /// With `accumulates` incident light is that of all steps, else of the last one; with `in_free_space` it is kept in empty cells,
    /// too.
    pub(super) fn new(gpu: &Gpu, reflection: Reflection, accumulates: bool, in_free_space: bool) -> Self {
        let number = match reflection {
            Reflection::Lambertian => 0.0,
            Reflection::AxisMirror => 1.0,
            Reflection::NormalMirror => 2.0,
        };
        let flag = |is: bool| f64::from(u8::from(is));
        let constants = [
            ("REFLECTION", number),
            ("ACCUMULATES", flag(accumulates)),
            ("IN_FREE_SPACE", flag(in_free_space)),
        ];
        Self(ComputePass::new(gpu, &SHADER, &constants))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        media: &Media<'_>,
        state: &Buffer,
        (next_state, incident): (&mut Buffer, &mut Buffer),
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", media.volume.grid_uniform())
            .read("settings", media.settings)
            .read("transport", media.transport)
            .read("state", state)
            .write("next_state", next_state)
            .write("incident", incident);
        self.0.record(gpu, encoder, &bindings, linear_groups(media.volume.grid().cell_count() as u32))
    }
}
