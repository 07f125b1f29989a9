//! Sub-cells from views: cleanup and injection as of the volume's cells, four times as fine.
//!
//! A view's point marks the sub-cells of its cell that its tangent plane goes through, as far as half way to the next
//! points, so that a surface seen from afar has no holes. A sub-cell goes when its middle lies before what a view
//! sees by more than its reach, and in `mask` with its cell. Both cost what the surface costs, not what the volume does.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader};
use crate::progressive::{SURFACE_SHIFT, ViewInput};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, OCTAHEDRON, POINT, VIEW, VISIBILITY, linear_groups};

use super::{SURFEL, Store};

pub(super) const CLEANUP: Shader = Shader {
    name: "gather/view cleanup",
    parts: &[GRID, VIEW, VISIBILITY, OCTAHEDRON, SURFEL, include_str!("view_cleanup.wgsl")],
};
pub(super) const INJECTION: Shader = Shader {
    name: "gather/view injection",
    parts: &[GRID, VIEW, VISIBILITY, POINT, OCTAHEDRON, SURFEL, include_str!("view_injection.wgsl")],
};

#[derive(Debug)]
pub(super) struct ViewSubcells {
    cleanup: ComputePass,
    injection: ComputePass,
}

impl ViewSubcells {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            cleanup: ComputePass::new(gpu, &CLEANUP, &[]),
            injection: ComputePass::new(gpu, &INJECTION, &[("SURFACE_SHIFT", SURFACE_SHIFT)]),
        }
    }

    pub(super) fn record_cleanup(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .write("subcells", &mut store.subcells);
        self.cleanup.record(gpu, encoder, &bindings, linear_groups(volume.grid().cell_count() as u32))
    }

    pub(super) fn record_injection(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .write("subcells", &mut store.subcells);
        self.injection.record(gpu, encoder, &bindings, linear_groups(view.point_count()))
    }
}
