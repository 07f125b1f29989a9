//! How a grid is cut into slabs of layers, so that each fits the GPU's bindings and the memory that it comes back to.

use anyhow::{Result, bail};
use lumivox::gpu::Gpu;
use lumivox::voxelize::Channel;
use lumivox_core::Grid;

use super::report::sides;

/// Layers of a brick of the volume in memory; slabs of as many need no brick to wait for the next slab.
const BRICK: u64 = 8;
/// Larger slabs take more memory and save next to no time.
const LARGEST_SLAB: u64 = 512 << 20;

/// Bytes of one layer of cells.
struct LayerBytes {
    /// In the largest buffer on the GPU: bits, one channel, or the sums of all.
    largest: u64,
    /// In memory, while they are read back.
    read: u64,
}

impl LayerBytes {
    fn new(grid: &Grid, channels: &[Channel]) -> Self {
        let cells = u64::from(grid.dims.x) * u64::from(grid.dims.y);
        let bits = cells.div_ceil(8);
        let widths = || channels.iter().map(|channel| channel.stored().bytes());
        // A weight, and up to two words for each number.
        let numbers = channels.iter().map(|channel| u64::from(channel.stored().components));
        let sums = if channels.is_empty() { 0 } else { 12 + 8 * numbers.sum::<u64>() };
        let widest = widths().max().unwrap_or(0);
        Self {
            largest: bits.max(cells * widest.max(sums)),
            // What is read back is there three times for a moment.
            read: 3 * bits + cells * (widths().sum::<u64>() + 2 * widest),
        }
    }
}

/// Layers of a slab, of which a quarter of the memory holds what is read back.
pub(super) fn layers(gpu: &Gpu, grid: &Grid, channels: &[Channel], memory: u64) -> Result<u32> {
    let limits = gpu.device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    fitting(grid, channels, limit, memory)
}

fn fitting(grid: &Grid, channels: &[Channel], limit: u64, memory: u64) -> Result<u32> {
    let LayerBytes { largest, read } = LayerBytes::new(grid, channels);
    let most = (limit.min(LARGEST_SLAB) / largest).min(memory / 4 / read);
    let layers = if most >= BRICK { most / BRICK * BRICK } else { most };
    if layers == 0 {
        let kib = |bytes: u64| bytes.div_ceil(1 << 10);
        // Both grow with the square of the sides.
        let share = (limit as f64 / largest as f64).min(memory as f64 / (4 * read) as f64).sqrt();
        bail!(
            "one layer of a grid of {} cells takes {} KiB in a buffer of the GPU, which binds {}, and {} KiB of memory when it is read back, \
             a quarter of what --memory allows is {}; about {} cells along the longest axis would fit",
            sides(grid.dims),
            kib(largest),
            kib(limit),
            kib(read),
            kib(memory / 4),
            (share * f64::from(grid.dims.max_element())) as u32
        );
    }
    Ok(layers.min(u64::from(grid.dims.z)) as u32)
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};

    use super::*;

    fn grid(x: u32, y: u32, z: u32) -> Grid {
        Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::new(x, y, z) }
    }

    #[test]
    fn slabs_fit_the_binding_and_the_memory() {
        const CORE: u64 = 128 << 20;
        let both = [Channel::albedo(), Channel::normal()];
        // A bit a cell: all of 1024 x 1024 x 1024 in one binding, an eighth of 2048 x 2048 x 2048.
        assert_eq!(fitting(&grid(1024, 1024, 1024), &[], CORE, 8 << 30).unwrap(), 1024);
        assert_eq!(fitting(&grid(2048, 2048, 2048), &[], CORE, 8 << 30).unwrap(), 256);
        // 60 bytes of sums a cell.
        assert_eq!(fitting(&grid(512, 512, 300), &both, CORE, 8 << 30).unwrap(), 8);
        assert_eq!(fitting(&grid(1024, 512, 300), &both, CORE, 8 << 30).unwrap(), 4);
        assert_eq!(fitting(&grid(64, 64, 64), &both, CORE, 8 << 30).unwrap(), 64);
        let small = fitting(&grid(64, 64, 64), &both, CORE, 4 << 20).unwrap();
        assert!((1..64).contains(&small), "{small}");
        let error = fitting(&grid(2048, 2048, 8), &both, CORE, 1 << 20).unwrap_err().to_string();
        assert!(
            error.contains("2048 x 2048 x 8") && error.contains("131072") && error.contains("256"),
            "{error}"
        );
    }
}
