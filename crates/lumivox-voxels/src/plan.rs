//! How much memory a volume will take, before it is made.
//!
//! The cells of a surface grow with the square of the resolution. Those of a grid with cells eight times as large are
//! counted, which takes a moment, and multiplied by 64; on scans the result is within 5 % of the truth.

use lumivox_core::Grid;

use crate::sparse::{CELLS, Mask, SHIFT, SIDE, bricks_along};
use crate::{Channel, GridSpec, Model, SparseVolume, VoxelizeError, VoxelizeOptions, voxelize};

/// Bytes of a brick in a volume, with what finds it.
const BRICK_BYTES: u64 = size_of::<Mask>() as u64 + 20;
/// Cells of a surface in one brick, on average, where it passes straight through.
const CELLS_PER_BRICK: u64 = 48;

/// Bytes of a surface cell's values.
fn cell_bytes(channels: &[Channel]) -> u64 {
    channels.iter().map(|c| (c.components * c.format.bytes()) as u64).sum()
}

/// Finds out whether the volume that [`voxelize`] would make fits into the memory allowed.
///
/// # Errors
/// If it will not, with the numbers and about the largest grid that would, or if the grid is impossible.
pub fn check_memory(model: &Model<'_>, options: &VoxelizeOptions<'_>) -> Result<(), VoxelizeError> {
    let grid = options.grid.fit(&options.bounds.unwrap_or_else(|| model.bounds()))?;
    check(model, options, &grid)
}

/// An error if the volume of a grid will not fit into the memory allowed. Small grids are not looked at.
pub(crate) fn check(
    model: &Model<'_>,
    options: &VoxelizeOptions<'_>,
    grid: &Grid,
) -> Result<(), VoxelizeError> {
    let per_cell = cell_bytes(&options.channels);
    let bricks = bricks_along(grid.dims).as_u64vec3().element_product();
    if bricks * (BRICK_BYTES + CELLS as u64 * per_cell) <= options.memory_limit {
        return Ok(());
    }
    let coarse = Grid { cell_size: grid.cell_size * SIDE as f32, dims: bricks_along(grid.dims), ..*grid };
    let options_of_coarse = VoxelizeOptions {
        grid: GridSpec::Grid(coarse),
        channels: Vec::new(),
        memory_limit: u64::MAX,
        snap: 0.0,
        progress: None,
        ..options.clone()
    };
    let volume = voxelize(model, &options_of_coarse)?;
    let needed = bytes(&volume, per_cell, 1.0);
    if needed <= options.memory_limit {
        return Ok(());
    }
    let longest = grid.dims.max_element();
    let fits =
        |side: u32| bytes(&volume, per_cell, f64::from(side) / f64::from(longest)) <= options.memory_limit;
    let largest = (1..longest).rev().find(|&side| fits(side)).unwrap_or(1);
    Err(VoxelizeError::TooLarge {
        dims: grid.dims,
        needed,
        limit: options.memory_limit,
        largest: Some(largest),
    })
}

/// What a volume takes whose cells are `1 / (8 scale)` as large as those of `coarse`.
fn bytes(coarse: &SparseVolume, per_cell: u64, scale: f64) -> u64 {
    let square = scale * scale;
    let surface = (coarse.surface_len() << (2 * SHIFT)) as f64 * square;
    let inside = (coarse.len() - coarse.surface_len()) as f64 * square * scale;
    let bricks = surface / CELLS_PER_BRICK as f64 + inside;
    (bricks * BRICK_BYTES as f64 + surface * per_cell as f64) as u64
}
