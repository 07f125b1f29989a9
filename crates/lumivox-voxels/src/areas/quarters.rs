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
    /// The axes across the edge, and where it is.
    axes: [usize; 2],
    high: [i32; 2],
    /// By the second axis and by the first.
    shares: [[f64; 2]; 2],
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
        let high = [high[p], high[q]];
        let beyond_p = share_beyond(triangle, p, high[0]);
        let beyond_q = share_beyond(triangle, q, high[1]);
        // A cell that is not marked has no share, and with it the others are known.
        let sum = cells.iter().map(|cell| IVec3::new(cell[p] - high[0] + 1, cell[q] - high[1] + 1, 1));
        let both = match sum.sum::<IVec3>().to_array() {
            [1, 1, 3] => 0.0,
            [1, 2, 3] => beyond_p,
            [2, 1, 3] => beyond_q,
            [2, 2, 3] => beyond_p + beyond_q - 1.0,
            [2, 2, 4] => {
                quarter_along(triangle, normal, 3 - p - q, high)?.min(beyond_p.min(beyond_q)).max(0.0)
            }
            _ => return None,
        };
        let shares = [[1.0 - beyond_p - beyond_q + both, beyond_p - both], [beyond_q - both, both]];
        Some(Self { axes, high, shares: shares.map(|row| row.map(|share| share.max(0.0))) })
    }

    /// The share in one of the four.
    #[inline]
    pub(super) fn share(&self, cell: IVec3) -> f64 {
        let [p, q] = self.axes;
        self.shares[usize::from(cell[q] >= self.high[1])][usize::from(cell[p] >= self.high[0])]
    }
}

/// The share of a triangle beyond both boundaries `high` of the two axes that follow `axis`; none if it does not face
/// `axis` well.
#[inline]
pub(super) fn quarter_along(triangle: &Triangle, normal: DVec3, axis: usize, high: [i32; 2]) -> Option<f64> {
    let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
    let edge = DVec2::new(f64::from(high[0]), f64::from(high[1]));
    let flat = |corner: DVec3| DVec2::new(corner[p], corner[q]) - edge;
    let [a, b, c] = triangle.corners;
    let faces = normal[axis].abs() > FACING * normal.abs().max_element();
    faces.then(|| 2.0 / normal[axis] * quarter([flat(a), flat(b), flat(c)]))
}

/// The area of a triangle where no coordinate is negative, with a sign: what lies there to the left of each edge
/// (Green's theorem).
fn quarter(corners: [DVec2; 3]) -> f64 {
    let mut sum = 0.0;
    for n in 0..3 {
        let (from, to) = (corners[n], corners[(n + 1) % 3]);
        let way = to - from;
        // The part of the edge with y above zero, from `begin` to `end` in parts of it.
        let at_zero = (-from.y / way.y).clamp(0.0, 1.0);
        let (begin, end) = match (from.y >= 0.0, to.y >= 0.0) {
            (true, true) => (0.0, 1.0),
            (false, false) => continue,
            (true, false) => (0.0, at_zero),
            (false, true) => (at_zero, 1.0),
        };
        let (first, last) = (from.x + begin * way.x, from.x + end * way.x);
        // The mean of x above zero between the two.
        let mean = if first.min(last) >= 0.0 {
            0.5 * (first + last)
        } else {
            let (near, far) = (first.max(last), first.min(last));
            if near > 0.0 { 0.5 * near * near / (near - far) } else { 0.0 }
        };
        sum += (end - begin) * way.y * mean;
    }
    sum
}
