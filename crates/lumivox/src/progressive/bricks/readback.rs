//! From bricks to memory. These wait; they are no part of a frame.

use glam::{IVec3, UVec3, Vec4};
use half::f16;
use lumivox_core::HostVolume;

use crate::gpu::{Gpu, GpuError, read_buffer};

use super::ProgressiveVoxelizer;
use super::store::{BRICK_CELLS, BRICK_SIDE, HEADER};

/// An occupied cell.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickCell {
    /// Its number along each axis, counted from the corner of the first window; negative ones lie before it.
    pub cell: IVec3,
    /// Its channels.
    pub values: Vec<Vec4>,
    /// Frames since a view last showed it.
    pub age: u32,
    /// In how many frames one did, up to 255.
    pub frames: u32,
    /// Whether it is one of what stands still; ages of such cells begin with [`ProgressiveVoxelizer::record_static`].
    pub is_static: bool,
}

/// Where an occupied cell stands, in the world and among the cells of all slots.
struct Place {
    cell: IVec3,
    index: usize,
    is_static: bool,
}

impl ProgressiveVoxelizer {
    /// The numbers of the occupied cells, as [`BrickCell::cell`], in no order. Waits.
    pub fn read_occupied(&self, gpu: &Gpu) -> Result<Vec<IVec3>, GpuError> {
        Ok(self.read_places(gpu)?.into_iter().map(|place| place.cell).collect())
    }

    /// The occupied cells with their values, in no order. Waits.
    pub fn read_cells(&self, gpu: &Gpu) -> Result<Vec<BrickCell>, GpuError> {
        let values: Vec<[f16; 4]> = read_buffer(gpu, &self.store.values)?;
        let shown: Vec<u32> = read_buffer(gpu, &self.store.shown)?;
        let channels = self.channels.len();
        let cell = |Place { cell, index, is_static }: Place| BrickCell {
            cell,
            is_static,
            values: values[index * channels..(index + 1) * channels]
                .iter()
                .map(|v| Vec4::from_array(v.map(f16::to_f32)))
                .collect(),
            age: self.frame.wrapping_sub(shown[index]) & 0xff_ffff,
            frames: shown[index] >> 24,
        };
        Ok(self.read_places(gpu)?.into_iter().map(cell).collect())
    }

    /// The occupied cells.
    fn read_places(&self, gpu: &Gpu) -> Result<Vec<Place>, GpuError> {
        let counters: Vec<u32> = read_buffer(gpu, &self.store.counters)?;
        let lists: Vec<u32> = read_buffer(gpu, &self.store.lists)?;
        let headers: Vec<u32> = read_buffer(gpu, &self.store.headers)?;
        let (side, room) = (self.side() as usize, self.settings.bricks as usize);
        let listed = &lists[side * room..side * room + (counters[side] as usize).min(room)];
        let mut places = Vec::new();
        for slot in listed.iter().map(|slot| *slot as usize) {
            let header = &headers[slot * HEADER..(slot + 1) * HEADER];
            let corner = IVec3::from_array([0, 1, 2].map(|axis| header[axis] as i32 * BRICK_SIDE as i32));
            for number in 0..BRICK_CELLS as u32 {
                let has = |word: usize| header[word + number as usize / 32] >> (number % 32) & 1 == 1;
                if !has(3) {
                    continue;
                }
                let place = UVec3::new(number, number / BRICK_SIDE, number / (BRICK_SIDE * BRICK_SIDE));
                let cell = corner + (place % BRICK_SIDE).as_ivec3();
                let index = slot * BRICK_CELLS as usize + number as usize;
                places.push(Place { cell, index, is_static: has(7) });
            }
        }
        Ok(places)
    }

    /// The window as a volume in memory, with empty cells zero. Waits.
    pub fn read_back(&self, gpu: &Gpu) -> Result<HostVolume, GpuError> {
        let grid = self.grid();
        let mut volume = HostVolume::new(grid);
        let mut channels = vec![vec![Vec4::ZERO; grid.cell_count() as usize]; self.channels.len()];
        let first = self.first * BRICK_SIDE as i32;
        for BrickCell { cell, values, .. } in self.read_cells(gpu)? {
            let within = cell - first;
            if within.cmplt(IVec3::ZERO).any() || within.cmpge(grid.dims.as_ivec3()).any() {
                continue;
            }
            let index = grid.index(within.as_uvec3());
            for (channel, value) in channels.iter_mut().zip(values) {
                channel[index] = value;
            }
        }
        for (channel, values) in self.channels.iter().zip(channels) {
            volume.insert(&channel.name, values);
        }
        Ok(volume)
    }
}
