//! The sizes of the dispatches that go over surfels. There is room for many more than there are, and low places are given out first,
//! so the passes end with the highest place that was ever given out.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::wgsl::{FACE, GRID, OCTAHEDRON};

use super::{GatherUniform, SURFEL};

pub(super) const SHADER: Shader = Shader {
    name: "gather/dispatch",
    parts: &[GRID, FACE, OCTAHEDRON, SURFEL, include_str!("dispatch.wgsl")],
};

/// Where a dispatch over surfels finds its size, in bytes.
pub(super) const OVER_SURFELS: u64 = 0;
/// Where one over their rays does.
pub(super) const OVER_RAYS: u64 = 12;

#[derive(Debug)]
pub(super) struct Dispatch(ComputePass);

impl Dispatch {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(ComputePass::new(gpu, &SHADER, &[]))
    }

    /// A buffer for the sizes, with which nothing is dispatched.
    pub(super) fn sizes(gpu: &Gpu) -> Buffer {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST;
        Buffer::with_usage(gpu, "gather/dispatch", 24, usage)
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
