//! From meshes to a volume: the passes around a method.

use std::ops::Range;

use super::layer::{Layer, Windows};
use super::method::{self, Job, Options, Stages};
use super::text::{Layout, OUTPUT_NAMES, Phase, RESOLVE_OUTPUTS, merge_text, resolve_text};
use super::{Channel, Mesh, Rule, VoxelizeError};
use crate::gpu::{Bindings, Buffer, GeneratedPass, GeneratedText, Gpu, GpuError, Program};
use crate::volume::{ChannelFormat, VolumeBuffer};
use crate::wgsl::linear_groups;
use lumivox_core::Grid;

/// Turns meshes into the channels of volumes over one grid.
#[derive(Debug)]
pub struct Voxelizer {
    grid: Grid,
    /// Of the volumes that are filled: the first slab of layers.
    slab: Grid,
    layout: Layout,
    windows: Windows,
    /// One for each phase.
    stages: Vec<Box<dyn Stages>>,
    resolve: Vec<GeneratedPass>,
    merge: GeneratedPass,
    /// Sums of the window that is worked on; zero between recordings.
    working: Layer,
    /// A recording broke off: sums are not zero.
    is_dirty: bool,
    functions: Option<Functions>,
}

/// What functions of the host's bind.
#[derive(Debug)]
struct Functions {
    program: Program,
    group: Option<wgpu::BindGroup>,
}

impl Voxelizer {
    /// Compiles the stages, and makes room for sums: of a cell 8 bytes for each number that is averaged or summed and 4 for each
    /// other, and 8 more where anything is averaged; in all no more than the device binds, see the [module](super).
    ///
    /// # Errors
    /// When the occupancy of the grid or a channel does not fit the device (with the largest cube that would), when channels
    /// take more than [`MAX_CELL_BITS`](super::MAX_CELL_BITS), share a name or have a range without width, when a function is no valid WGSL, or when the
    /// method cannot do it.
    pub fn new(
        gpu: &Gpu,
        grid: Grid,
        channels: &[Channel],
        options: &Options,
    ) -> Result<Self, VoxelizeError> {
        Self::for_slabs(gpu, grid, grid.dims.z, channels, options)
    }

    /// As [`Self::new`], for a slab of `layers` along z at a time, the first ones at first: for grids that do not fit the device as a
    /// whole. Room and volumes are those of one slab, and [`Self::move_to_layer`] goes on to the next. The cells are those of the
    /// whole grid, however it is cut.
    ///
    /// # Errors
    /// As [`Self::new`], of a slab.
    pub fn for_slabs(
        gpu: &Gpu,
        grid: Grid,
        layers: u32,
        channels: &[Channel],
        options: &Options,
    ) -> Result<Self, VoxelizeError> {
        let layers = layers.clamp(1, grid.dims.z);
        let slab = Grid { dims: grid.dims.with_z(layers), ..grid };
        let face = grid.cell_size * grid.cell_size;
        let channels = channels.iter().map(|c| c.clone().fitted(face, options.see_through));
        let channels: Vec<Channel> = channels.collect();
        super::channel::check(&channels)?;
        method::check(&grid, &channels, options)?;
        for channel in &channels {
            crate::volume::check_grid(gpu, "a volume channel", &slab, channel.format.bytes())?;
        }
        let layout = Layout::new(&channels);
        let windows = Windows::new(gpu, &grid, 0..layers, &layout)?;
        let mut stages = vec![method::stages(gpu, &grid, &layout, options, Phase::Sums)?];
        if layout.has(Rule::Nearest) {
            stages.push(method::stages(gpu, &grid, &layout, options, Phase::Nearest)?);
        }
        let parts = 0..channels.len().div_ceil(RESOLVE_OUTPUTS);
        let resolve = parts.map(|part| GeneratedPass::new(gpu, &resolve_text(&layout, part)));
        Ok(Self {
            grid,
            slab,
            stages,
            resolve: resolve.collect::<Result<_, _>>()?,
            merge: GeneratedPass::new(gpu, &merge_text(&layout))?,
            working: Layer::new(gpu, &windows, true)?,
            is_dirty: false,
            functions: Functions::new(gpu, &layout)?,
            windows,
            layout,
        })
    }

