//! Which cells a mesh marks, by definition.
//!
//! [`VoxelSet::of`] asks every triangle about every cell that its bounding box touches (and one more all round), in
//! `f64`, with the tests of [`overlap`]; nothing is incremental, so nothing can drift. With each verdict comes its
//! *margin*: would it be another if the cell were larger or smaller by a ten-thousandth of its size? Methods in `f32`
//! have to agree with the verdict only where it does not hang on such a hair.
//!
//! Time grows with the number of triangle/cell pairs; a mesh of 70 thousand triangles on 128 cells takes about a second.

pub mod difference;
pub mod overlap;

use std::sync::atomic::{AtomicU8, Ordering};

use glam::{DVec3, UVec3};
use lumivox_core::{Grid, TriangleView};
use rayon::prelude::*;

pub use difference::{DifferenceError, VoxelDifference};
pub use overlap::{Coverage, Verdict};

/// The cells that a mesh marks on a grid, each with its margin.
#[derive(Clone, Debug)]
pub struct VoxelSet {
    grid: Grid,
    marks: Vec<u8>,
}

const SURELY: u8 = 1;
const MARKED: u8 = 2;
const POSSIBLY: u8 = 4;

impl VoxelSet {
    /// How much a cell grows and shrinks to find the margin of its verdict, as a fraction of its size.
    pub const MARGIN: f64 = 1e-4;

    /// The cells of `grid` that `triangles` mark. Triangles with a coordinate that is not finite mark nothing.
    pub fn of(grid: Grid, triangles: TriangleView<'_>, coverage: Coverage) -> Self {
        Self::with_margin(grid, triangles, coverage, Self::MARGIN)
    }

    /// As [`Self::of`] with a margin of one's own, for methods that are known to be coarser than `f32`: a rasterizer
    /// snaps corners to 1/256 of a pixel.
    pub fn with_margin(grid: Grid, triangles: TriangleView<'_>, coverage: Coverage, margin: f64) -> Self {
        let marks: Vec<AtomicU8> = (0..grid.cell_count()).map(|_| AtomicU8::new(0)).collect();
        (0..triangles.len()).into_par_iter().for_each(|n| {
            let corners = triangles.triangle(n).map(|p| p.as_dvec3());
            let Some((low, high)) = touched_cells(&grid, &corners) else { return };
            for k in low.z..=high.z {
                for j in low.y..=high.y {
                    for i in low.x..=high.x {
                        let cell = UVec3::new(i, j, k);
                        let verdict = coverage.verdict(&grid, cell, &corners, margin);
                        let bits = [verdict.surely, verdict.marked, verdict.possibly]
                            .into_iter()
                            .zip([SURELY, MARKED, POSSIBLY])
                            .fold(0, |bits, (is, bit)| if is { bits | bit } else { bits });
                        if bits != 0 {
                            marks[grid.index(cell)].fetch_or(bits, Ordering::Relaxed);
                        }
                    }
                }
            }
        });
        Self { grid, marks: marks.into_iter().map(AtomicU8::into_inner).collect() }
    }

    /// The cells' grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Whether the mesh marks a cell.
    pub fn contains(&self, cell: UVec3) -> bool {
        self.marks[self.grid.index(cell)] & MARKED != 0
    }

    /// The verdict about a cell and its margin.
    pub fn verdict(&self, cell: UVec3) -> Verdict {
        self.verdict_at(self.grid.index(cell))
    }

    /// The verdict about the cell of a linear index.
    pub fn verdict_at(&self, index: usize) -> Verdict {
        let bits = self.marks[index];
        Verdict { surely: bits & SURELY != 0, marked: bits & MARKED != 0, possibly: bits & POSSIBLY != 0 }
    }

    /// Number of marked cells.
    pub fn len(&self) -> usize {
        self.marks.iter().filter(|&&bits| bits & MARKED != 0).count()
    }

    /// Whether no cell is marked.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The marked cells in the order of their linear index.
    pub fn cells(&self) -> impl Iterator<Item = UVec3> + '_ {
        self.grid.cells().filter(|&cell| self.contains(cell))
    }
}

