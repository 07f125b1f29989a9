//! Why there is no volume.

use glam::UVec3;
use lumivox_core::{Bounds, Grid, GridError};

/// Why a model cannot be voxelized.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VoxelizeError {
    /// The grid's box or resolution is not possible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// There is no triangle to fit a grid to.
    #[error("there is no triangle to voxelize")]
    Empty,
    /// A cell size that is not positive, or so small that the box needs too many cells.
    #[error(
        "a cell size of {cell_size} m cuts the box {} .. {} into more than {} cells a side, or none",
        bounds.min, bounds.max, Grid::MAX_SIDE
    )]
    CellSize {
        /// The cell size in metres.
        cell_size: f32,
        /// The box.
        bounds: Bounds,
    },
    /// Cells along an axis are zero or too many.
    #[error("a grid has 1 to {} cells along each axis, not {dims}", Grid::MAX_SIDE)]
    Dims {
        /// Cells asked for.
        dims: UVec3,
    },
    /// An attribute does not have one entry per vertex, or per triangle.
    #[error("mesh {mesh} has {fault}")]
    Mesh {
        /// Number of the mesh in the model.
        mesh: usize,
        /// What is wrong.
        fault: String,
    },
    /// More triangles than 32 bits count.
    #[error("mesh {mesh} has {found} triangles, more than {}", u32::MAX)]
    TooManyTriangles {
        /// Number of the mesh in the model.
        mesh: usize,
        /// Its triangles.
        found: usize,
    },
    /// The volume would take more memory than allowed.
    #[error(
        "a grid of {} x {} x {} cells takes more than the {limit} bytes that are allowed ({reached} with part of it done); \
         take fewer cells or channels, or allow more",
        dims.x, dims.y, dims.z
    )]
    TooLarge {
        /// Cells along the axes.
        dims: UVec3,
        /// Bytes in use when it was given up.
        reached: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The progress callback asked to stop.
    #[error("cancelled")]
    Cancelled,
}
