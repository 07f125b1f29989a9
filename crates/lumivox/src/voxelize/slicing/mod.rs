//! *Slicing*: triangles are cut into strips, one for each slice that they meet, and each strip is drawn into its slice.
//!
//! Source: *Two simple single-pass GPU methods for multi-channel surface voxelization of dynamic scenes* 3.1, Algorithm 1; dissertation 6.4.1,
//! Algorithm 5. Three sweeps by dominant normal, each triangle in one of them, all six cases of a strip. What replaces the geometry shader is told
//! in `raster/`.
//!
//! **Cells** are those of [`Coverage::Sampled`](super::Coverage::Sampled). Where faces of different axes meet, a path of face neighbours may lead through a closed
//! surface; through the cells of [slice per pass](super::slice_per_pass) none does. The paper's strips differ from its clipped triangles in 0.15 % of the cells, by the
//! rasterizer's rounding; ours do not.
//!
//! **Output vertices.** As the paper counts them: a triangle that lies in one slice 3, a tip 3, a strip 4, in case F two strips; so that `n` slices
//! take `4 n - 2`, and 4 more in case F. With a limit, the strips after the last one that fits are missing; the lowest slices come first.
//!
//! **When.** Fragments are about as many as marked columns, so it is for large triangles that meet many slices; for small ones, which lie in one or two slices,
//! [clipping](super::Method::Clipping) makes the same fragments with less work for each vertex.

use super::raster::Geometry;

const NAMES: [&str; 3] = ["voxelize/slicing/count", "voxelize/slicing/plan", "voxelize/slicing/strips"];

/// The strips of triangles.
pub(super) fn geometry(output_vertices: Option<u32>) -> Geometry {
    Geometry { names: NAMES, source: include_str!("strips.wgsl"), output_vertices }
}
