//! *Clipping*: a triangle is drawn whole into each slice that it meets, and fragments whose depth lies outside the slice are dropped.
//!
//! Source: *Two simple single-pass GPU methods for multi-channel surface voxelization of dynamic scenes* 3.2, Algorithm 2; dissertation 6.4.2,
//! Algorithm 6. Three sweeps by dominant normal, each triangle in one of them. What replaces the geometry shader is told in `raster/`.
//!
//! **Cells** are those of [`Coverage::Sampled`](super::Coverage::Sampled). Where faces of different axes meet, a path of face neighbours may lead through a closed
//! surface; through the cells of [slice per pass](super::slice_per_pass) none does.
//!
//! **Output vertices.** A triangle that meets `n` slices becomes `3 n` vertices. With a limit the higher slices are missing.
//!
//! **When.** Small triangles and few slices. A triangle that meets `n` slices makes `n` times the fragments of its area, and all but one in `n` are dropped:
//! one across a grid of 256 cells a side makes up to 17 million.

use super::raster::Geometry;

const NAMES: [&str; 3] = ["voxelize/clipping/count", "voxelize/clipping/plan", "voxelize/clipping/copies"];

/// The triangle for each slice.
pub(super) fn geometry(output_vertices: Option<u32>) -> Geometry {
    Geometry { names: NAMES, source: include_str!("copies.wgsl"), output_vertices }
}
