//! Cells and areas of triangles in the four cells around an edge of the grid, or the eight around a corner of it, which
//! most small triangles reach: in closed form, and without asking cell by cell.
//!
//! Seen along an axis, such a triangle lies around a point, with something on both sides of both boundaries there. If the
//! point is in it, it touches all four quarters; else the edge that has the point on its outer side leaves out the
//! quarter that its normal points to, and that one alone. Of eight cells one more is left out by the plane: the one on
//! the other side of the corner.
//!
//! A quarter of a triangle around the point is made of triangles from the point to parts of edges: the boundaries point
//! to it, and add nothing (Green's theorem). Where a quarter is left out, two cuts tell as much. Of eight cells the same
//! is known for three pairs of boundaries, and the cell that the plane leaves out tells what is beyond all three.

use glam::{DVec2, DVec3, IVec3};

use crate::coverage::{CellBox, Triangle};
use crate::fragment::{least, most, share_above};
use crate::sparse::bits;

/// Lines and planes that pass the point nearer than this are left to others; twice an area, in cell faces. Tests are
/// closed, with a slack of some 1e-9.
const NEAR: f64 = 1e-7;
/// Triangles that face an axis less than this, for their area, are not cut as seen along it.
const FACING: f64 = 1e-3;

/// The cells of one triangle, and the areas in these.
#[derive(Clone, Debug, Default)]
pub(super) struct Corner {
    pub(super) cells: [IVec3; 8],
    pub(super) areas: [f64; 8],
    pub(super) len: usize,
}

impl Corner {
    /// Works out a triangle; false if it does not lie so, reaches beyond `within`, or passes the point closely.
    #[inline(never)]
    pub(super) fn run(
        &mut self,
        triangle: &Triangle,
        (normal, length): (DVec3, f64),
        within: &CellBox,
    ) -> bool {
        let CellBox { low, high } = triangle.reach;
        let is_inside = low.cmpge(within.low).all() && high.cmple(within.high).all();
        let extent = high - low;
        if !is_inside || extent.max_element() != 1 {
            return false;
        }
        let point = high.as_dvec3();
        let [a, b, c] = &triangle.corners;
        let corners = [*a - point, *b - point, *c - point];
        // Written out, since `map` is a call.
        let beyond = |axis: usize| share_above(corners[0][axis], corners[1][axis], corners[2][axis]);
        let around = Around { corners, normal, cuts: [beyond(0), beyond(1), beyond(2)] };
        let found = match extent.to_array() {
            [0, 1, 1] => around.four::<0>(),
            [1, 0, 1] => around.four::<1>(),
            [1, 1, 0] => around.four::<2>(),
            [1, 1, 1] => around.eight(),
            _ => None,
        };
        let Some((touched, shares)) = found else { return false };
        self.len = 0;
        for cell in bits(u64::from(touched)) {
            let n = self.len & 7;
            let (x, y, z) = (cell & 1, cell >> 1 & 1, cell >> 2 & 1);
            self.cells[n] = low + IVec3::new(x as i32, y as i32, z as i32);
            self.areas[n] = 0.5 * length * most(shares[cell & 7], 0.0);
            self.len = n + 1;
        }
        true
    }
}

/// A triangle around the origin.
struct Around {
    corners: [DVec3; 3],
    normal: DVec3,
    /// The share of it beyond the boundary across each axis.
    cuts: [f64; 3],
}

/// The numbers of cells, bit 0 set beyond the boundary across x, bit 1 across y, and bit 2 across z.
type Cells = u8;

impl Around {
    /// The cells that it touches in the layer below the origin along `AXIS`, and its shares in them.
    #[inline(always)]
    fn four<const AXIS: usize>(&self) -> Option<(Cells, [f64; 8])> {
        let (p, q) = ((AXIS + 1) % 3, (AXIS + 2) % 3);
        let (free, both) = self.quarter::<AXIS>()?;
        let mut shares = [0.0; 8];
        shares[0] = 1.0 - self.cuts[p] - self.cuts[q] + both;
        shares[1 << p] = self.cuts[p] - both;
        shares[1 << q] = self.cuts[q] - both;
        shares[1 << p | 1 << q] = both;
        Some((BELOW[AXIS] & !free, shares))
    }

