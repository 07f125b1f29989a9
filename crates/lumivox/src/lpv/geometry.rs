//! The geometry volume of cascaded light propagation volumes: how much surface there is around each corner of the grid, and
//! which way it looks.
//!
//! Every point of a view is a small disc of the area that it stands for. In a cell of the geometry volume, which is half a
//! cell off the grid, discs add up to the *blocking potential* `B(w) = sum of area * max(0, n.w)` as spherical
//! harmonics, the share of light from direction `w` that is held back. Views see the same surfaces, so their potentials
//! are not added: of each corner the view counts that has seen the most surface there.

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::progressive::{SURFACE_SHIFT, ViewInput};
use crate::volume::VolumeBuffer;
use crate::wgsl::{GRID, PACK, POINT, SH, VIEW, VISIBILITY, linear_groups};

use super::{AREA, GEOMETRY};

/// Words of a corner's sums: area 1, area times normal 3, area times albedo 3.
const GEOMETRY_SUM_WORDS: u64 = 7;
/// Bytes of a corner's blockers: four coefficients of the potential, and albedo.
const GEOMETRY_BYTES: u64 = 16;
/// Fixed-point steps per cell face of surface. A sum has room for 64 faces.
const AREA_STEPS: f64 = (1u32 << 25) as f64;

pub(super) const INJECTION: Shader = Shader {
    name: "lpv/geometry injection",
    parts: &[GRID, VIEW, POINT, VISIBILITY, AREA, GEOMETRY, include_str!("geometry_injection.wgsl")],
};
pub(super) const RESOLVE: Shader = Shader {
    name: "lpv/geometry resolve",
    parts: &[GRID, PACK, SH, GEOMETRY, include_str!("geometry_resolve.wgsl")],
};

/// The stages that fill the geometry volume, and what they keep.
#[derive(Debug)]
pub(super) struct Geometry {
    injection: ComputePass,
    resolve: ComputePass,
    corners: u32,
    sums: Buffer,
    pub(super) blockers: Buffer,
}

impl Geometry {
    pub(super) fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        let corners: u64 = volume.grid().dims.to_array().map(|n| u64::from(n) + 1).iter().product();
        let words = GEOMETRY_SUM_WORDS as f64;
        let sums = [("AREA_STEPS", AREA_STEPS), ("GEOMETRY_SUM_WORDS", words)];
        let points = [sums[0], sums[1], ("SURFACE_SHIFT", SURFACE_SHIFT)];
        Ok(Self {
            injection: ComputePass::new(gpu, &INJECTION, &points),
            resolve: ComputePass::new(gpu, &RESOLVE, &sums),
            corners: corners as u32,
            sums: Buffer::storage(gpu, "lpv/geometry sums", corners * GEOMETRY_SUM_WORDS * 4)?,
            blockers: Buffer::storage(gpu, "lpv/geometry", corners * GEOMETRY_BYTES)?,
        })
    }

    /// No blockers.
    pub(super) fn record_clear(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.sums.raw, 0, None);
        encoder.clear_buffer(&self.blockers.raw, 0, None);
    }

    /// Adds what a view sees.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let points = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("albedo", &view.textures.albedo)
            .write("geometry_sums", &mut self.sums);
        self.injection.record(gpu, encoder, &points, linear_groups(view.point_count()))?;
        let sums = Bindings::new()
            .read("grid", volume.grid_uniform())
            .write("geometry_sums", &mut self.sums)
            .write("geometry", &mut self.blockers);
        self.resolve.record(gpu, encoder, &sums, linear_groups(self.corners))
    }
}