/// The first and the last cell around a triangle, with one more all round, as far as they lie in the grid.
fn touched_cells(grid: &Grid, corners: &[DVec3; 3]) -> Option<(UVec3, UVec3)> {
    if !corners.iter().all(|c| c.is_finite()) {
        return None;
    }
    let in_cells = corners.map(|c| (c - grid.origin.as_dvec3()) / f64::from(grid.cell_size));
    let low = in_cells[0].min(in_cells[1]).min(in_cells[2]).floor() - 1.0;
    let high = in_cells[0].max(in_cells[1]).max(in_cells[2]).floor() + 1.0;
    let last = grid.dims.as_dvec3() - 1.0;
    if high.cmplt(DVec3::ZERO).any() || low.cmpgt(last).any() {
        return None;
    }
    Some((low.max(DVec3::ZERO).as_uvec3(), high.min(last).as_uvec3()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use glam::Vec3;
    use lumivox_core::Bounds;

    fn grid(n: u32) -> Grid {
        Grid::fit(&Bounds::new(Vec3::splat(-1.13), Vec3::splat(1.17)), n).unwrap()
    }

    /// Parity of the number of crossings of a ray with a closed mesh: whether a point lies inside.
    fn is_inside(mesh: TriangleView<'_>, point: DVec3) -> bool {
        // A direction without symmetry, so that no ray meets an edge.
        let direction = DVec3::new(0.613_71, 0.512_93, 0.600_17);
        let crossings = mesh.iter().filter(|corners| {
            let [a, b, c] = corners.map(|p| p.as_dvec3() - point);
            let volumes = [a.cross(b), b.cross(c), c.cross(a)].map(|n| n.dot(direction));
            let same_side = volumes.iter().all(|&v| v > 0.0) || volumes.iter().all(|&v| v < 0.0);
            let normal = (b - a).cross(c - a);
            same_side && normal.dot(a) / normal.dot(direction) > 0.0
        });
        crossings.count() % 2 == 1
    }

    #[test]
    fn every_cell_of_a_grid_gets_the_verdict_that_asking_all_triangles_gives() {
        let mesh = shapes::sphere(1.0, 2);
        let grid = grid(9);
        for coverage in [Coverage::Exact, Coverage::Thin, Coverage::Sampled] {
            let set = VoxelSet::of(grid, mesh.view(), coverage);
            for cell in grid.cells() {
                let all = mesh.view().iter().any(|t| {
                    coverage.verdict(&grid, cell, &t.map(|p| p.as_dvec3()), VoxelSet::MARGIN).marked
                });
                assert_eq!(set.contains(cell), all, "{coverage:?} {cell}");
            }
        }
    }

    #[test]
    fn thin_and_sampled_lie_inside_exact_and_margins_enclose_the_verdict() {
        let mesh = shapes::sphere(1.0, 3);
        let exact = VoxelSet::of(grid(24), mesh.view(), Coverage::Exact);
        for coverage in [Coverage::Exact, Coverage::Thin, Coverage::Sampled] {
            let set = VoxelSet::of(grid(24), mesh.view(), coverage);
            assert!(!set.is_empty());
            for cell in set.grid().cells() {
                let verdict = set.verdict(cell);
                assert!(!verdict.surely || verdict.marked);
                assert!(!verdict.marked || verdict.possibly);
                assert!(!verdict.marked || exact.contains(cell), "{coverage:?} {cell}");
            }
        }
    }

    /// The sets against ray parity: a cell the mesh does not touch lies wholly inside or wholly outside.
    #[test]
    fn no_unmarked_cell_has_points_on_both_sides() {
        let mesh = shapes::sphere(1.0, 2);
        let exact = VoxelSet::of(grid(16), mesh.view(), Coverage::Exact);
        let (mut inside, mut outside) = (0, 0);
        for cell in exact.grid().cells().filter(|&c| !exact.contains(c)) {
            let center = exact.grid().center(cell).as_dvec3();
            let half = 0.4999 * f64::from(exact.grid().cell_size);
            let here = is_inside(mesh.view(), center);
            for corner in 0..8 {
                let sign = |bit: i32| if corner >> bit & 1 == 1 { half } else { -half };
                let point = center + DVec3::new(sign(0), sign(1), sign(2));
                assert_eq!(is_inside(mesh.view(), point), here, "{cell}");
            }
            if here { inside += 1 } else { outside += 1 }
        }
        assert!(inside > 500 && outside > 500, "{inside} {outside}");
    }

    /// The same at the other end: each marked cell that the mesh cuts through has points on both sides.
    #[test]
    fn cells_with_points_on_both_sides_are_marked() {
        let mesh = shapes::sphere(1.0, 2);
        let exact = VoxelSet::of(grid(12), mesh.view(), Coverage::Exact);
        let mut cut = 0;
        for cell in exact.grid().cells() {
            let center = exact.grid().center(cell).as_dvec3();
            let half = 0.5 * f64::from(exact.grid().cell_size);
            let sides = (0..27).map(|n| {
                let at = |n: i32| f64::from(n % 3 - 1) * half;
                is_inside(mesh.view(), center + DVec3::new(at(n), at(n / 3), at(n / 9)))
            });
            let inside = sides.filter(|&s| s).count();
            if inside != 0 && inside != 27 {
                cut += 1;
                assert!(exact.contains(cell), "{cell}");
            }
        }
        assert!(cut > 300 && cut <= exact.len(), "{cut} of {}", exact.len());
    }

    /// Schwarz and Seidel's thin set is 6-separating: no path through faces of unmarked cells crosses the surface.
    #[test]
    fn thin_set_separates_inside_from_outside_through_faces() {
        let mesh = shapes::sphere(1.0, 3);
        let thin = VoxelSet::of(grid(20), mesh.view(), Coverage::Thin);
        let grid = *thin.grid();
        let free = |c: UVec3| !thin.contains(c);
        let side: Vec<bool> =
            grid.cells().map(|c| is_inside(mesh.view(), grid.center(c).as_dvec3())).collect();
        for cell in grid.cells().filter(|&c| free(c)) {
            for step in [UVec3::X, UVec3::Y, UVec3::Z] {
                let next = cell + step;
                if next.cmplt(grid.dims).all() && free(next) {
                    assert_eq!(side[grid.index(cell)], side[grid.index(next)], "{cell} {next}");
                }
            }
        }
        let exact = VoxelSet::of(grid, mesh.view(), Coverage::Exact);
        assert!((thin.len() as f64) < 0.75 * exact.len() as f64);
    }

    #[test]
    fn a_wall_on_a_cell_boundary_is_a_matter_of_margin_and_one_inside_is_not() {
        let grid = Grid::fit(&Bounds::new(Vec3::ZERO, Vec3::splat(4.0)), 4).unwrap();
        let wall = |y: f32| {
            let corners = [[-1.0, y, -1.0], [9.0, y, -1.0], [-1.0, y, 9.0]];
            (corners, [[0, 1, 2]])
        };
        let count = |y: f32, coverage| {
            let (positions, indices) = wall(y);
            let view = TriangleView::new(&positions, &indices).unwrap();
            let set = VoxelSet::of(grid, view, coverage);
            let unsure = grid.cells().filter(|&c| set.verdict(c).is_marginal()).count();
            (set.len(), unsure)
        };
        assert_eq!(count(2.0, Coverage::Exact), (32, 32));
        assert_eq!(count(2.0, Coverage::Thin), (32, 32));
        assert_eq!(count(2.0, Coverage::Sampled), (16, 32));
        for coverage in [Coverage::Exact, Coverage::Thin, Coverage::Sampled] {
            assert_eq!(count(2.5, coverage), (16, 0), "{coverage:?}");
        }
        assert_eq!(count(4.0, Coverage::Sampled).0, 16, "the grid owns its upper faces");
    }

    #[test]
    fn triangles_that_are_not_finite_or_outside_mark_nothing() {
        let positions = [[f32::NAN, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [9.0; 3], [9.0, 8.0, 9.0]];
        let view = TriangleView::new(&positions, &[[0, 1, 2], [3, 4, 3]]).unwrap();
        assert!(VoxelSet::of(grid(8), view, Coverage::Exact).is_empty());
    }
}
