//! Direct light, asked of a view at points of each surfel.
//!
//! A point is the middle of one of the surfel's sub-cells. Where the view sees a surface that faces the surfel's way, no farther
//! from the surfel's plane through the point than a sub-cell and a bit, and no farther from the point than its texel reaches along the
//! surface, it sees the surfel, and what it shows of it counts.

use crate::gpu::{Bindings, ComputePass, Gpu, GpuError, Shader, Uniform};
use crate::progressive::LightView;
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, OCTAHEDRON, PACK, VIEW, VISIBILITY};

use super::{GatherUniform, SURFEL, Store, TURN, dispatch};

pub(super) const SHADER: Shader = Shader {
    name: "gather/direct",
    parts: &[GRID, PACK, VIEW, VISIBILITY, OCTAHEDRON, SURFEL, TURN, include_str!("direct.wgsl")],
};

/// Cosine between the normals of a surfel and of what a view sees, from which both are one side of a surface.
const SAME_SIDE: f64 = 0.2;
/// Distance from the surfel's plane through a point, in sub-cells. A surface is up to 0.87 from the middle of its sub-cell.
const NEAR_PLANE: f64 = 2.0;
/// Distance from the point, in sub-cells, where a texel reaches less far: along the surface it is longer, in light that grazes it.
const NEAR_POINT: f64 = 6.0;

#[derive(Debug)]
pub(super) struct Direct(ComputePass);

impl Direct {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let constants = [("SAME_SIDE", SAME_SIDE), ("NEAR_PLANE", NEAR_PLANE), ("NEAR_POINT", NEAR_POINT)];
        Self(ComputePass::new(gpu, &SHADER, &constants))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: LightView<'_>,
        (volume, settings): (&VolumeBuffer, &Uniform<GatherUniform>),
        store: &mut Store,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", view.uniform)
            .read("settings", settings)
            .read("depth", view.depth)
            .read("normal", view.normal)
            .read("radiance", view.radiance)
            .read("surfels", &store.surfels)
            .read("due", &store.due)
            .write("light", &mut store.light);
        self.0.record_indirect(gpu, encoder, &bindings, &store.dispatch, dispatch::OVER_DUE)
    }
}
