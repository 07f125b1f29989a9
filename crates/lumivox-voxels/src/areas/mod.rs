//! Areas of the parts of a triangle in the cells that it marks.

mod corner;
mod outline;
mod sweep;
#[cfg(test)]
mod tests;

use glam::{DVec3, IVec3};

use crate::coverage::{self, CellBox, Coverage, Triangle, dominant};
use crate::fragment::share_above;
use corner::Corner;
use outline::Outline;
use sweep::Sweep;

/// Area of a triangle of this normal under one column of the axis that it faces most.
pub(crate) fn under_one_sample(normal: DVec3) -> f64 {
    let facing = normal[dominant(normal)].abs();
    if facing > 0.0 { normal.length() / facing } else { 0.0 }
}

/// Room for the parts of one triangle, which is used again for the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Areas {
    cells: Vec<IVec3>,
    /// The areas in these.
    found: Vec<f64>,
    sweep: Sweep,
    outline: Outline,
    corner: Corner,
}

impl Areas {
    /// Calls `add` for each cell of `within` that a triangle marks in exact or thin coverage, with the area in it.
    /// `normal` is square to the triangle and `length` long, twice its area. Work and memory grow with the cells of
    /// `within` around the triangle.
    #[inline(always)]
    pub(crate) fn for_each(
        &mut self,
        coverage: Coverage,
        triangle: &Triangle,
        (normal, length): (DVec3, f64),
        within: &CellBox,
        mut add: impl FnMut(IVec3, f64),
    ) {
        let CellBox { low, high } = triangle.reach;
        let extent = high - low;
        match extent.element_sum() {
            // Exact coverage has all cells in one line.
            0 if coverage == Coverage::Exact => {
                if within.contains(low) {
                    add(low, 0.5 * length);
                }
            }
            // Two cells: one cut.
            1 if coverage == Coverage::Exact => {
                let axis = usize::from(extent.y == 1) + 2 * usize::from(extent.z == 1);
                let above = share_beyond(triangle, axis, high.to_array()[axis]);
                for (cell, share) in [(low, 1.0 - above), (high, above)] {
                    if within.contains(cell) {
                        add(cell, share * (0.5 * length));
                    }
                }
            }
            _ => {
                let plane = (normal, length);
                let (cells, areas) =
                    if coverage == Coverage::Exact && self.corner.run(triangle, plane, within) {
                        let Corner { cells, areas, len } = &self.corner;
                        (&cells[..*len], &areas[..*len])
                    } else if coverage == Coverage::Exact && self.outline.run(triangle, plane, within) {
                        return self.outline.for_each(add);
                    } else {
                        self.list(coverage, triangle, plane, within);
                        (&self.cells[..], &self.found[..])
                    };
                cells.iter().zip(areas).for_each(|(&cell, &area)| add(cell, area));
            }
        }
    }

    /// Lists cells and areas. Not inlined: walks are long, and the code of small triangles has to stay near.
    #[inline(never)]
    fn list(
        &mut self,
        coverage: Coverage,
        triangle: &Triangle,
        (normal, length): (DVec3, f64),
        within: &CellBox,
    ) {
        let Self { cells, found, sweep, .. } = self;
        cells.clear();
        found.clear();
        if triangle.reach.intersection(within).is_empty() {
            return;
        }
        coverage::walk_facing(coverage, triangle, || normal, within, &mut |cell| cells.push(cell));
        sweep.run(triangle, (normal, length), within);
        found.extend(cells.iter().map(|&cell| sweep.area(cell)));
    }
}

/// The share of a triangle's area beyond the lower boundary of the cells `boundary` along an axis.
#[inline(always)]
fn share_beyond(triangle: &Triangle, axis: usize, boundary: i32) -> f64 {
    let [a, b, c]: [&[f64; 3]; 3] = triangle.corners.each_ref().map(|corner| corner.as_ref());
    let boundary = f64::from(boundary);
    share_above(a[axis] - boundary, b[axis] - boundary, c[axis] - boundary)
}
