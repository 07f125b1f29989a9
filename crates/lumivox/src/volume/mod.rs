//! The Volume Buffer: named channels over one grid, on the GPU, each kept twice for ping-pong.
//!
//! A channel is four half floats per cell, 8 bytes, packed into two words of a storage buffer; cell `(i, j, k)` is entry
//! `i + nx * (j + ny * k)`. A grid of 256 cells a side just fits the 128 MiB that core WebGPU binds.
//!
//! | channel | x y z | w |
//! | --- | --- | --- |
//! | [`NORMAL`] | mean surface normal (not unit: shorter where surfaces disagree) | occupancy, 0 or 1 |
//! | [`ALBEDO`] | mean reflectance, linear | 0 |
//! | [`EMISSION`] | mean emitted radiance, W/(m2 sr) | 0 |
//!
//! Sources: *Two simple single-pass GPU methods for multi-channel surface voxelization*, "Volume Buffer"; dissertation
//! 7.6, storage of N-dimensional attribute vectors as ceil(N / 4) four-channel textures, twice.

use glam::Vec4;
use half::f16;
use lumivox_core::{Grid, HostVolume};

use crate::gpu::{Buffer, Gpu, GpuError, Uniform, read_buffer};
use crate::wgsl::{GridUniform, HALF_MAX};

/// Mean normal and occupancy.
pub const NORMAL: &str = "normal";
/// Mean reflectance.
pub const ALBEDO: &str = "albedo";
/// Mean emitted radiance.
pub const EMISSION: &str = "emission";

/// Bytes of one cell of one channel.
pub const CHANNEL_BYTES: u64 = 8;

#[derive(Debug)]
struct Channel {
    name: &'static str,
    pair: [Buffer; 2],
}

/// Named channels over one grid with a current and a previous state.
#[derive(Debug)]
pub struct VolumeBuffer {
    grid: Grid,
    uniform: Uniform<GridUniform>,
    channels: Vec<Channel>,
    current: usize,
}

impl VolumeBuffer {
    /// An empty volume.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], with the largest cubic grid that would fit, when a channel exceeds what the device binds.
    pub fn new(gpu: &Gpu, grid: Grid, channels: &[&'static str]) -> Result<Self, GpuError> {
        check_grid(gpu, "a volume channel", &grid, CHANNEL_BYTES)?;
        let bytes = grid.cell_count() * CHANNEL_BYTES;
        let make = |name: &'static str| -> Result<Channel, GpuError> {
            let label = format!("volume/{name}");
            Ok(Channel {
                name,
                pair: [Buffer::storage(gpu, &label, bytes)?, Buffer::storage(gpu, &label, bytes)?],
            })
        };
        Ok(Self {
            grid,
            uniform: Uniform::new(gpu, "volume/grid", &GridUniform::from(&grid)),
            channels: channels.iter().map(|name| make(name)).collect::<Result<_, _>>()?,
            current: 0,
        })
    }

    /// The cells.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The grid as shaders see it.
    pub fn grid_uniform(&self) -> &Uniform<GridUniform> {
        &self.uniform
    }

    /// The current state of a channel.
    pub fn channel(&self, name: &str) -> Option<&Buffer> {
        self.channels.iter().find(|c| c.name == name).map(|c| &c.pair[self.current])
    }

    /// Current states to read and previous ones to write, in the order the channels were asked for: what a pass
    /// needs that rewrites the volume. Follow it with [`Self::swap`].
    pub fn ping_pong(&mut self) -> (&Uniform<GridUniform>, Vec<(&Buffer, &mut Buffer)>) {
        let current = self.current;
        let pairs = self.channels.iter_mut().map(|c| {
            let [a, b] = &mut c.pair;
            if current == 0 { (&*a, b) } else { (&*b, a) }
        });
        (&self.uniform, pairs.collect())
    }

    /// The current state of every channel, to write in place.
    pub fn current_mut(&mut self) -> (&Uniform<GridUniform>, Vec<&mut Buffer>) {
        let current = self.current;
        (&self.uniform, self.channels.iter_mut().map(|c| &mut c.pair[current]).collect())
    }

    /// Makes what was just written the current state.
    pub fn swap(&mut self) {
        self.current = 1 - self.current;
    }

    /// Records emptying the current state.
    pub fn record_clear(&mut self, encoder: &mut wgpu::CommandEncoder) {
        for channel in &self.channels {
            encoder.clear_buffer(&channel.pair[self.current].raw, 0, None);
        }
    }

    /// Replaces the current state of a channel with values from memory, one per cell. Not for use inside a frame.
    pub fn upload(&mut self, gpu: &Gpu, name: &str, values: &[Vec4]) -> Result<(), GpuError> {
        let packed: Vec<[f16; 4]> = values.iter().map(half4).collect();
        match self.channel(name) {
            Some(buffer) if buffer.size() == std::mem::size_of_val(packed.as_slice()) as u64 => {
                gpu.queue.write_buffer(&buffer.raw, 0, bytemuck::cast_slice(&packed));
                Ok(())
            }
            _ => Err(GpuError::Validation(format!("no channel {name} with {} cells", values.len()))),
        }
    }

    /// Reads the current state of every channel back. Waits; not for use inside a frame.
    pub fn read_back(&self, gpu: &Gpu) -> Result<HostVolume, GpuError> {
        let mut volume = HostVolume::new(self.grid);
        for channel in &self.channels {
            let packed: Vec<[f16; 4]> = read_buffer(gpu, &channel.pair[self.current])?;
            let values = packed.iter().map(|v| Vec4::from(v.map(f16::to_f32))).collect();
            volume.insert(channel.name, values);
        }
        Ok(volume)
    }
}

/// Half floats; what is larger becomes the largest, as in shaders.
pub(crate) fn half4(v: &Vec4) -> [f16; 4] {
    v.clamp(Vec4::splat(-HALF_MAX), Vec4::splat(HALF_MAX)).to_array().map(f16::from_f32)
}

/// Refuses a grid whose cells of `cell_bytes` do not fit into one binding, and says which cubic grid would.
pub(crate) fn check_grid(gpu: &Gpu, what: &str, grid: &Grid, cell_bytes: u64) -> Result<(), GpuError> {
    let limits = gpu.device.limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let side = ((limit / cell_bytes) as f64).cbrt() as u32;
    let [nx, ny, nz] = grid.dims.to_array();
    let hint =
        format!("; a grid of {nx} x {ny} x {nz} cells was asked for, {side} x {side} x {side} would fit");
    gpu.check_binding_size(what, grid.cell_count() * cell_bytes, &hint)
}
