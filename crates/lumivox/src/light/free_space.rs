//! Light of empty cells, for an [`IrradianceVolume`](crate::irradiance::IrradianceVolume).
//!
//! Each step leaves in an empty cell what comes through its six faces: `f` through the face with the outward normal `d` is the flux of
//! radiance of two bands whose constant is the mean of the six over the constant of the clamped cosine, and whose linear part along
//! an axis is half the difference of its two over the cosine's linear one. So light that is the same from all sides is kept
//! exactly, and a beam along an axis gives two thirds of its irradiance to what faces it.
//!
//! Narrow lobes send a negative share back, so that less goes either way through a face between two empty cells than through one
//! before a wall: in a closed room that glows evenly free space has 0.64 of the light that its walls get, everywhere and from
//! all sides, at the default persistence.

use crate::gpu::{Gpu, GpuError};
use crate::irradiance::{FromCells, IrradianceSource, IrradianceVolume, PROPAGATED};
use crate::volume::VolumeBuffer;

use super::IndirectLight;
use super::propagation::Propagation;

impl IndirectLight {
    /// Keeps the light of empty cells, too: what an irradiance volume is filled from, at 96 bytes more that a step reads and writes
    /// in each of them.
    pub fn with_free_space(self, gpu: &Gpu) -> Self {
        Self {
            propagation_pass: Propagation::new(gpu, self.reflection, true, true),
            flow_pass: Propagation::new(gpu, self.reflection, false, true),
            free_space: Some(FromCells::new(gpu, &PROPAGATED)),
            ..self
        }
    }

    /// Whether it does.
    pub fn keeps_free_space(&self) -> bool {
        self.free_space.is_some()
    }
}

impl IrradianceSource for IndirectLight {
    fn record_irradiance_volume(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        target: &mut IrradianceVolume,
        part: (u32, u32, u32),
    ) -> Result<(), GpuError> {
        let Some(pass) = &self.free_space else {
            let reason = "propagated light keeps none in free space; make it with `with_free_space`";
            return Err(GpuError::Validation(reason.to_owned()));
        };
        let cells = (volume, &self.incident, Some(&self.transport));
        pass.record(gpu, encoder, cells, target, part)
    }
}
