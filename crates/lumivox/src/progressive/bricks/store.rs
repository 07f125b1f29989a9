//! All that a volume of bricks keeps on the GPU.
//!
//! | buffer | holds |
//! | --- | --- |
//! | table | for each brick of the window its slot, or that it has none; 4 bytes a brick, by its number modulo the window's size |
//! | headers | for each slot the brick's number, a bit for each of its cells, another for those of what stands still, and its last frame; 36 bytes |
//! | lists | slots: occupied bricks of this and of the last frame, free ones, those touched in this frame |
//! | counters | how many of each, and what happened in this frame |
//! | values | for each cell of each slot the channels, 8 bytes each |
//! | shown | for each such cell the last frame that showed it, and how many did |
//! | sums | fixed-point sums of the cells of touched bricks |

use glam::{UVec3, Vec4};
use lumivox_core::Bounds;

use crate::gpu::{Buffer, Gpu, GpuError, Uniform};
use crate::progressive::channel::{AttributeChannel, sum_words};
use crate::wgsl::GridUniform;

use super::shared::{Windows, sizes};
use super::{BrickUniform, VoxelizerSettings};

/// Cells along a side of a brick, and in it.
pub const BRICK_SIDE: u32 = 4;
pub(super) const BRICK_CELLS: u64 = 64;
/// Words of a header, and counters.
pub(in crate::progressive) const HEADER: usize = 9;
pub(super) const COUNTERS: u64 = 16;
/// The most boxes that cleanup is restricted to; more become one around all.
pub(super) const MOST_BOXES: usize = 64;
/// The counter of free slots.
const FREE: usize = 2;

#[derive(Debug)]
pub(super) struct Store {
    pub(super) grid: Uniform<GridUniform>,
    pub(super) bricks: Uniform<BrickUniform>,
    pub(super) table: Buffer,
    pub(super) headers: Buffer,
    pub(super) lists: Buffer,
    pub(super) counters: Buffer,
    pub(super) groups: Buffer,
    pub(super) values: Buffer,
    pub(super) shown: Buffer,
    pub(super) sums: Buffer,
    pub(super) boxes: Buffer,
}

impl Store {
    pub(super) fn new(
        gpu: &Gpu,
        dims: UVec3,
        channels: &[AttributeChannel],
        settings: &VoxelizerSettings,
        windows: Option<Windows>,
    ) -> Result<Self, GpuError> {
        let (slots, seen) = (u64::from(settings.bricks), u64::from(settings.bricks_in_view));
        let [table, headers, values] = match windows {
            Some(Windows(windows)) => windows,
            None => {
                let [table, headers, values] = sizes(dims, channels, settings);
                [
                    Buffer::storage(gpu, "bricks/table", table)?,
                    Buffer::storage(gpu, "bricks/headers", headers)?,
                    Buffer::storage(gpu, "bricks/values", values)?,
                ]
            }
        };
        let storage = |name: &str, words: u64| Buffer::storage(gpu, name, 4 * words);
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
        let store = Self {
            grid: Uniform::new(gpu, "bricks/grid", &bytemuck::Zeroable::zeroed()),
            bricks: Uniform::new(gpu, "bricks/window", &bytemuck::Zeroable::zeroed()),
            table,
            headers,
            lists: storage("bricks/lists", 3 * slots + seen)?,
            counters: storage("bricks/counters", COUNTERS)?,
            groups: Buffer::with_usage(gpu, "bricks/groups", 36, usage),
            values,
            shown: storage("bricks/shown", slots * BRICK_CELLS)?,
            sums: storage("bricks/sums", seen * BRICK_CELLS * sum_words(channels.len() as u64))?,
            boxes: storage("bricks/boxes", 8 * MOST_BOXES as u64)?,
        };
        // Low slots are given out first.
        let free: Vec<u32> = (0..settings.bricks).rev().collect();
        gpu.queue.write_buffer(&store.lists.raw, 8 * slots, bytemuck::cast_slice(&free));
        let mut counters = [0; COUNTERS as usize];
        counters[FREE] = settings.bricks;
        gpu.queue.write_buffer(&store.counters.raw, 0, bytemuck::cast_slice(&counters));
        Ok(store)
    }

    /// Writes the boxes and says how many there are.
    pub(super) fn set_boxes(&self, gpu: &Gpu, boxes: &[Bounds]) -> u32 {
        let all = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        let boxes = if boxes.len() > MOST_BOXES { std::slice::from_ref(&all) } else { boxes };
        let ends: Vec<Vec4> = boxes.iter().flat_map(|b| [b.min.extend(0.0), b.max.extend(0.0)]).collect();
        gpu.queue.write_buffer(&self.boxes.raw, 0, bytemuck::cast_slice(&ends));
        boxes.len() as u32
    }

    /// Bytes of all buffers.
    pub(super) fn bytes(&self) -> u64 {
        let Self { table, headers, lists, counters, groups, values, shown, sums, boxes, .. } = self;
        [table, headers, lists, counters, groups, values, shown, sums, boxes].iter().map(|b| b.size()).sum()
    }
}
