//! Cleanup (6.2.1, Listing 6.1; dissertation 7.4.1): what a depth image proves empty is cleared.
//!
//! The cell's centre is projected into the view. With `p` its distance along the view direction and `z` the distance of
//! what the depth image shows at that texel, the cell is cleared when `p < z - b`. The bias `b` is half the cell's extent
//! along the view's depth axis, `cell / 2 * (|dx| + |dy| + |dz|)` for the view direction `d`: 0.5 to 0.87 cell, the
//! "radius clamped by the voxel boundaries" of the text. The printed listing takes the distance between two opposite
//! corners moved by a radius instead, up to 3 cells, and leaves that much stale.
//!
//! Centres outside the view's frustum are kept. A texel on which nothing was drawn shows the far plane: what lies before it
//! is empty.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, VIEW, VISIBILITY, linear_groups};

use super::ViewInput;

pub(super) const SHADER: Shader = Shader {
    name: "progressive/cleanup",
    parts: &[GRID, VIEW, VISIBILITY, PACK, include_str!("cleanup.wgsl")],
};

#[derive(Debug)]
pub(super) struct Cleanup(ComputePass);

impl Cleanup {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        let groups = linear_groups(volume.grid().cell_count() as u32);
        let (grid, mut channels) = volume.ping_pong();
        let [normal, albedo, emission] = channels.as_mut_slice() else {
            return Err(super::resolve::wrong_channels(SHADER.name));
        };
        let bindings = Bindings::new()
            .read("grid", grid)
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal_in", normal.0)
            .read("albedo_in", albedo.0)
            .read("emission_in", emission.0)
            .write("normal_out", normal.1)
            .write("albedo_out", albedo.1)
            .write("emission_out", emission.1);
        self.0.record(gpu, encoder, &bindings, groups)?;
        volume.swap();
        Ok(())
    }
}
