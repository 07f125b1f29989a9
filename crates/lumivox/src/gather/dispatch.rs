//! The sizes of the dispatches that go over surfels. There is room for many more than there are, and low places are given out first,
//! so the passes over all end with the highest place that was ever given out; those over surfels that are due with the last of
//! these.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{FACE, GRID, OCTAHEDRON};

use super::{GatherUniform, SURFEL};

pub(super) const SHADER: Shader = Shader {
    name: "gather/dispatch",
    parts: &[GRID, FACE, OCTAHEDRON, SURFEL, include_str!("dispatch.wgsl")],
};

/// Where a dispatch over all surfels finds its size, in bytes.
pub(super) const OVER_SURFELS: u64 = 0;
/// Where one over the surfels that are due does.
pub(super) const OVER_DUE: u64 = 12;
/// Where one over their rays does.
pub(super) const OVER_RAYS: u64 = 24;

#[derive(Debug)]
pub(super) struct Dispatch(ComputePass);

impl Dispatch {
    /// Over all surfels, by how far places have ever been given out.
    pub(super) fn over_surfels(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[("COUNT", 2.0), ("OF_DUE", 0.0)]))
    }

    /// Over those on the list of the ones that are due, and over their rays.
    pub(super) fn over_due(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[("COUNT", 0.0), ("OF_DUE", 1.0)]))
    }

    /// A buffer for the sizes, with which nothing is dispatched.
    pub(super) fn sizes(gpu: &Gpu) -> Buffer {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
        Buffer::with_usage(gpu, "gather/dispatch", 36, usage)
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        settings: &Uniform<GatherUniform>,
        counts: &Buffer,
        sizes: &mut Buffer,
    ) -> Result<(), GpuError> {
        let bindings =
            Bindings::new().read("settings", settings).read("counts", counts).write("workgroups", sizes);
        self.0.record(gpu, encoder, &bindings, [1, 1, 1])
    }
}
