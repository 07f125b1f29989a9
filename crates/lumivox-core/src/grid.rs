//! The one place that owns cell sizes, cell order and the way from a point to a cell.
//!
//! A grid is an axis-aligned box cut into cubic cells. Cells are half-open `[low, high)`, except that the grid owns
//! its upper faces: points on them belong to the last cell. Cell `(i, j, k)` has the linear index
//! `i + nx * (j + ny * k)`, in memory, on the GPU and in files.

use std::ops::RangeInclusive;

use glam::{UVec3, Vec3};

use crate::Bounds;

/// Why a grid cannot be made.
#[derive(Clone, Debug, PartialEq)]
pub enum GridError {
    /// The box is not finite, or its longest side is outside [`Grid::EXTENTS`].
    BadBounds(Bounds),
    /// The longest axis must have at least one cell and at most [`Grid::MAX_SIDE`].
    BadResolution(u32),
    /// With a margin of one cell on each side, fewer than three cells leave nothing inside.
    TooFewForMargin(u32),
}

impl std::fmt::Display for GridError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::BadBounds(b) => {
                let (from, to) = (Grid::EXTENTS.start(), Grid::EXTENTS.end());
                let (low, high) = (b.min.to_array(), b.max.to_array());
                write!(f, "a grid needs a box of {from:e} to {to:e} metres, not {low:?} to {high:?}")
            }
            Self::BadResolution(n) => {
                write!(f, "a grid needs 1 to {} cells along its longest axis, not {n}", Grid::MAX_SIDE)
            }
            Self::TooFewForMargin(n) => write!(
                f,
                "a grid with a margin needs 3 to {} cells along its longest axis, not {n}",
                Grid::MAX_SIDE
            ),
        }
    }
}

impl std::error::Error for GridError {}

/// An axis-aligned box cut into `dims` cubic cells of side `cell_size`, with its lowest corner at `origin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Lowest corner of cell `(0, 0, 0)`, in metres.
    pub origin: Vec3,
    /// Side of a cell in metres.
    pub cell_size: f32,
    /// Number of cells along x, y and z.
    pub dims: UVec3,
}

impl Grid {
    /// The most cells along one axis: the size limit of 3D textures in core WebGPU.
    pub const MAX_SIDE: u32 = 2048;
    /// The longest side of a box that is gridded, in metres. Beyond these, products of three lengths, as in the inverse of a
    /// view's matrix, are no single-precision numbers any more.
    pub const EXTENTS: RangeInclusive<f32> = 1e-9..=1e9;

    /// The tight grid of a box: `resolution` cells along the longest axis, as many as needed along the others,
    /// with the grid's corner at the box's.
    pub fn fit(bounds: &Bounds, resolution: u32) -> Result<Self, GridError> {
        Self::check(bounds, resolution)?;
        let size = bounds.size();
        let cell_size = size.max_element() / resolution as f32;
        // A whole number of cells may come out a few ulp above itself; that must not add a cell.
        let cells = |length: f32| ((length / cell_size - 1e-4).ceil()).max(1.0) as u32;
        Ok(Self {
            origin: bounds.min,
            cell_size,
            dims: UVec3::new(cells(size.x), cells(size.y), cells(size.z)),
        })
    }

    /// As [`Self::fit`], with one more cell on each side of every axis within the `resolution`, so that light can
    /// pass around what touches the bounds.
    pub fn fit_with_margin(bounds: &Bounds, resolution: u32) -> Result<Self, GridError> {
        if resolution < 3 {
            return Err(GridError::TooFewForMargin(resolution));
        }
        Self::check(bounds, resolution)?;
        let inner = Self::fit(bounds, resolution - 2)?;
        Ok(Self {
            origin: inner.origin - Vec3::splat(inner.cell_size),
            dims: inner.dims + UVec3::splat(2),
            ..inner
        })
    }

    fn check(bounds: &Bounds, resolution: u32) -> Result<(), GridError> {
        let size = bounds.size();
        let finite = bounds.min.is_finite() && bounds.max.is_finite();
        if !(finite && Self::EXTENTS.contains(&size.max_element())) {
            return Err(GridError::BadBounds(*bounds));
        }
        if resolution == 0 || resolution > Self::MAX_SIDE {
            return Err(GridError::BadResolution(resolution));
        }
        Ok(())
    }

    /// Number of cells. 64-bit: a grid of 2048 cells a side has more than fit into 32 bits.
    pub fn cell_count(&self) -> u64 {
        u64::from(self.dims.x) * u64::from(self.dims.y) * u64::from(self.dims.z)
    }

    /// The box that the cells fill.
    pub fn bounds(&self) -> Bounds {
        Bounds::new(self.origin, self.origin + self.cell_size * self.dims.as_vec3())
    }

    /// A world point in units of cells from the grid's corner.
    pub fn grid_from_world(&self, world: Vec3) -> Vec3 {
        (world - self.origin) / self.cell_size
    }

