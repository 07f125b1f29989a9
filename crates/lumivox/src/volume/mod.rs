//! The Volume Buffer: named channels over one grid, on the GPU.
//!
//! A channel has one to four numbers per cell in a [`Format`], packed into words of a storage buffer of its own; cell
//! `(i, j, k)` is entry `i + nx * (j + ny * k)`. What light works with are channels of four half floats, 8 bytes a cell, of
//! which a grid of 256 cells a side just fits the 128 MiB that core WebGPU binds:
//!
//! | channel | x y z | w |
//! | --- | --- | --- |
//! | [`NORMAL`] | mean surface normal (not unit: shorter where surfaces disagree) | occupancy, 0 or 1; between, a surface that lets light through |
//! | [`ALBEDO`] | mean reflectance, linear | 0 |
//! | [`EMISSION`] | mean emitted radiance, W/(m2 sr) | 0 |
//!
//! Channels made by [`VolumeBuffer::new`] are kept twice, for stages that read one state and write the next; those made by
//! [`VolumeBuffer::with_formats`] once.
//!
//! Sources: *Two simple single-pass GPU methods for multi-channel surface voxelization*, "Volume Buffer"; dissertation
//! 7.6, storage of N-dimensional attribute vectors as ceil(N / 4) four-channel textures, twice.

mod format;

use glam::Vec4;
use half::f16;
use lumivox_core::{Grid, HostVolume};

use crate::gpu::{Buffer, Gpu, GpuError, Uniform, read_buffer};
use crate::wgsl::{GridUniform, HALF_MAX};

pub use format::{ChannelFormat, Format};

/// Mean normal and occupancy.
pub const NORMAL: &str = "normal";
/// Mean reflectance.
pub const ALBEDO: &str = "albedo";
/// Mean emitted radiance.
pub const EMISSION: &str = "emission";

/// Bytes of one cell of a channel of four half floats.
pub const CHANNEL_BYTES: u64 = 8;

#[derive(Debug)]
struct Channel {
    format: ChannelFormat,
    /// The current state and, of channels kept twice, the other.
    states: Vec<Buffer>,
}

/// Named channels over one grid, with a current and perhaps a previous state.
#[derive(Debug)]
pub struct VolumeBuffer {
    grid: Grid,
    uniform: Uniform<GridUniform>,
    channels: Vec<Channel>,
}

impl VolumeBuffer {
    /// An empty volume of channels of four half floats, each kept twice for ping-pong.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], with the largest cubic grid that would fit, when a channel exceeds what the device binds.
    pub fn new(gpu: &Gpu, grid: Grid, channels: &[&'static str]) -> Result<Self, GpuError> {
        let formats: Vec<_> = channels.iter().map(|name| ChannelFormat::half4(name)).collect();
        Self::with_states(gpu, grid, &formats, 2)
    }

    /// An empty volume of any channels, each kept once.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_formats(gpu: &Gpu, grid: Grid, channels: &[ChannelFormat]) -> Result<Self, GpuError> {
        Self::with_states(gpu, grid, channels, 1)
    }

    fn with_states(
        gpu: &Gpu,
        grid: Grid,
        channels: &[ChannelFormat],
        states: usize,
    ) -> Result<Self, GpuError> {
        for channel in channels {
            check_grid(gpu, "a volume channel", &grid, channel.bytes())?;
        }
        let make = |format: &ChannelFormat| -> Result<Channel, GpuError> {
            let label = format!("volume/{}", format.name);
            let bytes = grid.cell_count() * format.bytes();
            let states = (0..states).map(|_| Buffer::storage(gpu, &label, bytes));
            Ok(Channel { format: format.clone(), states: states.collect::<Result<_, _>>()? })
        };
        Ok(Self {
            grid,
            uniform: Uniform::new(gpu, "volume/grid", &GridUniform::from(&grid)),
            channels: channels.iter().map(make).collect::<Result<_, _>>()?,
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
        self.find(name).and_then(|c| c.states.first())
    }

    /// How a channel is stored.
    pub fn format(&self, name: &str) -> Option<&ChannelFormat> {
        self.find(name).map(|c| &c.format)
    }

    fn find(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.format.name == name)
    }

    /// The current state of a channel that `pass` cannot do without.
    pub(crate) fn require(&self, pass: &'static str, name: &'static str) -> Result<&Buffer, GpuError> {
        let missing =
            || GpuError::Binding { pass, reason: format!("needs a volume with the channel {name}") };
        self.channel(name).ok_or_else(missing)
    }

    /// Current states to read and previous ones to write, in the order the channels were asked for: what a pass
    /// needs that rewrites the volume. Follow it with [`Self::swap`]. Channels that are kept once are left out.
    pub fn ping_pong(&mut self) -> (&Uniform<GridUniform>, Vec<(&Buffer, &mut Buffer)>) {
        let pairs = self.channels.iter_mut().filter_map(|c| match c.states.as_mut_slice() {
            [current, other, ..] => Some((&*current, other)),
            _ => None,
        });
        (&self.uniform, pairs.collect())
    }

    /// The current state of every channel, to write in place.
    pub fn current_mut(&mut self) -> (&Uniform<GridUniform>, Vec<&mut Buffer>) {
        let states = self.channels.iter_mut().filter_map(|c| c.states.first_mut());
        (&self.uniform, states.collect())
    }

    /// The current state of every channel by its name, to write in place.
    pub fn named_mut(&mut self) -> impl Iterator<Item = (&str, &mut Buffer)> {
        let states = self.channels.iter_mut();
        states.filter_map(|c| c.states.first_mut().map(|state| (c.format.name.as_str(), state)))
    }

    /// Makes what was just written the current state, of channels that are kept twice.
    pub fn swap(&mut self) {
        self.channels.iter_mut().for_each(|c| c.states.reverse());
    }

    /// Records emptying the current state.
    pub fn record_clear(&mut self, encoder: &mut wgpu::CommandEncoder) {
        for state in self.channels.iter().filter_map(|c| c.states.first()) {
            encoder.clear_buffer(&state.raw, 0, None);
        }
    }

    /// Replaces the current state of a channel of four half floats with values from memory, one per cell. Not for use inside a frame.
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
        for Channel { format, states } in &self.channels {
            let Some(state) = states.first() else { continue };
            let words: Vec<u32> = read_buffer(gpu, state)?;
            let values = words.chunks_exact(format.words() as usize).map(|cell| format.unpack(cell));
            volume.insert(&format.name, values.collect());
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
