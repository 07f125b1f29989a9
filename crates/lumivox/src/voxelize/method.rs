//! What methods have in common, and what each of them must do.

use super::Mesh;
use super::direct::Direct;
use super::text::{Layout, Phase};
use crate::gpu::{Gpu, GpuError};
use lumivox_core::Grid;

/// Which cells a triangle marks; the cells are those of `lumivox-voxels` but for those whose verdict hangs on a
/// ten-thousandth of a cell.
///
/// **Boundaries.** Cells are half-open: along an axis a triangle marks the cells from `floor(min)` to `floor(max)` of its own
/// coordinates. A wall that lies on a cell boundary marks the cells above it alone, and on the grid's upper face the last
/// cells. Between these bounds tests are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coverage {
    /// Every cell that the closed triangle touches. No path of face, edge or corner neighbours leads through the cells of a
    /// closed surface (26-separating).
    #[default]
    Exact = 0,
    /// Schwarz and Seidel's set, through which no path of face neighbours leads (6-separating); about 0.6 times as many cells.
    Thin = 1,
    /// One cell per column along the axis that the triangle faces most, where the line through the column's centre meets
    /// it. Slivers and dust leave gaps.
    Sampled = 2,
}

/// How triangles become cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// One pass over the triangles, any coverage: see [`direct`](super::direct).
    #[default]
    Direct,
}

/// What a [`Voxelizer`](super::Voxelizer) is made for, beside its channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Which cells a triangle marks; methods that know only one take that.
    pub coverage: Coverage,
    /// By how many cells surfaces are moved against their visible side first, so that one on a cell boundary belongs to the
    /// cell behind it; pieces of less than a ten-thousandth of a cell face then do not count, unless the whole triangle is
    /// as small. Zero, or [`SURFACE_SHIFT`](crate::progressive::SURFACE_SHIFT) for volumes that views keep up too.
    pub shift: f32,
}

/// What one recording of a method is about.
pub(crate) struct Job<'a> {
    pub(crate) meshes: &'a [&'a Mesh],
    /// Group 0 for triangles that face x, y or z most, and for all.
    pub(crate) groups: &'a [wgpu::BindGroup; 4],
    /// Group 2, if functions bind anything.
    pub(crate) functions: Option<&'a wgpu::BindGroup>,
    /// Only triangles that face this axis most.
    pub(crate) axis: Option<usize>,
}

/// The stages of a method for one phase: from triangles to occupancy and sums.
pub(crate) trait Stages: std::fmt::Debug + Send + Sync {
    /// Records them. Nothing is cleared; what the meshes mark is added to what is there.
    fn record(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, job: &Job<'_>) -> Result<(), GpuError>;
}

/// Compiles the stages of a method.
pub(crate) fn stages(
    gpu: &Gpu,
    grid: &Grid,
    layout: &Layout,
    options: &Options,
    phase: Phase,
) -> Result<Box<dyn Stages>, GpuError> {
    match options.method {
        Method::Direct => Ok(Box::new(Direct::new(gpu, grid, layout, options, phase)?)),
    }
}
