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
        "a cell size of {cell_size} m cuts the box {} .. {} into more than {} cells a side, or none; the smallest that would fit \
         is {} m",
        bounds.min, bounds.max, Grid::MAX_SIDE, bounds.size().max_element() / Grid::MAX_SIDE as f32
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
    /// A list has another length than the grid has cells.
    #[error("there are {found} values of {name} where the grid has {wanted} cells")]
    Length {
        /// What the list holds.
        name: String,
        /// Its length.
        found: u64,
        /// Cells of the grid.
        wanted: u64,
    },
    /// More triangles than 32 bits count.
    #[error("mesh {mesh} has {found} triangles, more than {}", u32::MAX)]
    TooManyTriangles {
        /// Number of the mesh in the model.
        mesh: usize,
        /// Its triangles.
        found: usize,
    },
    /// The volume would take more memory than allowed. Found out before the work where that can be known.
    #[error(
        "a grid of {} x {} x {} cells takes {} of memory or more, and {} are allowed; {}",
        dims.x, dims.y, dims.z, bytes(*needed), bytes(*limit), way_out(*largest)
    )]
    TooLarge {
        /// Cells along the axes.
        dims: UVec3,
        /// Bytes that it takes, as far as known.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
        /// Cells along the longest axis that would fit, about.
        largest: Option<u32>,
    },
    /// The progress callback asked to stop.
    #[error("cancelled")]
    Cancelled,
}

fn bytes(bytes: u64) -> String {
    const MIB: f64 = (1u64 << 20) as f64;
    format!("{:.1} MiB", bytes as f64 / MIB)
}

fn way_out(largest: Option<u32>) -> String {
    match largest {
        Some(cells) => format!("about {cells} cells along the longest axis would fit"),
        None => "take fewer cells or channels, or allow more".to_owned(),
    }
}
