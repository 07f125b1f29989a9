//! Where triangles are summed: a bit per cell, and the words of each cell's sums.

use std::ops::Range;

use super::text::{Layout, accumulators_layout};
use crate::gpu::{Buffer, Gpu, GpuError, Uniform, made_bind_group};
use crate::wgsl::GridUniform;
use lumivox_core::Grid;

crate::gpu_struct! {
    /// Cells whose sums are at hand, and the axis that triangles must face.
    pub struct WindowUniform {
        /// The first cell, counted from `base`.
        pub first: u32,
        /// How many.
        pub count: u32,
        /// Only triangles that face this axis most; 3 for all.
        pub axis: u32,
        /// The lowest layer of cells along z that the window reaches.
        pub first_layer: u32,
        /// The highest.
        pub last_layer: u32,
        /// The first cell that occupancy and volume hold.
        pub base: u32,
    }
}

/// The cells of a slab of a grid, cut into windows whose sums the device can bind.
#[derive(Debug)]
pub(super) struct Windows {
    pub(super) grid: Uniform<GridUniform>,
    /// Cells of one layer of the grid.
    layer: u64,
    /// Layers of the slab.
    pub(super) layers: Range<u32>,
    /// Per window: for triangles that face x, y, z, and for all.
    pub(super) uniforms: Vec<[Uniform<WindowUniform>; 4]>,
    /// Cells of each window; multiples of 32 but for the last.
    pub(super) counts: Vec<u32>,
    /// Cells of the largest window.
    at_once: u64,
    /// Bytes of the largest window's sums.
    sum_bytes: u64,
    occupancy_bytes: u64,
}

impl Windows {
    pub(super) fn new(gpu: &Gpu, grid: &Grid, layers: Range<u32>, layout: &Layout) -> Result<Self, GpuError> {
        let layer = u64::from(grid.dims.x) * u64::from(grid.dims.y);
        let cells = layer * layers.len() as u64;
        let occupancy_bytes = cells.div_ceil(32) * 4;
        let limits = gpu.device.limits();
        let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if occupancy_bytes > limit {
            let side = (8.0 * limit as f64).cbrt() as u32;
            let [nx, ny, nz] = grid.dims.with_z(layers.len() as u32).to_array();
            return Err(GpuError::TooLarge {
                what: "the occupancy of a volume".to_owned(),
                needed: occupancy_bytes,
                limit,
                hint: format!(
                    "; a grid of {nx} x {ny} x {nz} cells was asked for, {side} x {side} x {side} would fit"
                ),
            });
        }
        let cell_bytes = 4 * u64::from(layout.words);
        // Indices into sums are 32 bits too.
        let at_once = limit.checked_div(cell_bytes).map_or(cells, |fitting| fitting / 32 * 32).max(32);
        let mut windows = Self {
            grid: Uniform::new(gpu, "voxelize/grid", &GridUniform::from(grid)),
            layer,
            layers,
            uniforms: Vec::new(),
            counts: Vec::new(),
            at_once,
            sum_bytes: at_once.min(cells) * cell_bytes,
            occupancy_bytes,
        };
        let values = windows.values();
        windows.counts = values.iter().map(|value| value.count).collect();
        let uniform = |value: WindowUniform| {
            [0, 1, 2, 3].map(|axis| Uniform::new(gpu, "voxelize/window", &WindowUniform { axis, ..value }))
        };
        windows.uniforms = values.into_iter().map(uniform).collect();
        Ok(windows)
    }

    /// One after the other, for triangles that face any axis.
    fn values(&self) -> Vec<WindowUniform> {
        let cells = self.layer * self.layers.len() as u64;
        let value = |n: u64| {
            let first = n * self.at_once;
            let count = self.at_once.min(cells - first);
            WindowUniform {
                first: first as u32,
                count: count as u32,
                axis: 3,
                first_layer: self.layers.start + (first / self.layer) as u32,
                last_layer: self.layers.start + ((first + count - 1) / self.layer) as u32,
                base: (self.layer * u64::from(self.layers.start)) as u32,
            }
        };
        (0..cells.div_ceil(self.at_once)).map(value).collect()
    }

    /// Goes on to a slab with as many layers or fewer, from the next submission on.
    pub(super) fn move_to(&mut self, gpu: &Gpu, layers: Range<u32>) {
        self.layers = layers;
        let values = self.values();
        self.counts = values.iter().map(|value| value.count).collect();
        for (uniforms, value) in self.uniforms.iter().zip(values) {
            for (uniform, axis) in uniforms.iter().zip(0..) {
                uniform.write(gpu, &WindowUniform { axis, ..value });
            }
        }
    }
}

/// What some meshes leave in the cells, before it is resolved to values: the part of a scene that stands still, or that
/// moves. Made by [`Voxelizer::layer`](super::Voxelizer::layer).
#[derive(Debug)]
pub struct Layer {
    /// A bit per cell: bit `i % 32` of word `i / 32`.
    pub(super) occupancy: Buffer,
    /// The sums of each window, or of whichever window is worked on.
    pub(super) sums: Vec<Buffer>,
    /// Group 0 of methods, per window and axis.
    pub(super) groups: Vec<[wgpu::BindGroup; 4]>,
}

impl Layer {
    /// Room for the sums of all windows, or with `is_transient` of one at a time.
    pub(super) fn new(gpu: &Gpu, windows: &Windows, is_transient: bool) -> Result<Self, GpuError> {
        let occupancy = Buffer::storage(gpu, "voxelize/occupancy", windows.occupancy_bytes)?;
        let kept = if is_transient { 1 } else { windows.counts.len() };
        let sums = (0..kept).map(|_| Buffer::storage(gpu, "voxelize/sums", windows.sum_bytes));
        let sums = sums.collect::<Result<Vec<_>, _>>()?;
        let layout = accumulators_layout(gpu)?;
        let group = |n: usize, window: &Uniform<WindowUniform>| {
            let resources = [
                windows.grid.binding(),
                window.binding(),
                occupancy.binding(),
                sums[n.min(kept - 1)].binding(),
            ];
            let entries: Vec<_> = (0..)
                .zip(resources)
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            made_bind_group(gpu, "voxelize/accumulators", &layout, &entries)
        };
        let groups = windows
            .uniforms
            .iter()
            .enumerate()
            .map(|(n, [x, y, z, all])| Ok([group(n, x)?, group(n, y)?, group(n, z)?, group(n, all)?]));
        Ok(Self { groups: groups.collect::<Result<_, GpuError>>()?, occupancy, sums })
    }

    pub(super) fn record_clear(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.occupancy.raw, 0, None);
        self.sums.iter().for_each(|sums| encoder.clear_buffer(&sums.raw, 0, None));
    }
}
