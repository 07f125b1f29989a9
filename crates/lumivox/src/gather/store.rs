//! All that gathered light keeps on the GPU.

use super::dispatch::Dispatch;
use super::due;
use super::sky_light::SkyLight;
use super::{GatherSettings, NO_SURFEL, SIDES};
use crate::gpu::{Buffer, Gpu, GpuError};
use crate::volume::{VolumeBuffer, check_grid};

/// Bytes of a cell in that table. The mask and the sub-cells have 8 each.
const TABLE_BYTES: u64 = 4 * SIDES as u64;
/// Bytes of the sub-cells of one cell.
const MASK_BYTES: u64 = 8;

/// All that is kept on the GPU.
#[derive(Debug)]
pub(super) struct Store {
    pub(super) subcells: Buffer,
    pub(super) mask: Buffer,
    pub(super) blocks: Buffer,
    pub(super) table: Buffer,
    pub(super) surfels: Buffer,
    pub(super) free_places: Buffer,
    pub(super) counts: Buffer,
    pub(super) dispatch: Buffer,
    pub(super) due: Buffer,
    pub(super) light: Buffer,
    pub(super) hits: Buffer,
    pub(super) sky: Buffer,
    pub(super) sky_light: Buffer,
    pub(super) shine: Buffer,
    pub(super) next_shine: Buffer,
    pub(super) smoothed: Buffer,
    pub(super) shown: Buffer,
}

impl Store {
    /// Buffers for a volume's cells and as many surfels as the settings want and the device has room for; and how many that is.
    pub(super) fn new(
        gpu: &Gpu,
        volume: &VolumeBuffer,
        settings: &GatherSettings,
    ) -> Result<(Self, u32), GpuError> {
        check_grid(gpu, "the table of surfels", volume.grid(), TABLE_BYTES)?;
        let cells = volume.grid().cell_count();
        let limits = gpu.device.limits();
        let room = limits.max_storage_buffer_binding_size / (4 * u64::from(settings.rays)).max(16);
        // Small grids have more surface for their cells.
        let usual = (2 * cells).max((6 * cells).min(65_536));
        let wanted = settings.surfels.map_or(usual, u64::from);
        let capacity = wanted.clamp(64, room.max(64));
        let blocks: u64 = volume.grid().dims.to_array().map(|n| u64::from(n.div_ceil(4))).iter().product();
        let make = |name: &str, bytes: u64| Buffer::storage(gpu, &format!("gather/{name}"), bytes);
        let store = Self {
            subcells: make("sub-cells", cells * MASK_BYTES)?,
            mask: make("mask", cells * MASK_BYTES)?,
            blocks: make("blocks", blocks * MASK_BYTES)?,
            table: make("table", cells * TABLE_BYTES)?,
            surfels: make("surfels", capacity * 16)?,
            free_places: make("free places", capacity * 4)?,
            counts: make("counts", 12)?,
            dispatch: Dispatch::sizes(gpu),
            due: make("due", due::HEADER_BYTES + capacity * due::ENTRY_BYTES)?,
            light: make("direct light", capacity * 16)?,
            hits: make("hits", capacity * 4 * u64::from(settings.rays))?,
            sky: SkyLight::squares(gpu)?,
            sky_light: make("sky light", capacity * 8)?,
            shine: make("shine", capacity * 16)?,
            next_shine: make("next shine", capacity * 16)?,
            smoothed: make("smoothed", capacity * 8)?,
            shown: make("shown", capacity * 16)?,
        };
        let capacity = capacity as u32;
        let write = |buffer: &Buffer, values: &[u32]| {
            gpu.queue.write_buffer(&buffer.raw, 0, bytemuck::cast_slice(values));
        };
        write(&store.table, &vec![NO_SURFEL; SIDES * cells as usize]);
        write(&store.surfels, &vec![NO_SURFEL; 4 * capacity as usize]);
        // Low places are given out first.
        write(&store.free_places, &(0..capacity).rev().collect::<Vec<_>>());
        write(&store.counts, &[capacity, 0, 0]);
        Ok((store, capacity))
    }
}
