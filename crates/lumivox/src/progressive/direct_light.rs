//! The light that leaves cells directly.

use glam::Vec4;

use crate::gpu::{Buffer, Gpu, GpuError};
use crate::volume::half4;

/// Direct light leaving each cell: three colour bands of four spherical harmonics coefficients in half floats, 24 bytes a
/// cell, in W/(m2 sr) times the clamped-cosine lobe about the surface normal, so that the integral over the sphere is
/// the cell's radiosity in W/m2. Entry `3 * cell + band`.
#[derive(Debug)]
pub struct DirectLight {
    pub(crate) sh: Buffer,
}

impl DirectLight {
    /// Bytes of one cell.
    pub const CELL_BYTES: u64 = 24;

    /// The coefficients, for shaders: `array<vec2u>` of packed half floats.
    pub fn coefficients(&self) -> &Buffer {
        &self.sh
    }

    /// Reads the coefficients back, three bands per cell. Waits; not for use inside a frame.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Vec<[Vec4; 3]>, GpuError> {
        let packed: Vec<[[half::f16; 4]; 3]> = crate::gpu::read_buffer(gpu, &self.sh)?;
        Ok(packed.iter().map(|cell| cell.map(|band| Vec4::from(band.map(half::f16::to_f32)))).collect())
    }

    /// Replaces the coefficients with values from memory, one entry per cell. Not for use inside a frame.
    pub fn upload(&mut self, gpu: &Gpu, values: &[[Vec4; 3]]) {
        let packed: Vec<_> = values.iter().map(|c| c.map(|band| half4(&band))).collect();
        gpu.queue.write_buffer(&self.sh.raw, 0, bytemuck::cast_slice(&packed));
    }
}