    /// What the functions of channels bind in group 2. Before the first recording, and again when a resource is replaced.
    pub fn bind(&mut self, gpu: &Gpu, bindings: &Bindings<'_>) -> Result<(), GpuError> {
        if let Some(functions) = &mut self.functions {
            functions.group = Some(functions.program.bind(gpu, 2, bindings)?);
        }
        Ok(())
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The layers of cells along z that a recording fills the volume with: all of the grid, or a slab.
    pub fn layers(&self) -> Range<u32> {
        self.windows.layers.clone()
    }

    /// Goes on to the slab of layers that begins with `first`, from the next submission on: what was recorded for another slab must
    /// have been submitted. What the volume holds beyond the grid's last layer stays empty.
    pub fn move_to_layer(&mut self, gpu: &Gpu, first: u32) {
        let first = first.min(self.grid.dims.z - 1);
        self.windows.move_to(gpu, first..self.grid.dims.z.min(first + self.slab.dims.z));
    }

    /// How many passes over the triangles one recording takes: one for each window of cells whose sums fit the device, and as
    /// many again if a channel's rule is [`Rule::Nearest`].
    pub fn triangle_passes(&self) -> usize {
        self.windows.counts.len() * self.stages.len()
    }

    /// A volume of the channels, each kept once. Any other volume over the same grid will do that has channels of these names and
    /// as many words a cell, for example one made by [`VolumeBuffer::new`]. For slabs, its grid is that of the first; it serves for all.
    pub fn volume(&self, gpu: &Gpu) -> Result<VolumeBuffer, GpuError> {
        let formats: Vec<ChannelFormat> = self.layout.channels.iter().map(|c| c.format.clone()).collect();
        VolumeBuffer::with_formats(gpu, self.slab, &formats)
    }

    /// The cells that the last recording marked: bit `i % 32` of word `i / 32` for the cell of index `i`, counted from the first cell
    /// of the slab.
    pub fn occupancy(&self) -> &Buffer {
        &self.working.occupancy
    }

    /// Which cells of the slab the last recording marked, in the order of [`Grid::index`]. Waits; not for use inside a frame.
    pub fn read_occupancy(&self, gpu: &Gpu) -> Result<Vec<bool>, GpuError> {
        let words: Vec<u32> = crate::gpu::read_buffer(gpu, self.occupancy())?;
        let cells = self.slab.cell_count() as usize;
        Ok((0..cells).map(|i| words[i / 32] >> (i % 32) & 1 == 1).collect())
    }

    /// Room for the sums of some meshes, to be kept over frames and merged.
    pub fn layer(&self, gpu: &Gpu) -> Result<Layer, GpuError> {
        Layer::new(gpu, &self.windows, false)
    }

    /// Voxelizes meshes: the volume's channels hold what they mark, and zero elsewhere.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[&Mesh],
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.begin(gpu, encoder, volume)?;
        for window in 0..self.windows.counts.len() {
            self.accumulate(gpu, encoder, meshes, &self.working.groups[window], None)?;
            self.resolve(gpu, encoder, window, volume)?;
        }
        self.is_dirty = false;
        Ok(())
    }

    /// Voxelizes meshes into a layer, which holds what they mark and nothing else.
    pub fn record_layer(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[&Mesh],
        layer: &mut Layer,
    ) -> Result<(), GpuError> {
        self.record_layer_axis(gpu, encoder, meshes, layer, None)
    }

    pub(super) fn record_layer_axis(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[&Mesh],
        layer: &mut Layer,
        axis: Option<usize>,
    ) -> Result<(), GpuError> {
        self.check_layer(layer)?;
        layer.record_clear(encoder);
        layer.groups.iter().try_for_each(|groups| self.accumulate(gpu, encoder, meshes, groups, axis))
    }

    /// Makes the volume of several layers: the same as if the meshes of all had been voxelized at once.
    pub fn record_merge(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        layers: &[&Layer],
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        layers.iter().try_for_each(|layer| self.check_layer(layer))?;
        self.begin(gpu, encoder, volume)?;
        for window in 0..self.windows.counts.len() {
            let words = self.windows.counts[window].div_ceil(32);
            for layer in layers {
                let Layer { occupancy, sums, .. } = &mut self.working;
                let bindings = Bindings::new()
                    .read("window", &self.windows.uniforms[window][3])
                    .read("occupancy_in", &layer.occupancy)
                    .read("sums_in", &layer.sums[window])
                    .write("occupancy", occupancy)
                    .write("sums", &mut sums[0]);
                let group = self.merge.bind(gpu, 0, &bindings)?;
                dispatch(gpu, encoder, "voxelize/merge", &self.merge, &group, words)?;
            }
            self.resolve(gpu, encoder, window, volume)?;
        }
        self.is_dirty = false;
        Ok(())
    }

