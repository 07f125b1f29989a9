//! The first state of propagation: light that leaves surfaces, and sky that enters the grid.
//!
//! A plane crosses `|nx| + |ny| + |nz|` cells per cell-face area of itself, so each cell emits the inverse of that of its
//! surface's radiosity: a slanted wall then sends out as much as a straight one of the same area.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::progressive::DirectLight;
use crate::volume::{EMISSION, VolumeBuffer};
use crate::wgsl::{FACE, GRID, PACK, SH, TRANSPORT, linear_groups};

use super::PropagationUniform;

pub(super) const SHADER: Shader =
    Shader { name: "light/seed", parts: &[GRID, PACK, SH, FACE, TRANSPORT, include_str!("seed.wgsl")] };

/// What is lit.
#[derive(Debug)]
pub(super) struct Lit<'a> {
    pub(super) volume: &'a VolumeBuffer,
    pub(super) direct: &'a DirectLight,
    pub(super) transport: &'a Buffer,
    pub(super) settings: &'a Uniform<PropagationUniform>,
}

#[derive(Debug)]
pub(super) struct Seed(ComputePass);

impl Seed {
    /// With `adds` light joins what is under way, else it takes its place.
    pub(super) fn new(gpu: &Gpu, adds: bool) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[("ADDS", f64::from(u8::from(adds)))]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lit: &Lit<'_>,
        state: &mut Buffer,
    ) -> Result<(), GpuError> {
        let Some(emission) = lit.volume.channel(EMISSION) else {
            let reason = format!("needs a volume with the channel {EMISSION}");
            return Err(GpuError::Binding { pass: SHADER.name, reason });
        };
        let bindings = Bindings::new()
            .read("grid", lit.volume.grid_uniform())
            .read("settings", lit.settings)
            .read("transport", lit.transport)
            .read("direct", &lit.direct.sh)
            .read("emission", emission)
            .write("state", state);
        self.0.record(gpu, encoder, &bindings, linear_groups(lit.volume.grid().cell_count() as u32))
    }
}
