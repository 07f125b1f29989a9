//! What is wanted.

use std::ops::ControlFlow;

use glam::UVec3;
use lumivox_core::{Bounds, Grid};

use crate::{Channel, Coverage, VoxelizeError};

/// How the grid is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GridSpec {
    /// This many cells along the longest axis of the box, as many as needed along the others.
    Resolution(u32),
    /// Cells of this side in metres, as many as the box needs.
    CellSize(f32),
    /// This many cells along the axes, of the smallest size with which they hold the box; the grid starts at the box's
    /// corner and may reach beyond it.
    Dims(UVec3),
    /// This grid; the box is not looked at.
    Grid(Grid),
}

impl GridSpec {
    /// The grid for a box, with its corner at the box's.
    ///
    /// # Errors
    /// If the box is empty or the cells are none or more than [`Grid::MAX_SIDE`] a side.
    pub fn fit(&self, bounds: &Bounds) -> Result<Grid, VoxelizeError> {
        match *self {
            Self::Resolution(n) => Ok(Grid::fit(bounds, n)?),
            Self::CellSize(cell_size) => {
                // Checks the box, and that it has one.
                let origin = Grid::fit(bounds, 1)?.origin;
                // As `Grid::fit` has it: a hair above a whole number must not add a cell.
                let cells = (bounds.size() / cell_size - 1e-4).ceil().max(glam::Vec3::ONE);
                let fits = cell_size > 0.0 && cell_size.is_finite();
                if !fits || !cells.cmple(glam::Vec3::splat(Grid::MAX_SIDE as f32)).all() {
                    return Err(VoxelizeError::CellSize { cell_size, bounds: *bounds });
                }
                Ok(Grid { origin, cell_size, dims: cells.as_uvec3() })
            }
            Self::Dims(dims) => {
                check_dims(dims)?;
                let origin = Grid::fit(bounds, 1)?.origin;
                Ok(Grid { origin, cell_size: (bounds.size() / dims.as_vec3()).max_element(), dims })
            }
            Self::Grid(grid) => {
                check_dims(grid.dims)?;
                if !(grid.cell_size > 0.0 && grid.cell_size.is_finite() && grid.origin.is_finite()) {
                    return Err(VoxelizeError::CellSize { cell_size: grid.cell_size, bounds: grid.bounds() });
                }
                Ok(grid)
            }
        }
    }
}

fn check_dims(dims: UVec3) -> Result<(), VoxelizeError> {
    if dims.min_element() == 0 || dims.max_element() > Grid::MAX_SIDE {
        return Err(VoxelizeError::Dims { dims });
    }
    Ok(())
}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Triangles are sorted into bricks; counted in triangles.
    Binning,
    /// Cells and channels are worked out; counted in bricks.
    Cells,
    /// What the outside does not reach is filled; counted in bricks.
    Filling,
}

/// How far a stage is. `done` never goes down within a stage that runs once; very large models may go through binning
/// and cells several times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// What is done, in the stage's unit.
    pub done: u64,
    /// What there is to do.
    pub total: u64,
}

/// Told about progress, from any thread and at most a few thousand times; `Break` cancels.
pub type ProgressFn<'a> = dyn Fn(Progress) -> ControlFlow<()> + Sync + 'a;

/// What [`voxelize`](crate::voxelize) makes of a model.
#[derive(Clone)]
pub struct VoxelizeOptions<'a> {
    /// The grid.
    pub grid: GridSpec,
    /// The box to fit the grid to; without it the one around the model. Triangles outside the grid are cut off.
    pub bounds: Option<Bounds>,
    /// Which cells triangles mark.
    pub coverage: Coverage,
    /// What is stored beside occupancy.
    pub channels: Vec<Channel>,
    /// Whether the cells that no path of face neighbours leads to from outside are filled. They have no values.
    pub solid: bool,
    /// Corners this close to a cell boundary, in cells, are moved onto it: 1e-3 heals models whose faces miss the grid
    /// by rounding. Zero, the default, leaves all as it is.
    pub snap: f64,
    /// Most bytes that the volume, and the work on it, may take.
    pub memory_limit: u64,
    /// Told about progress.
    pub progress: Option<&'a ProgressFn<'a>>,
}

impl VoxelizeOptions<'_> {
    /// Exact coverage with this many cells along the longest axis, occupancy alone.
    pub fn resolution(cells: u32) -> Self {
        Self { grid: GridSpec::Resolution(cells), ..Self::default() }
    }
}

impl Default for VoxelizeOptions<'_> {
    /// 128 cells along the longest axis, exact coverage, occupancy alone, at most 8 GiB.
    fn default() -> Self {
        Self {
            grid: GridSpec::Resolution(128),
            bounds: None,
            coverage: Coverage::Exact,
            channels: Vec::new(),
            solid: false,
            snap: 0.0,
            memory_limit: 8 << 30,
            progress: None,
        }
    }
}

impl std::fmt::Debug for VoxelizeOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("VoxelizeOptions")
            .field("grid", &self.grid)
            .field("bounds", &self.bounds)
            .field("coverage", &self.coverage)
            .field("channels", &self.channels)
            .field("solid", &self.solid)
            .field("memory_limit", &self.memory_limit)
            .finish_non_exhaustive()
    }
}
