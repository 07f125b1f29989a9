//! *Slice per pass*: all triangles are drawn anew for each slice of each sweep, within a frustum one cell deep.
//!
//! Source: dissertation 5.5.1, Algorithm 4, the three-way voxelization; chapter 6 and the two-voxelizers paper measure it as the method of Fang and Chen
//! without XOR and with channels.
//!
//! **Cells.** Every sweep draws every triangle, whichever way it faces: a column of any axis marks the cell in which the line through its centre meets
//! the triangle. That is [`Coverage::Sampled`](super::Coverage::Sampled) and some per cent more, fewer on finer grids, all of them in
//! [`Coverage::Exact`](super::Coverage::Exact). No path of face neighbours leads through the cells of a closed surface: the line between two centres meets it in one of
//! the two cells. The three samples of a piece of surface share its area, so that sums are those of the surface.
//!
//! **When.** To compare. It needs no expansion and no memory, but looks at all triangles as many times as the grid has slices along its three axes.

use super::method::{Job, Options, Stages};
use super::raster::{Faces, Raster, axes, batches, draw_text};
use super::text::{Layout, Phase};
use crate::gpu::{GeneratedText, Gpu, GpuError};
use lumivox_core::Grid;

#[derive(Debug)]
pub(super) struct SlicePerPass {
    raster: Raster,
    grid: Grid,
}

impl SlicePerPass {
    pub(super) fn new(
        gpu: &Gpu,
        grid: &Grid,
        layout: &Layout,
        options: &Options,
        phase: Phase,
    ) -> Result<Self, GpuError> {
        Ok(Self {
            raster: Raster::new(gpu, grid, |is_plain| text(layout, options, phase, is_plain))?,
            grid: *grid,
        })
    }
}

impl Stages for SlicePerPass {
    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, job: &Job<'_>) -> Result<(), GpuError> {
        gpu.check()?;
        for axis in axes(job) {
            let mut pass = self.raster.begin(encoder, job, axis, Faces::Every);
            for slice in 0..self.grid.dims[axis] {
                let instance = 4 * slice + axis as u32;
                for (mesh, batch, count) in batches(job) {
                    pass.set_pipeline(self.raster.pipeline(mesh));
                    pass.set_bind_group(1, batch, &[]);
                    pass.draw(0..3 * count, instance..instance + 1);
                }
            }
        }
        Ok(())
    }
}

/// The text of a pass, for plain meshes or for all.
pub(super) fn text(layout: &Layout, options: &Options, phase: Phase, is_plain: bool) -> GeneratedText {
    let name = "voxelize/slice_per_pass/pass";
    draw_text(name, (layout, options, phase), is_plain, Faces::Every, &[include_str!("pass.wgsl")])
}