    /// The cell that holds a world point, or none outside the grid.
    pub fn cell_from_world(&self, world: Vec3) -> Option<UVec3> {
        let p = self.grid_from_world(world);
        let n = self.dims.as_vec3();
        let inside = p.cmpge(Vec3::ZERO).all() && p.cmple(n).all();
        inside.then(|| p.floor().min(n - Vec3::ONE).as_uvec3())
    }

    /// Linear index of a cell.
    pub fn index(&self, cell: UVec3) -> usize {
        let n = self.dims.as_u64vec3();
        let c = cell.as_u64vec3();
        (c.x + n.x * (c.y + n.y * c.z)) as usize
    }

    /// The cell of a linear index.
    pub fn cell(&self, index: usize) -> UVec3 {
        let (nx, ny) = (self.dims.x as usize, self.dims.y as usize);
        UVec3::new((index % nx) as u32, (index / nx % ny) as u32, (index / (nx * ny)) as u32)
    }

    /// Centre of a cell in the world.
    pub fn center(&self, cell: UVec3) -> Vec3 {
        self.origin + self.cell_size * (cell.as_vec3() + Vec3::splat(0.5))
    }

    /// All cells in the order of their linear index.
    pub fn cells(&self) -> impl Iterator<Item = UVec3> + use<> {
        let n = self.dims;
        (0..n.z).flat_map(move |k| (0..n.y).flat_map(move |j| (0..n.x).map(move |i| UVec3::new(i, j, k))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        Grid::fit(&Bounds::new(Vec3::ZERO, Vec3::new(4.0, 2.0, 1.0)), 8).unwrap()
    }

    #[test]
    fn longest_axis_has_the_resolution_and_the_others_what_they_need() {
        assert_eq!(grid().dims, UVec3::new(8, 4, 2));
        let odd = Grid::fit(&Bounds::new(Vec3::ZERO, Vec3::new(1.0, 0.31, 0.0)), 10).unwrap();
        assert_eq!(odd.dims, UVec3::new(10, 4, 1));
    }

    #[test]
    fn order_is_x_fastest_and_inverts() {
        let g = grid();
        for (n, c) in g.cells().enumerate() {
            assert_eq!((g.index(c), g.cell(n)), (n, c));
        }
        assert_eq!(g.cells().count() as u64, g.cell_count());
    }

    #[test]
    fn cells_are_half_open_but_the_grid_owns_its_upper_faces() {
        let g = grid();
        assert_eq!(g.cell_from_world(Vec3::new(0.5, 0.0, 0.0)), Some(UVec3::new(1, 0, 0)));
        assert_eq!(g.cell_from_world(Vec3::new(4.0, 2.0, 1.0)), Some(UVec3::new(7, 3, 1)));
        assert_eq!(g.cell_from_world(Vec3::new(4.001, 1.0, 0.5)), None);
        assert_eq!(g.cell_from_world(Vec3::new(-1e-6, 1.0, 0.5)), None);
        assert_eq!(g.cell_from_world(Vec3::NAN), None);
    }

    #[test]
    fn margin_adds_one_cell_all_round() {
        let b = Bounds::new(Vec3::ZERO, Vec3::new(4.0, 2.0, 1.0));
        let g = Grid::fit_with_margin(&b, 10).unwrap();
        assert_eq!(g.dims, UVec3::new(10, 6, 4));
        assert_eq!(g.cell_from_world(Vec3::ZERO), Some(UVec3::ONE));
    }

    #[test]
    fn refuses_what_is_no_box() {
        assert!(matches!(Grid::fit(&Bounds::EMPTY, 8), Err(GridError::BadBounds(_))));
        assert!(matches!(Grid::fit(&grid().bounds(), 0), Err(GridError::BadResolution(0))));
        assert!(matches!(Grid::fit(&grid().bounds(), 4000), Err(GridError::BadResolution(4000))));
        assert!(matches!(Grid::fit_with_margin(&grid().bounds(), 2), Err(GridError::TooFewForMargin(2))));
        assert!(matches!(Grid::fit_with_margin(&grid().bounds(), 2049), Err(GridError::BadResolution(2049))));
        let point = Bounds::new(Vec3::ONE, Vec3::ONE);
        assert!(matches!(Grid::fit(&point, 8), Err(GridError::BadBounds(_))));
        for (extent, fits) in [(0.9e-9, false), (1e-9, true), (1e9, true), (1.1e9, false), (f32::MAX, false)]
        {
            let bounds = Bounds::new(Vec3::ZERO, Vec3::new(0.0, extent, 0.0));
            assert_eq!(Grid::fit(&bounds, 8).is_ok(), fits, "{extent}");
        }
        let text = Grid::fit(&Bounds::new(Vec3::ZERO, Vec3::splat(1e30)), 8).unwrap_err().to_string();
        assert_eq!(
            text,
            "a grid needs a box of 1e-9 to 1e9 metres, not [0.0, 0.0, 0.0] to [1e30, 1e30, 1e30]"
        );
    }
}
