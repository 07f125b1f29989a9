//! *Slicemap*: one pass along an axis, in which the depth of each fragment tells which bit of its column it sets.
//!
//! Source: Eisemann and Decoret, *Fast Scene Voxelization and Applications* (2006), the uniform slicemap of 2.2. The two-voxelizers paper and
//! dissertation 6.6 measure it from three directions, merged.
//!
//! They set bits by logical blending of up to four targets of 32 bits; here they are set by atomics in the grid's occupancy, so that there may be any number
//! of slices. There is a bit for a cell and no channels.
//!
//! **Cells.** A column marks the cell in which the line through its centre meets a triangle, whichever way it faces. From one direction, surfaces that rise by more
//! than a cell from one column to the next have gaps, and those that the direction lies in are missed. From three the cells are those of
//! [slice per pass](super::slice_per_pass).
//!
//! **When.** The least work of all, where occupancy is all that is wanted: one direction if gaps do no harm, three if surfaces must be whole.

use super::method::{Directions, Job, Options, Stages};
use super::raster::{Faces, Raster, axes, batches, draw_text};
use super::text::{Layout, Phase};
use crate::gpu::{GeneratedText, Gpu, GpuError};
use lumivox_core::Grid;

#[derive(Debug)]
pub(super) struct Slicemap {
    raster: Raster,
    directions: Directions,
}

impl Slicemap {
    pub(super) fn new(
        gpu: &Gpu,
        grid: &Grid,
        layout: &Layout,
        options: &Options,
        phase: Phase,
        directions: Directions,
    ) -> Result<Self, GpuError> {
        Ok(Self {
            raster: Raster::new(gpu, grid, |is_plain| text(layout, options, phase, is_plain))?,
            directions,
        })
    }
}

impl Stages for Slicemap {
    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, job: &Job<'_>) -> Result<(), GpuError> {
        gpu.check()?;
        let is_seen = |axis: &usize| match self.directions {
            Directions::Three => true,
            Directions::One(one) => one as usize == *axis,
        };
        for axis in axes(job).filter(is_seen) {
            let mut pass = self.raster.begin(encoder, job, axis, Faces::Every);
            for (mesh, batch, count) in batches(job) {
                pass.set_pipeline(self.raster.pipeline(mesh));
                pass.set_bind_group(1, batch, &[]);
                pass.draw(0..3 * count, axis as u32..axis as u32 + 1);
            }
        }
        Ok(())
    }
}

/// The text of the pass, for plain meshes or for all.
pub(super) fn text(layout: &Layout, options: &Options, phase: Phase, is_plain: bool) -> GeneratedText {
    let name = "voxelize/slicemap/depth";
    draw_text(name, (layout, options, phase), is_plain, Faces::Every, &[include_str!("depth.wgsl")])
}
