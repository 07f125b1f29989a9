//! Interleaved updates: one axis a frame, as the papers' discussion proposes.

use super::{Layer, Mesh, Voxelizer};
use crate::gpu::{Gpu, GpuError};
use crate::volume::VolumeBuffer;

/// Three layers, one for each axis, and whose turn it is: for [`Voxelizer::record_interleaved`].
#[derive(Debug)]
pub struct Interleaved {
    layers: [Layer; 3],
    next: usize,
}

impl Interleaved {
    /// Three empty layers.
    pub fn new(gpu: &Gpu, voxelizer: &Voxelizer) -> Result<Self, GpuError> {
        let layers = [voxelizer.layer(gpu)?, voxelizer.layer(gpu)?, voxelizer.layer(gpu)?];
        Ok(Self { layers, next: 0 })
    }
}

impl Voxelizer {
    /// Voxelizes the triangles of one axis alone, the next one in each call, and makes the volume of these and of what earlier
    /// calls found for the two other axes. So it takes a third of the time, and the third call has seen everything.
    pub fn record_interleaved(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[&Mesh],
        interleaved: &mut Interleaved,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let axis = interleaved.next;
        self.record_layer_axis(gpu, encoder, meshes, &mut interleaved.layers[axis], Some(axis))?;
        interleaved.next = (axis + 1) % 3;
        let [x, y, z] = &interleaved.layers;
        self.record_merge(gpu, encoder, &[x, y, z], volume)
    }
}
