//! Surfels and their light, back in memory: for tests, for measuring, and for stills that settle.

use glam::Vec3;

use super::GatheredLight;
use crate::gpu::{Gpu, GpuError, read_buffer};

/// Surfels in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfelCount {
    /// Surfels that there are.
    pub used: u32,
    /// Room for them.
    pub capacity: u32,
    /// Surfels that found no room in the last [`GatheredLight::record_surfels`]; they are dark.
    pub refused: u32,
    /// Surfels that were served in the last frame that was recorded.
    pub due: u32,
}

impl GatheredLight {
    /// How many surfels there are. Waits; not for use inside a frame.
    pub fn count(&self, gpu: &Gpu) -> Result<SurfelCount, GpuError> {
        let counts: Vec<i32> = read_buffer(gpu, &self.store.counts)?;
        let due: Vec<u32> = read_buffer(gpu, &self.store.due)?;
        let free = counts[0].clamp(0, self.capacity as i32) as u32;
        Ok(SurfelCount {
            used: self.capacity - free,
            capacity: self.capacity,
            refused: counts[1].max(0) as u32,
            due: due[0],
        })
    }

    /// The sub-cells of each cell that rays see, as in [`upload_subcells`](Self::upload_subcells). Waits; not for use inside a
    /// frame.
    pub fn read_subcells(&self, gpu: &Gpu) -> Result<Vec<u64>, GpuError> {
        read_buffer(gpu, &self.store.mask)
    }

    /// Irradiance, summed over surfels and colour bands: grows with each bounce by less, until light has settled. Reads back and
    /// waits; not for use inside a frame.
    pub fn total_irradiance(&self, gpu: &Gpu) -> Result<f64, GpuError> {
        let shine: Vec<[half::f16; 8]> = read_buffer(gpu, &self.store.shine)?;
        Ok(shine.iter().flat_map(|s| &s[4..7]).map(|e| e.to_f64()).sum())
    }

    /// Irradiance of each cell's six sides, in the order +x, -x, +y, -y, +z, -z; none where there is no surfel, and the mean
    /// where there are two. Waits; not for use inside a frame.
    pub fn read_irradiance(&self, gpu: &Gpu) -> Result<Vec<[Option<Vec3>; 6]>, GpuError> {
        let shine: Vec<[half::f16; 8]> = read_buffer(gpu, &self.store.shine)?;
        let sky: Vec<[half::f16; 4]> = read_buffer(gpu, &self.store.sky_light)?;
        let share = if self.settings.sky_apart { 0.0 } else { std::f32::consts::PI };
        self.read_sides(gpu, |place| {
            let (shine, sky) = (shine.get(place)?, sky.get(place)?);
            Some(Vec3::from_array(std::array::from_fn(|i| shine[4 + i].to_f32() + share * sky[i].to_f32())))
        })
    }

    /// The irradiance that pixels see, likewise: on its way to that of [`read_irradiance`](Self::read_irradiance) where surfels take
    /// turns.
    pub fn read_shown(&self, gpu: &Gpu) -> Result<Vec<[Option<Vec3>; 6]>, GpuError> {
        let shown: Vec<[half::f16; 8]> = read_buffer(gpu, &self.store.shown)?;
        self.read_sides(gpu, |place| {
            shown.get(place).map(|s| Vec3::from_array(std::array::from_fn(|i| s[4 + i].to_f32())))
        })
    }

    /// Radiance that each cell's six sides reflect of this frame's views, likewise.
    pub fn read_direct(&self, gpu: &Gpu) -> Result<Vec<[Option<Vec3>; 6]>, GpuError> {
        let light: Vec<[f32; 4]> = read_buffer(gpu, &self.store.light)?;
        self.read_sides(gpu, |place| light.get(place).map(|l| Vec3::new(l[0], l[1], l[2])))
    }

    fn read_sides(
        &self,
        gpu: &Gpu,
        value: impl Fn(usize) -> Option<Vec3>,
    ) -> Result<Vec<[Option<Vec3>; 6]>, GpuError> {
        let table: Vec<[[u32; 2]; 6]> = read_buffer(gpu, &self.store.table)?;
        let side = |parts: [u32; 2]| {
            let found = parts.map(|place| value(place as usize));
            match found {
                [Some(one), Some(other)] => Some(0.5 * (one + other)),
                [one, other] => one.or(other),
            }
        };
        Ok(table.iter().map(|cell| cell.map(side)).collect())
    }
}
