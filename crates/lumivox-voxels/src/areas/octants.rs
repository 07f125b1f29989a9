//! Areas of the parts of a triangle in eight cells around a corner of the grid: three cuts, what two of them cut off
//! together, and what cells that are not marked tell of the rest.

use glam::{DVec3, IVec3};

use super::quarters::quarter_along;
use super::share_beyond;
use crate::coverage::{CellBox, Triangle};

/// The shares of the eight: bit 0 of the number of a cell is set beyond the boundary across x, bit 1 across y, and bit 2
/// across z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Octants {
    low: IVec3,
    shares: [f64; 8],
}

/// Cells below the boundaries across x, y and z.
const BELOW: [u8; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];

impl Octants {
    /// The shares of a triangle that reaches eight such cells and touches `cells` alone; none if it is another triangle,
    /// or too little is known of it.
    #[inline]
    pub(super) fn of(triangle: &Triangle, normal: DVec3, cells: &[IVec3]) -> Option<Self> {
        let CellBox { low, high } = triangle.reach;
        if high - low != IVec3::ONE {
            return None;
        }
        let boundaries = high.to_array();
        let free = !cells.iter().fold(0u8, |marks, &cell| marks | 1 << number(cell - low));
        // Of the triangle beyond each set of boundaries; first that beyond none and beyond one.
        let mut beyond = [0.0; 8];
        beyond[0] = 1.0;
        for axis in 0..3 {
            beyond[1 << axis] = share_beyond(triangle, axis, boundaries[axis]);
        }
        // Beyond two. Of one pair of axes this need not be known if there is a free cell on both sides along the third.
        let mut spare = None;
        for (axis, below) in BELOW.into_iter().enumerate() {
            let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
            let (beyond_p, beyond_q) = (beyond[1 << p], beyond[1 << q]);
            // Free columns, that is pairs of cells, by their lower cells.
            let columns = free & free >> (1 << axis) & below;
            let is_free = |cell: u8| columns >> cell & 1 == 1;
            let both = if is_free(1 << p | 1 << q) {
                0.0
            } else if is_free(1 << q) {
                beyond_q
            } else if is_free(1 << p) {
                beyond_p
            } else if is_free(0) {
                beyond_p + beyond_q - 1.0
            } else if spare.is_none() && free & below != 0 && free & !below != 0 {
                spare = Some(axis);
                0.0
            } else {
                quarter_along(triangle, normal, axis, [boundaries[p], boundaries[q]])?
                    .min(beyond_p.min(beyond_q))
                    .max(0.0)
            };
            beyond[1 << p | 1 << q] = both;
        }
        // From what is beyond boundaries to what is between them.
        let mut shares = beyond;
        for axis in 0..3 {
            for cell in (0..8).filter(|cell| cell >> axis & 1 == 0) {
                shares[cell] -= shares[cell | 1 << axis];
            }
        }
        // What is beyond all three is still missing, with a sign, in all of these; with a spare axis another number on
        // each side of it. Cells that are free tell it.
        let with_sign = |cell: u32, v: f64| if cell.count_ones() & 1 == 0 { v } else { -v };
        let missing = |side: u8| {
            let cell = (free & side).trailing_zeros();
            shares.get(cell as usize).map(|&share| with_sign(cell, -share))
        };
        let sides = match spare {
            Some(axis) => [(BELOW[axis], missing(BELOW[axis])?), (!BELOW[axis], missing(!BELOW[axis])?)],
            None => [(u8::MAX, missing(u8::MAX)?), (0, 0.0)],
        };
        for (side, missing) in sides {
            for cell in (0..8u32).filter(|cell| side >> cell & 1 == 1) {
                shares[cell as usize] += with_sign(cell, missing);
            }
        }
        Some(Self { low, shares: shares.map(|share| share.max(0.0)) })
    }

    /// The share in one of the eight.
    #[inline]
    pub(super) fn share(&self, cell: IVec3) -> f64 {
        self.shares[number(cell - self.low) & 7]
    }
}

#[inline(always)]
fn number(cell: IVec3) -> usize {
    (cell.x | cell.y << 1 | cell.z << 2) as usize
}
