//! For how many frames no view has shown the cells of a volume: for looking at what persists.
//!
//! The stages know no ages; this one asks the sums of the frame's injection, after it, and costs nothing where it is not recorded.
//! Volumes of bricks keep ages by themselves ([`BrickCell`](super::BrickCell)).

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::{NORMAL, VolumeBuffer, check_grid};
use crate::wgsl::{GRID, PACK, linear_groups};

use super::Progressive;
use super::injection::ATTRIBUTE_SUM_WORDS;

pub(super) const SHADER: Shader =
    Shader { name: "progressive/cell_ages", parts: &[GRID, PACK, include_str!("cell_ages.wgsl")] };

/// Ages of the cells of one volume, a word each.
#[derive(Debug)]
pub struct CellAges {
    pass: ComputePass,
    ages: Buffer,
}

impl CellAges {
    /// Compiles the stage; no cell has been shown yet.
    ///
    /// # Errors
    /// A grid of more than 33,554,432 cells on the core tier.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        check_grid(gpu, "the ages of cells", volume.grid(), 4)?;
        Ok(Self {
            pass: ComputePass::new(gpu, &SHADER, &[("ATTRIBUTE_SUM_WORDS", ATTRIBUTE_SUM_WORDS as f64)]),
            ages: Buffer::storage(gpu, "progressive/cell ages", 4 * volume.grid().cell_count())?,
        })
    }

    /// Counts a frame; after [`Progressive::record_end`] of the volume that both were made for.
    ///
    /// # Errors
    /// A volume without normals, or a failure of the device.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        stages: &Progressive,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let normal = volume.channel(NORMAL).ok_or_else(|| super::resolve::wrong_channels(SHADER.name))?;
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("normal", normal)
            .read("attribute_sums", &stages.attribute_sums)
            .write("ages", &mut self.ages);
        self.pass.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }

    /// For each cell 0 if it is empty or no view has shown it, else 1 more than the frames since one did.
    pub fn ages(&self) -> &Buffer {
        &self.ages
    }
}
