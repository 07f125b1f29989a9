//! Sub-cells from a grid four times as fine, whose cells are bits in a buffer on the GPU.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, linear_groups};

use super::{GatheredLight, Subcells};

pub(super) const SHADER: Shader =
    Shader { name: "gather/given sub-cells", parts: &[GRID, include_str!("given_subcells.wgsl")] };

#[derive(Debug)]
pub(super) struct GivenSubcells {
    alone: ComputePass,
    among_others: ComputePass,
}

impl GivenSubcells {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let pass = |keeps: f64| ComputePass::new(gpu, &SHADER, &[("KEEPS", keeps)]);
        Self { alone: pass(0.0), among_others: pass(1.0) }
    }
}

impl GatheredLight {
    /// As [`upload_subcells`](Self::upload_subcells), of bits that are on the GPU: bit `i % 32` of word `i / 32` for cell `i` of a grid
    /// with the volume's corner, four times as many cells along each axis and a quarter of the cell size, such as
    /// [`Voxelizer::occupancy`](crate::voxelize::Voxelizer::occupancy).
    ///
    /// # Errors
    /// When there are fewer bits than sub-cells.
    pub fn record_subcells(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        bits: &Buffer,
    ) -> Result<(), GpuError> {
        self.record_bits(gpu, encoder, volume, bits, false)?;
        self.subcells = Subcells::Given;
        Ok(())
    }

    /// The same of what stands still, beside the sub-cells that views bring: after these have cleared and injected theirs, in every frame.
    ///
    /// # Errors
    /// As [`record_subcells`](Self::record_subcells).
    pub fn record_static_subcells(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        bits: &Buffer,
    ) -> Result<(), GpuError> {
        self.record_bits(gpu, encoder, volume, bits, true)
    }

    fn record_bits(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        bits: &Buffer,
        keeps: bool,
    ) -> Result<(), GpuError> {
        let cells = volume.grid().cell_count();
        if 8 * bits.size() < 64 * cells {
            let reason = format!("{} bits are too few for the sub-cells of {cells} cells", 8 * bits.size());
            return Err(GpuError::Binding { pass: SHADER.name, reason });
        }
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("fine", bits)
            .write("subcells", &mut self.store.subcells);
        let passes = &self.passes.given_subcells;
        let pass = if keeps { &passes.among_others } else { &passes.alone };
        pass.record(gpu, encoder, &bindings, linear_groups(cells as u32))
    }
}
