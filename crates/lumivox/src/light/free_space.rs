//! Light of empty cells, for an [`IrradianceVolume`](crate::irradiance::IrradianceVolume).
//!
//! Each step leaves in an empty cell what comes through its six faces: `f` through the face with the outward normal `d` is the flux of
//! radiance of two bands whose constant is the mean of the six over the constant of the clamped cosine, and whose linear part along
//! an axis is half the difference of its two over the cosine's linear one. So a beam along an axis gives its net flux.
//!
//! **Gain.** Of what came through a face a cell sends `1/6 - p / 2` back by it, with the persistence `p`, and a wall's lobe sends nothing
//! back. So less goes either way through a face between two empty cells than through one before a wall, though as much as
//! leaves the wall reaches it. Between two walls that send out `W` alike let a flux `g` go either way through the faces inside, and `s`
//! along the walls through the sides of the first cells. These send `W / 6 + g / 6 + 2 s / 3` through each of their sides, which is `s`, and
//! `(1/6 + p / 2) g + 2 s / 3` into the wall, which is `W`: then `s = (W + g) / 2` and `W = 3 (1 + p) / 4 g`. The mean of the six is
//! multiplied by that, 1.46 at the default persistence, so that free space has the light that its walls get. In a closed
//! room, whose edges lie before two walls, 0.94 of it are found.

use crate::gpu::{Gpu, GpuError};
use crate::irradiance::{FromCells, IrradianceSource, IrradianceVolume, PROPAGATED};
use crate::volume::VolumeBuffer;

use super::IndirectLight;
use super::propagation::Propagation;

/// The flux of a wall over that between empty cells before it; see above.
pub(super) fn gain(persistence: f32) -> f32 {
    0.75 * (1.0 + persistence)
}

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
