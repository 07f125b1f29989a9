//! Injection (6.2.2, Listing 6.2; dissertation 7.4.2): a grid of points is lifted by the view's depth and falls into cells.
//! This stage adds up their attributes, [`light_injection`](super::light_injection) their light.
//!
//! Points are moved [`SURFACE_SHIFT`] of a cell against their normal first. A wall that lies exactly on a cell
//! boundary would else be drawn into either neighbour by rounding; so it falls into the cell behind its visible side, and
//! the cell before it stays free for light.
//!
//! Points are compute invocations that add into 32-bit fixed-point sums with integer atomics, instead of blended point
//! primitives sorted into slices by a geometry shader: sums do not saturate as half floats do (2048 is the largest
//! count they hold), do not depend on the order of points, and run on core WebGPU.
//!
//! | sums per cell | words |
//! | --- | --- |
//! | attributes | normal 3, albedo 3, emission 3, count 1 |
//! | light | three bands of 4 coefficients, count 1 |

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, POINT, VIEW, linear_groups};

use super::ViewInput;

/// Words of a cell's attribute sums.
pub(super) const ATTRIBUTE_SUM_WORDS: u64 = 10;
/// How far a sample is moved against its normal, in cells. Depth values place a point to about 1/500 cell.
pub const SURFACE_SHIFT: f64 = 1.0 / 64.0;

pub(super) const SHADER: Shader =
    Shader { name: "progressive/injection", parts: &[GRID, VIEW, POINT, include_str!("injection.wgsl")] };

#[derive(Debug)]
pub(super) struct Injection(ComputePass);

impl Injection {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let constants =
            [("SURFACE_SHIFT", SURFACE_SHIFT), ("ATTRIBUTE_SUM_WORDS", ATTRIBUTE_SUM_WORDS as f64)];
        Self(ComputePass::new(gpu, &SHADER, &constants))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
        attribute_sums: &mut Buffer,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("albedo", &view.textures.albedo)
            .read("emission", &view.textures.emission)
            .write("attribute_sums", attribute_sums);
        self.0.record(gpu, encoder, &bindings, linear_groups(view.invocations()))
    }
}
