//! A triangle in units of cells, and boxes of cells.

use glam::{DVec3, IVec3, UVec3};

/// Cells from `low` to `high`, both included; empty if `high < low` on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellBox {
    pub(crate) low: IVec3,
    pub(crate) high: IVec3,
}

impl CellBox {
    /// All cells of a grid.
    pub(crate) fn of_grid(dims: UVec3) -> Self {
        Self { low: IVec3::ZERO, high: dims.as_ivec3() - 1 }
    }

    pub(crate) fn intersection(&self, other: &Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.high.cmplt(self.low).any()
    }

    pub(crate) fn contains(&self, cell: IVec3) -> bool {
        cell.cmpge(self.low).all() && cell.cmple(self.high).all()
    }

    /// The bricks, or pages of any other power of two, that hold the cells.
    pub(crate) fn coarser(&self, shift: u32) -> Self {
        Self { low: self.low >> shift as i32, high: self.high >> shift as i32 }
    }

    /// The cells in bricks, or pages of any other power of two.
    pub(crate) fn finer(&self, shift: u32) -> Self {
        Self { low: self.low << shift as i32, high: ((self.high + 1) << shift as i32) - 1 }
    }
}

/// A triangle in units of cells, with the cells around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners: [DVec3; 3],
    /// Cells along each axis that the triangle reaches, as [`cell_of`] counts them.
    pub(crate) reach: CellBox,
}

impl Triangle {
    /// The same triangle in units of `2^shift` cells.
    pub(crate) fn coarser(&self, shift: u32) -> Self {
        let scale = 1.0 / f64::from(1u32 << shift);
        let [a, b, c] = self.corners;
        Self { corners: [scale * a, scale * b, scale * c], reach: self.reach.coarser(shift) }
    }

    #[cfg(test)]
    pub(crate) fn on_grid(corners: [DVec3; 3], dims: UVec3) -> Self {
        let cells = corners.map(|corner| cell_of(corner, dims.as_dvec3()));
        let reach =
            CellBox { low: cells[0].min(cells[1]).min(cells[2]), high: cells[0].max(cells[1]).max(cells[2]) };
        Self { corners, reach }
    }

    #[inline]
    pub(crate) fn edges(&self) -> [DVec3; 3] {
        let [a, b, c] = self.corners;
        [b - a, c - b, a - c]
    }

    /// A normal of twice the area's length; zero where the corners lie on a line but for rounding.
    #[inline]
    pub(crate) fn normal(&self) -> DVec3 {
        normal_of(self.corners)
    }
}

/// The normal of a triangle with these corners, as [`Triangle::normal`] has it.
#[inline]
pub(crate) fn normal_of([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (e0, e1, e2) = (b - a, c - b, a - c);
    let normal = e0.cross(e1);
    // One instruction each, where `f64::max` is several.
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    let longest = larger(larger(e0.length_squared(), e1.length_squared()), e2.length_squared());
    if normal.length_squared() <= 1e-24 * longest * longest { DVec3::ZERO } else { normal }
}

/// Whether a corner lies on a grid of `dims` cells, told by signs: what is not a number does, and minus zero does not.
#[inline(always)]
pub(crate) fn is_inside(corner: DVec3, dims: DVec3) -> bool {
    let sign = |v: DVec3| v.x.to_bits() | v.y.to_bits() | v.z.to_bits();
    (sign(corner) | sign(dims - corner)) as i64 >= 0
}

/// A corner on a grid of `dims` cells: the grid owns its faces, and corners up to `rim` cells outside are moved onto
/// them. Rounding of a grid's origin and cell size would else lose the sides of the very box that it was fitted to.
#[cold]
pub(crate) fn onto_rim(corner: DVec3, dims: DVec3, rim: f64) -> DVec3 {
    let onto = corner.max(DVec3::ZERO).min(dims);
    DVec3::select((corner - onto).abs().cmple(DVec3::splat(rim)), onto, corner)
}

/// The cell of a corner, one beyond the grid for all that lies outside. The upper faces of the grid belong to its last
/// cells.
///
/// Cutting off at one beyond keeps apart what is inside and what is not, so that a triangle that reaches into the grid
/// still shows on which axes it spans more than one cell.
#[inline]
pub(crate) fn cell_of(corner: DVec3, dims: DVec3) -> IVec3 {
    let along = |x: f64, n: f64| {
        if x >= 0.0 && x < n {
            x as i32
        } else if x == n {
            n as i32 - 1
        } else {
            floor(x.max(-1.0).min(n))
        }
    };
    IVec3::new(along(corner.x, dims.x), along(corner.y, dims.y), along(corner.z, dims.z))
}

/// `floor` as an integer, without the call that `f64::floor` is on older processors. Saturates.
#[inline]
pub(crate) fn floor(x: f64) -> i32 {
    let towards_zero = x as i32;
    towards_zero.saturating_sub(i32::from(f64::from(towards_zero) > x))
}

/// `ceil` as an integer. Saturates.
#[inline]
pub(crate) fn ceil(x: f64) -> i32 {
    let towards_zero = x as i32;
    towards_zero.saturating_add(i32::from(f64::from(towards_zero) < x))
}

/// The axis along which a vector is longest; the first of those that tie.
#[inline]
pub(crate) fn dominant(v: DVec3) -> usize {
    let length = v.abs();
    if length.x >= length.y && length.x >= length.z {
        0
    } else if length.y >= length.z {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_below_and_above() {
        for x in [-2.5, -2.0, -0.0, 0.3, 7.0, 7.999_999_999, 1e300, -1e300] {
            assert_eq!(f64::from(floor(x)), x.floor().clamp(i32::MIN.into(), i32::MAX.into()), "{x}");
            assert_eq!(f64::from(ceil(x)), x.ceil().clamp(i32::MIN.into(), i32::MAX.into()), "{x}");
        }
    }

    #[test]
    fn grids_own_their_faces_and_what_rounding_pushes_out() {
        let dims = DVec3::splat(4.0);
        let cell = |x: f64| cell_of(onto_rim(DVec3::new(x, 0.5, 3.5), dims, 1e-4), dims);
        for (x, expected) in
            [(-5e-5, 0), (-5e-4, -1), (-9.0, -1), (1.0, 1), (4.0, 3), (4.000_05, 3), (4.000_5, 4), (1e30, 4)]
        {
            assert_eq!(cell(x), IVec3::new(expected, 0, 3), "{x}");
        }
    }
}
