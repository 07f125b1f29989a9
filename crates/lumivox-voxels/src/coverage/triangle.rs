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

    /// The bricks, or pages of any other power of two, that hold the cells.
    pub(crate) fn coarser(&self, shift: u32) -> Self {
        Self { low: self.low >> shift as i32, high: self.high >> shift as i32 }
    }
}

/// A triangle in units of cells, with the cells around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    pub(crate) corners: [DVec3; 3],
    /// Cells along each axis that the triangle reaches, not cut off at the grid.
    pub(crate) reach: CellBox,
}

impl Triangle {
    /// A triangle on a grid of `dims` cells. `corners` must be finite.
    ///
    /// The grid owns its faces: corners up to `rim` cells outside are moved onto them. Rounding of a grid's origin and
    /// cell size would else lose the sides of the very box that it was fitted to.
    #[inline]
    pub(crate) fn new(corners: [DVec3; 3], dims: UVec3, rim: f64) -> Self {
        let n = dims.as_dvec3();
        let mut corners = corners;
        let mut low = corners[0].min(corners[1]).min(corners[2]);
        let mut high = corners[0].max(corners[1]).max(corners[2]);
        if low.cmplt(DVec3::ZERO).any() || high.cmpgt(n).any() {
            for corner in &mut corners {
                let onto = corner.clamp(DVec3::ZERO, n);
                let is_near = (*corner - onto).abs().cmple(DVec3::splat(rim));
                *corner = DVec3::select(is_near, onto, *corner);
            }
            low = corners[0].min(corners[1]).min(corners[2]);
            high = corners[0].max(corners[1]).max(corners[2]);
        }
        Self { corners, reach: CellBox { low: cell_of(low, n), high: cell_of(high, n) } }
    }

    /// The same triangle in units of `2^shift` cells.
    pub(crate) fn coarser(&self, shift: u32) -> Self {
        let scale = 1.0 / f64::from(1u32 << shift);
        Self { corners: self.corners.map(|c| scale * c), reach: self.reach.coarser(shift) }
    }

    pub(crate) fn edges(&self) -> [DVec3; 3] {
        let [a, b, c] = self.corners;
        [b - a, c - b, a - c]
    }

    /// A normal of twice the area's length; zero where the corners lie on a line but for rounding.
    pub(crate) fn normal(&self) -> DVec3 {
        let [e0, e1, e2] = self.edges();
        let normal = e0.cross(e1);
        let longest = e0.length_squared().max(e1.length_squared()).max(e2.length_squared());
        if normal.length_squared() <= 1e-24 * longest * longest { DVec3::ZERO } else { normal }
    }
}

/// The cell of a point; the upper faces of a grid of `n` cells belong to its last cells.
#[inline]
fn cell_of(point: DVec3, n: DVec3) -> IVec3 {
    let cell = IVec3::new(floor(point.x), floor(point.y), floor(point.z));
    cell - IVec3::new(i32::from(point.x == n.x), i32::from(point.y == n.y), i32::from(point.z == n.z))
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

/// A component of a vector.
#[inline]
pub(crate) fn axis(v: DVec3, a: usize) -> f64 {
    v[a]
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
        let dims = UVec3::splat(4);
        let wall = |x: f64| {
            let corners = [DVec3::new(x, 0.5, 0.5), DVec3::new(x, 1.5, 0.5), DVec3::new(x, 0.5, 1.5)];
            let reach = Triangle::new(corners, dims, 1e-4).reach;
            (reach.low.x, reach.high.x)
        };
        assert_eq!(wall(-5e-5), (0, 0));
        assert_eq!(wall(-5e-4), (-1, -1));
        assert_eq!(wall(1.0), (1, 1));
        assert_eq!(wall(4.0), (3, 3));
        assert_eq!(wall(4.000_05), (3, 3));
        assert_eq!(wall(4.000_5), (4, 4));
    }
}
