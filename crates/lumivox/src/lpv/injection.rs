//! Injection: each point of a reflective shadow map becomes a virtual point light, a cosine lobe with the flux that the
//! surface around it reflects, in the cell half a cell before it.
//!
//! Half a cell along the normal keeps light from being injected behind its own wall, and from lighting it. Lights are sums
//! and not means: a denser map has smaller points. They are 32-bit fixed point, since blended half floats saturate and
//! depend on the order of points.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::progressive::LightView;
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, POINT, SH, VIEW, VISIBILITY, linear_groups};

use super::{AREA, HALF_CELL};

/// Fixed-point steps of a sum per cell face of the largest radiance. A sum has room for 62 such faces.
pub(crate) const LIGHT_STEPS: f64 = (1u32 << 25) as f64;

pub(super) const SHADER: Shader = Shader {
    name: "lpv/injection",
    parts: &[GRID, VIEW, POINT, VISIBILITY, SH, AREA, include_str!("injection.wgsl")],
};

#[derive(Debug)]
pub(super) struct Injection(ComputePass);

impl Injection {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let constants = [("HALF_CELL", HALF_CELL), ("LIGHT_STEPS", LIGHT_STEPS)];
        Self(ComputePass::new(gpu, &SHADER, &constants))
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
        self.0.record(gpu, encoder, &bindings, linear_groups(view.points.x * view.points.y))
    }
}
