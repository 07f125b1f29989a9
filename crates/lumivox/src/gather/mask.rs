//! Which sub-cells are filled, and which cells of a block of 4 x 4 x 4 cells hold any.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader};
use crate::volume::{NORMAL, VolumeBuffer};
use crate::wgsl::{GRID, PACK, linear_groups};

use super::Store;

pub(super) const SHADER: Shader =
    Shader { name: "gather/mask", parts: &[GRID, PACK, include_str!("mask.wgsl")] };

#[derive(Debug)]
pub(super) struct Mask(ComputePass);

impl Mask {
    /// `known`: sub-cells are what was said of them, wherever the volume is occupied.
    pub(super) fn new(gpu: &Gpu, known: bool) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[("KNOWN", f64::from(u8::from(known)))]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        encoder.clear_buffer(&store.blocks.raw, 0, None);
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("normal", volume.require(SHADER.name, NORMAL)?)
            .write("subcells", &mut store.subcells)
            .write("mask", &mut store.mask)
            .write("blocks", &mut store.blocks);
        self.0.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }
}
