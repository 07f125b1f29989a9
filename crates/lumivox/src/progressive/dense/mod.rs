//! Progressive voxelization over all cells of a grid, with any channels, in either storage of the papers.
//!
//! Source: *Progressive Screen-Space Multichannel Surface Voxelization*, 6.4 and Figure 6.8; dissertation 7.6 and Figures 73 and
//! 74, which have the volume as 3D textures and unwrapped into 2D ones.
//!
//! | [`Storage`] | a channel is | cleanup | bytes of a cell and channel |
//! | --- | --- | --- | ---: |
//! | `Buffers` | a buffer of packed half floats, the unwrapped form | in place | 8 |
//! | `Textures` | a 3D texture | from one texture into another, since core WebGPU has none of half floats that a stage both reads and writes | 16 |
//!
//! Both hold the same numbers, bit by bit: values are rounded to half floats before they are stored. Textures are filtered by the
//! device's samplers and are not limited by what a binding may hold; buffers go on to propagation and gathering of light. Sums
//! of points are integers that invocations add to, so they lie in a buffer with either storage, `16 n + 4` bytes a cell for `n`
//! channels.
//!
//! The cells are those of [`Progressive`](super::Progressive) and of [`ProgressiveVoxelizer`](super::ProgressiveVoxelizer), which
//! costs less where surfaces are thin in a large grid.

mod passes;
mod store;
mod text;

use lumivox_core::{Grid, HostVolume};

use crate::VolumeBuffer;
use crate::gpu::{Buffer, GeneratedText, Gpu, GpuError, Texture};
use crate::volume::check_grid;

use super::channel::{self, AttributeChannel, AttributeKind, sum_words};
use super::{AttributeView, CleanupRule};
use passes::Passes;
use store::Store;

/// What a volume over all cells lies in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Storage {
    /// Storage buffers of packed half floats, one a channel.
    #[default]
    Buffers,
    /// 3D textures of half floats, two a channel.
    Textures,
}

/// A volume of any channels over all cells of a grid, kept up from views.
#[derive(Debug)]
pub struct DenseVoxelizer {
    grid: Grid,
    channels: Vec<AttributeChannel>,
    passes: Passes,
    store: Store,
    sums: Buffer,
}

impl DenseVoxelizer {
    /// An empty volume. The first channel holds normals: their fourth number says which cells are occupied.
    ///
    /// # Errors
    /// No channel or more than eight, a first one of another kind, a grid whose sums do not fit a binding (125 cells a side on
    /// the core tier with four channels), or whose sides exceed those of a 3D texture.
    pub fn new(
        gpu: &Gpu,
        grid: Grid,
        channels: &[AttributeChannel],
        storage: Storage,
        rule: CleanupRule,
    ) -> Result<Self, GpuError> {
        channel::check(channels)?;
        if channels[0].kind != AttributeKind::Normal {
            let reason = "the first channel of a volume over all cells holds normals".to_owned();
            return Err(GpuError::Validation(reason));
        }
        let cell_bytes = 4 * sum_words(channels.len() as u64);
        check_grid(gpu, "the sums of injected attributes", &grid, cell_bytes)?;
        Ok(Self {
            grid,
            channels: channels.to_vec(),
            passes: Passes::new(gpu, channels, storage, rule, grid.cell_count() as u32),
            store: Store::new(gpu, grid, channels, storage)?,
            sums: Buffer::storage(gpu, "dense/sums", cell_bytes * grid.cell_count())?,
        })
    }

    /// The cells.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The channels.
    pub fn channels(&self) -> &[AttributeChannel] {
        &self.channels
    }

    /// What it lies in.
    pub fn storage(&self) -> Storage {
        match self.store {
            Store::Buffers(_) => Storage::Buffers,
            Store::Textures { .. } => Storage::Textures,
        }
    }

    /// Bytes of the device's memory that it takes.
    pub fn bytes(&self) -> u64 {
        let states = if self.storage() == Storage::Textures { 2 } else { 1 };
        self.sums.size() + states * 8 * self.channels.len() as u64 * self.grid.cell_count()
    }

    /// The volume, if it lies in buffers.
    pub fn volume(&self) -> Option<&VolumeBuffer> {
        match &self.store {
            Store::Buffers(volume) => Some(volume),
            Store::Textures { .. } => None,
        }
    }

    /// The current 3D texture of each channel, if it lies in textures. They are others after each cleanup.
    pub fn textures(&self) -> Option<Vec<&Texture>> {
        match &self.store {
            Store::Buffers(_) => None,
            Store::Textures { current, .. } => Some(current.iter().collect()),
        }
    }

    /// Records a frame: every view cleans, in a turn of its own, then those that have surfaces inject them.
    ///
    /// # Errors
    /// A view whose pictures are not those of the channels, or a failure of the device.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: &[&AttributeView],
    ) -> Result<(), GpuError> {
        views.iter().try_for_each(|view| self.record_cleanup(gpu, encoder, view))?;
        self.record_injection(gpu, encoder, views)
    }

    /// Clears the cells that a view proves empty (6.2.1).
    pub fn record_cleanup(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &AttributeView,
    ) -> Result<(), GpuError> {
        self.passes.record_clean(gpu, encoder, view, &mut self.store)
    }

    /// Injects the surfaces of views (6.2.2): cells that points fall into take the means of their values.
    pub fn record_injection(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: &[&AttributeView],
    ) -> Result<(), GpuError> {
        let Some(any) = views.iter().find(|v| v.surfaces.is_some()) else { return Ok(()) };
        encoder.clear_buffer(&self.sums.raw, 0, None);
        for view in views {
            self.passes.record_add(gpu, encoder, view, &self.store, &mut self.sums)?;
        }
        self.passes.record_resolve(gpu, encoder, any, &mut self.store, &self.sums)
    }

    /// The volume in memory, with empty cells zero. Waits.
    pub fn read_back(&self, gpu: &Gpu) -> Result<HostVolume, GpuError> {
        self.store.read_back(gpu, &self.grid, &self.channels)
    }
}

/// The texts of some sets of channels.
pub(crate) fn texts() -> Vec<GeneratedText> {
    let mut texts = Vec::new();
    for channels in channel::examples() {
        texts.push(text::add(&channels));
        for storage in [Storage::Buffers, Storage::Textures] {
            for part in text::parts(channels.len()) {
                let rules = [CleanupRule::Center, CleanupRule::Footprint];
                texts.extend(rules.map(|rule| text::clean(storage, part.clone(), rule)));
                texts.push(text::resolve(&channels, storage, part));
            }
        }
    }
    texts
}
