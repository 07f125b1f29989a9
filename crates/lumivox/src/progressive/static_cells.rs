//! What stands still, in a volume over all cells (dissertation 7.8 and 7.10): made of triangles once, and put back after whatever
//! views have cleared or written.

use lumivox_core::Grid;

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader};
use crate::volume::{ChannelFormat, VolumeBuffer};
use crate::wgsl::{GRID, PACK, linear_groups};

use super::CHANNELS;

pub(super) const SHADER: Shader =
    Shader { name: "progressive/static_cells", parts: &[GRID, PACK, include_str!("static_cells.wgsl")] };

/// Cells of what stands still: for volumes that [`Progressive`](super::Progressive) or [`SinglePass`](super::SinglePass) keeps up
/// from views. In volumes of bricks [`record_static`](super::ProgressiveVoxelizer::record_static) does that.
///
/// A host fills [`Self::volume_mut`] with a [`Voxelizer`](crate::voxelize::Voxelizer), once and when other things stand still, and
/// records [`Self::record`] at the end of each frame's injection. Cells that it holds no more are then cells like others, which a view may
/// clear. 24 bytes a cell.
#[derive(Debug)]
pub struct StaticCells {
    still: VolumeBuffer,
    pass: ComputePass,
}

impl StaticCells {
    /// None yet.
    ///
    /// # Errors
    /// A grid of which a channel does not fit the device.
    pub fn new(gpu: &Gpu, grid: Grid) -> Result<Self, GpuError> {
        let still = VolumeBuffer::with_formats(gpu, grid, &CHANNELS.map(ChannelFormat::half4))?;
        Ok(Self { still, pass: ComputePass::new(gpu, &SHADER, &[]) })
    }

    /// The cells, to be filled; empty ones stand for nothing.
    pub fn volume_mut(&mut self) -> &mut VolumeBuffer {
        &mut self.still
    }

    /// Puts them into a volume of the same grid and of [`CHANNELS`].
    ///
    /// # Errors
    /// A volume of other channels or cells.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        if volume.grid() != self.still.grid() {
            let reason = "the volume is over another grid".to_owned();
            return Err(GpuError::Binding { pass: SHADER.name, reason });
        }
        let [still_normal, still_albedo, still_emission] = CHANNELS;
        let still = |name| self.still.require(SHADER.name, name);
        let groups = linear_groups(volume.grid().cell_count() as u32);
        let (grid, mut channels) = volume.current_mut();
        let [normal, albedo, emission] = channels.as_mut_slice() else {
            return Err(super::resolve::wrong_channels(SHADER.name));
        };
        let bindings = Bindings::new()
            .read("grid", grid)
            .read("still_normal", still(still_normal)?)
            .read("still_albedo", still(still_albedo)?)
            .read("still_emission", still(still_emission)?)
            .write("normal_out", normal)
            .write("albedo_out", albedo)
            .write("emission_out", emission);
        self.pass.record(gpu, encoder, &bindings, groups)
    }
}