    /// Adds what meshes mark to occupancy and sums.
    fn accumulate(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        meshes: &[&Mesh],
        groups: &[wgpu::BindGroup; 4],
        axis: Option<usize>,
    ) -> Result<(), GpuError> {
        let functions = match &self.functions {
            Some(functions) => Some(functions.group.as_ref().ok_or_else(|| {
                wrong("voxelize/functions", "were not given what they bind: see Voxelizer::bind".to_owned())
            })?),
            None => None,
        };
        let job = Job { meshes, groups, functions, axis };
        self.stages.iter().try_for_each(|stages| stages.record(gpu, encoder, &job))
    }

    /// Empties the volume and what is worked in.
    fn begin(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        gpu.check()?;
        if volume.grid() != &self.slab {
            return Err(wrong("voxelize/resolve", "the volume is over another grid".to_owned()));
        }
        for Channel { format, .. } in &self.layout.channels {
            let fits = |f: &ChannelFormat| f.format == format.format && f.words() == format.words();
            if !volume.format(&format.name).is_some_and(fits) {
                let reason = format!("the volume has no channel {} like {format:?}", format.name);
                return Err(wrong("voxelize/resolve", reason));
            }
        }
        for (name, channel) in volume.named_mut() {
            if self.layout.channels.iter().any(|c| c.format.name == name) {
                encoder.clear_buffer(&channel.raw, 0, None);
            }
        }
        encoder.clear_buffer(&self.working.occupancy.raw, 0, None);
        if self.is_dirty {
            encoder.clear_buffer(&self.working.sums[0].raw, 0, None);
        }
        self.is_dirty = true;
        Ok(())
    }

    /// Sums of a window to values; leaves the sums zero.
    fn resolve(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        window: usize,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let words = self.windows.counts[window].div_ceil(32);
        let parts = self.layout.channels.chunks(RESOLVE_OUTPUTS);
        for (pass, channels) in self.resolve.iter().zip(parts) {
            let mut outputs: Vec<Option<&mut Buffer>> = channels.iter().map(|_| None).collect();
            for (name, buffer) in volume.named_mut() {
                if let Some(n) = channels.iter().position(|c| c.format.name == name) {
                    outputs[n] = Some(buffer);
                }
            }
            let Layer { occupancy, sums, .. } = &mut self.working;
            let mut bindings = Bindings::new()
                .read("window", &self.windows.uniforms[window][3])
                .read("occupancy", &*occupancy)
                .write("sums", &mut sums[0]);
            for (name, output) in OUTPUT_NAMES.into_iter().zip(outputs.into_iter().flatten()) {
                bindings = bindings.write(name, output);
            }
            let group = pass.bind(gpu, 0, &bindings)?;
            dispatch(gpu, encoder, "voxelize/resolve", pass, &group, words)?;
        }
        Ok(())
    }

    fn check_layer(&self, layer: &Layer) -> Result<(), GpuError> {
        let fits = layer.occupancy.size() == self.working.occupancy.size()
            && layer.sums.len() == self.windows.counts.len()
            && layer.sums[0].size() == self.working.sums[0].size();
        if fits {
            Ok(())
        } else {
            Err(wrong("voxelize/merge", "the layer is of another voxelizer".to_owned()))
        }
    }
}

impl Functions {
    fn new(gpu: &Gpu, layout: &Layout) -> Result<Option<Self>, GpuError> {
        let text = GeneratedText { name: "voxelize/functions", source: layout.function_text() };
        if text.bindings().is_empty() {
            return Ok(None);
        }
        Ok(Some(Self { program: Program::generated(gpu, &text)?, group: None }))
    }
}

fn dispatch(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    label: &'static str,
    pass: &GeneratedPass,
    group: &wgpu::BindGroup,
    count: u32,
) -> Result<(), GpuError> {
    gpu.check()?;
    let descriptor = wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes: None };
    let mut compute = encoder.begin_compute_pass(&descriptor);
    compute.set_pipeline(&pass.pipeline);
    compute.set_bind_group(0, group, &[]);
    let [x, y, z] = linear_groups(count);
    compute.dispatch_workgroups(x, y, z);
    Ok(())
}

fn wrong(pass: &'static str, reason: String) -> GpuError {
    GpuError::Binding { pass, reason }
}