    /// The same of all eight.
    #[inline(always)]
    fn eight(&self) -> Option<(Cells, [f64; 8])> {
        let height = self.normal.dot(self.corners[0]);
        if height.abs() < NEAR {
            return None;
        }
        let (free_x, yz) = self.quarter::<0>()?;
        let (free_y, zx) = self.quarter::<1>()?;
        let (free_z, xy) = self.quarter::<2>()?;
        // The plane is on one side of the origin, and this cell on the other.
        let is_beyond = |axis: usize| u32::from((self.normal[axis] < 0.0) != (height < 0.0));
        let free = is_beyond(0) | is_beyond(1) << 1 | is_beyond(2) << 2;
        let [x, y, z] = self.cuts;
        // Parts beyond boundaries, less those beyond others, but for what is beyond all three.
        let shares = [1.0 - x - y - z + xy + yz + zx, x - xy - zx, y - xy - yz, xy, z - yz - zx, zx, yz, 0.0];
        let with_sign = |cell: u32, v: f64| if cell.count_ones() & 1 == 0 { v } else { -v };
        let missing = with_sign(free, -shares[free as usize & 7]);
        let mut all = [0.0; 8];
        for (cell, (all, share)) in all.iter_mut().zip(shares).enumerate() {
            *all = share + with_sign(cell as u32, missing);
        }
        Some((!(free_x | free_y | free_z | 1 << free), all))
    }

    /// As seen along an axis: the cells in the quarter that it leaves out, and the share of it beyond both boundaries.
    #[inline(always)]
    fn quarter<const AXIS: usize>(&self) -> Option<(Cells, f64)> {
        let (p, q) = ((AXIS + 1) % 3, (AXIS + 2) % 3);
        let flat = |corner: &DVec3| DVec2::new(corner[p], corner[q]);
        let [a, b, c] = &self.corners;
        let (a, b, c) = (flat(a), flat(b), flat(c));
        let turns = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
        if least(least(turns[0].abs(), turns[1].abs()), turns[2].abs()) < NEAR {
            return None;
        }
        let facing = self.normal[AXIS];
        let is_turned = facing < 0.0;
        let left_out = |turn: f64, from: DVec2, to: DVec2| {
            let is_outside = (turn < 0.0) != is_turned;
            let x = u32::from((to.y > from.y) != is_turned);
            let y = u32::from((to.x < from.x) != is_turned);
            u32::from(is_outside) << (x | y << 1)
        };
        let left_out = left_out(turns[0], a, b) | left_out(turns[1], b, c) | left_out(turns[2], c, a);
        let cells = COLUMNS[AXIS][left_out as usize & 15];
        let (beyond_p, beyond_q) = (self.cuts[p], self.cuts[q]);
        if left_out != 0 {
            let [of_p, of_q, of_all] = KNOWN[left_out as usize & 15];
            return Some((cells, of_p * beyond_p + of_q * beyond_q - of_all));
        }
        if facing.abs() <= FACING * self.normal.abs().max_element() {
            return None;
        }
        let sum = turns[0] * share_of(a, b) + turns[1] * share_of(b, c) + turns[2] * share_of(c, a);
        Some((0, least(sum / facing, least(beyond_p, beyond_q))))
    }
}

/// Cells below the boundaries across x, y and z.
const BELOW: [Cells; 3] = [0b0101_0101, 0b0011_0011, 0b0000_1111];

/// The two cells in a quarter, for each axis to look along and each bit of a quarter: bit 0 of its number is set beyond
/// the boundary across the next axis, bit 1 across the one after.
const COLUMNS: [[Cells; 16]; 3] = {
    let mut columns = [[0; 16]; 3];
    let mut n = 0;
    while n < 12 {
        let (axis, quarter) = (n / 4, n % 4);
        let cell = (quarter & 1) << ((axis + 1) % 3) | (quarter >> 1) << ((axis + 2) % 3);
        columns[axis][1 << quarter] = 1 << cell | 1 << (cell | 1 << axis);
        n += 1;
    }
    columns
};

/// For each bit of a quarter that is left out, what is beyond both boundaries: so many times what is beyond the first, and
/// the second, less so many times the whole.
const KNOWN: [[f64; 3]; 16] = {
    let mut known = [[0.0; 3]; 16];
    known[0b0001] = [1.0, 1.0, 1.0];
    known[0b0010] = [1.0, 0.0, 0.0];
    known[0b0100] = [0.0, 1.0, 0.0];
    known
};

/// The share of an edge where no coordinate is negative.
#[inline(always)]
fn share_of(from: DVec2, to: DVec2) -> f64 {
    // What is negative of a coordinate at both ends, in parts of the edge. If it is both, nothing remains between.
    let negative = |from: f64, to: f64| {
        let per_way = 1.0 / (from.abs() + to.abs());
        (most(-from, 0.0) * per_way, most(-to, 0.0) * per_way)
    };
    let ((x_begin, x_end), (y_begin, y_end)) = (negative(from.x, to.x), negative(from.y, to.y));
    most(1.0 - most(x_end, y_end) - most(x_begin, y_begin), 0.0)
}
