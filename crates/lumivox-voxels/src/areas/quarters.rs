//! Areas of the parts of a triangle in four cells around an edge of the grid, which most small triangles reach: two
//! cuts, and the quarter that both cut off.

use glam::{DVec2, DVec3, IVec3};

use super::share_beyond;
use crate::coverage::{CellBox, Triangle};

/// Triangles that face an edge less than this, for their area, are not seen along it.
const FACING: f64 = 1e-3;

/// The shares of the four.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quarters {
    low: IVec3,
    /// The axes across the edge.
    axes: [usize; 2],
    /// Bit 0 of the number of a cell is set beyond the boundary across the first axis, bit 1 across the second.
    shares: [f64; 4],
}

impl Quarters {
    /// The shares of a triangle that reaches four such cells and touches `cells`, three or all of them; none if it is
    /// another triangle, or not all that it touches are there.
    #[inline]
    pub(super) fn of(triangle: &Triangle, normal: DVec3, cells: &[IVec3]) -> Option<Self> {
        let CellBox { low, high } = triangle.reach;
        let axes = match (high - low).to_array() {
            [0, 1, 1] => [1, 2],
            [1, 0, 1] => [2, 0],
            [1, 1, 0] => [0, 1],
            _ => return None,
        };
        let [p, q] = axes;
        let high = high.to_array();
        let beyond_p = share_beyond(triangle, p, high[p]);
        let beyond_q = share_beyond(triangle, q, high[q]);
        // A cell that is not marked has no share, and with it the others are known.
        let both =
            match 0b1111 & !cells.iter().fold(0u8, |marks, &cell| marks | 1 << number(cell - low, axes)) {
                0b1000 => 0.0,
                0b0010 => beyond_p,
                0b0100 => beyond_q,
                0b0001 => beyond_p + beyond_q - 1.0,
                0 => quarter_along(triangle, normal, 3 - p - q, [high[p], high[q]])?
                    .min(beyond_p.min(beyond_q))
                    .max(0.0),
                _ => return None,
            };
        let shares = [1.0 - beyond_p - beyond_q + both, beyond_p - both, beyond_q - both, both];
        Some(Self { low, axes, shares: shares.map(|share| share.max(0.0)) })
    }

    /// The share in one of the four.
    #[inline]
    pub(super) fn share(&self, cell: IVec3) -> f64 {
        self.shares[number(cell - self.low, self.axes) & 3]
    }
}

#[inline(always)]
fn number(cell: IVec3, [p, q]: [usize; 2]) -> usize {
    let cell = cell.to_array();
    (cell[p] | cell[q] << 1) as usize
}

/// The share of a triangle beyond both boundaries `high` of the two axes that follow `axis`; none if it does not face
/// `axis` well.
#[inline]
pub(super) fn quarter_along(triangle: &Triangle, normal: DVec3, axis: usize, high: [i32; 2]) -> Option<f64> {
    let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
    let edge = DVec2::new(f64::from(high[0]), f64::from(high[1]));
    let flat = |corner: &DVec3| {
        let corner: &[f64; 3] = corner.as_ref();
        DVec2::new(corner[p], corner[q]) - edge
    };
    let [a, b, c] = &triangle.corners;
    let facing = normal.to_array()[axis];
    let faces = facing.abs() > FACING * normal.abs().max_element();
    faces.then(|| 2.0 / facing * quarter([flat(a), flat(b), flat(c)]))
}

/// The area of a triangle where no coordinate is negative, with a sign: what lies there to the left of each edge
/// (Green's theorem).
fn quarter(corners: [DVec2; 3]) -> f64 {
    // Values are selected, and not branched to: nobody foresees on which side corners are.
    let above = |v: f64| if v > 0.0 { v } else { 0.0 };
    let [a, b, c] = corners;
    let edge = |from: DVec2, to: DVec2| {
        let way = to - from;
        // The part of the edge with y above zero.
        let (begin, end) = (above(from.y), above(to.y));
        let slope = way.x / way.y;
        let (first, last) = (from.x + (begin - from.y) * slope, to.x + (end - to.y) * slope);
        // The mean of x above zero there, whose integral is half of its square.
        let (near, far) = (above(first), above(last));
        let share = if first == last { 1.0 } else { (near - far) / (first - last) };
        let part = (end - begin) * (near + far) * share;
        // Also of edges along x.
        if begin == end { 0.0 } else { part }
    };
    0.5 * (edge(a, b) + edge(b, c) + edge(c, a))
}
