//! Which cells a triangle marks.
//!
//! - [`Coverage::Exact`]: every cell that the closed triangle touches. No path of face, edge or corner neighbours leads
//!   through the cells of a closed surface (26-separating).
//! - [`Coverage::Thin`]: the 6-separating set of Schwarz and Seidel, *Fast parallel surface and solid voxelization on
//!   GPUs* (2010), section 3.2: no path of face neighbours leads through. About 0.6 times as many cells.
//! - [`Coverage::Sampled`]: along the axis that the triangle faces most, the cells that the lines through the centres of
//!   the grid's columns pierce; what a rasterizer with one sample per pixel gives. Slivers and dust leave gaps.
//!
//! `sampled` and `thin` lie inside `exact`.
//!
//! **Boundaries.** Cells are half-open: along an axis a triangle marks the cells from `floor(min)` to `floor(max)` of its
//! own coordinates. A wall that lies on a cell boundary marks the cells above it alone, and on the grid's upper face the
//! last cells. Between these bounds all tests are closed, with a slack of 1e-9 cells, so that no crack opens where a
//! triangle passes exactly through corners of cells.

mod exact;
mod overlap;
mod sampled;
mod thin;
mod triangle;

use glam::{DVec3, IVec3};

use exact::Exact;
pub(crate) use sampled::sample;
pub(crate) use triangle::{CellBox, Triangle, cell_of, dominant, is_inside, normal_of, onto_rim};

/// Which cells a triangle marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coverage {
    /// Every cell that the triangle touches: 26-separating.
    #[default]
    Exact,
    /// Schwarz and Seidel's 6-separating set.
    Thin,
    /// One cell per column of the dominant axis.
    Sampled,
}

/// Calls `mark` for each cell of `within` that the triangle marks.
#[inline(always)]
pub(crate) fn walk(coverage: Coverage, triangle: &Triangle, within: &CellBox, mark: &mut impl FnMut(IVec3)) {
    walk_facing(coverage, triangle, || triangle.normal(), within, mark);
}

/// The same for a triangle whose normal is there.
#[inline(always)]
pub(crate) fn walk_facing(
    coverage: Coverage,
    triangle: &Triangle,
    normal: impl FnOnce() -> DVec3,
    within: &CellBox,
    mark: &mut impl FnMut(IVec3),
) {
    match coverage {
        Coverage::Exact => overlap::walk::<Exact>(triangle, normal, within, mark),
        Coverage::Thin => overlap::walk::<thin::Thin>(triangle, normal, within, mark),
        Coverage::Sampled => sampled::walk(triangle, within, mark),
    }
}
