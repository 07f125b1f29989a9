//! Sample points on the bounding sphere (dissertation 4.4.3): Slater's subdivision of an octahedron, and the way back
//! from any point of the sphere to the samples around it.
//!
//! A hemisphere whose sides are divided in `m` has `2 m^2 + 2 m + 1` points, and the equator occurs in both: 82, 290,
//! 1090, 4226 and 16642 points for `m` = 4, 8, 16, 32 and 64. (The text prints 80 for the first.) The pole is +Y.
//! Along its sides the points are evenly spaced; seen flat, each hemisphere is a diamond `|x| + |z| <= m`, numbered row
//! by row from `z = -m`.

mod inverse;
mod subdivision;

use glam::Vec3;

use crate::FieldError;
pub use inverse::Surrounding;
use inverse::Table;
use subdivision::Octant;

/// The numbers of points there are, both hemispheres together.
pub const POINT_COUNTS: [u32; 5] = [82, 290, 1090, 4226, 16642];

/// How many times more than in four an octant's side is halved for `count` points.
pub(crate) fn check_count(count: u32) -> Result<usize, FieldError> {
    POINT_COUNTS.iter().position(|&c| c == count).ok_or_else(|| FieldError::Unsupported {
        what: "number of points",
        given: count.to_string(),
        allowed: "82, 290, 1090, 4226 and 16642",
    })
}

/// Sample points on the unit sphere.
pub struct SpherePoints {
    octant: Octant,
    table: Table,
    positions: Vec<Vec3>,
    /// Numbers of the points with x = 0 of the upper hemisphere, from z = -m to m.
    rows: Vec<i32>,
}

impl SpherePoints {
    /// `count` points.
    ///
    /// # Errors
    /// [`FieldError::Unsupported`] for a number that is not one of [`POINT_COUNTS`].
    pub fn new(count: u32) -> Result<Self, FieldError> {
        let octant = Octant::new(4 << check_count(count)?);
        let m = octant.divisions as i32;
        let mut positions = Vec::with_capacity(count as usize);
        let mut rows = Vec::new();
        for up in [1.0f32, -1.0] {
            for z in -m..=m {
                let reach = m - z.abs();
                rows.push(positions.len() as i32 + reach);
                for x in -reach..=reach {
                    let p = octant.corner(x.unsigned_abs(), z.unsigned_abs());
                    // The sign of a zero height says which hemisphere an equator point belongs to.
                    positions.push(Vec3::new(p.x.copysign(x as f32), p.y * up, p.z.copysign(z as f32)));
                }
            }
        }
        // The rows of the lower hemisphere, pushed after those of the upper, are never looked up.
        Ok(Self { table: Table::new(&octant), octant, positions, rows })
    }

    /// Number of points.
    pub fn count(&self) -> u32 {
        self.positions.len() as u32
    }

    /// How often the side of an octant is divided.
    pub fn divisions(&self) -> u32 {
        self.octant.divisions
    }

    /// The points, unit vectors by number. Those of the lower hemisphere's equator have a height of -0.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Number of the point nearest to a direction, in constant time, by one look into a table. Where two points are
    /// about equally near it may be the farther one, by up to a quarter of the points' spacing; each point returns itself.
    /// The direction need not be unit; without a length it counts as the pole.
    #[inline(always)]
    pub fn nearest(&self, direction: Vec3) -> u32 {
        let [i, j] = self.table.nearest(direction.abs());
        self.number(direction, i, j)
    }

    /// The three points of the triangle around a direction, with weights that sum to one, in constant time.
    #[inline]
    pub fn surrounding(&self, direction: Vec3) -> Surrounding {
        let triangle = self.table.locate(&self.octant, direction.abs());
        let corners = triangle.corners();
        Surrounding {
            points: corners.map(|[i, j]| self.number(direction, i, j)),
            weights: triangle.weights(),
        }
    }

    /// The table of the inverse: cells along its side, and what each knows, as in
    /// [`PackedField::table`](lumivox_core::PackedField::table).
    pub(crate) fn table(&self) -> (u32, Vec<u32>) {
        (self.table.side(), self.table.cells().collect())
    }

    /// Number of a corner of the octant that `direction` lies in.
    #[inline(always)]
    fn number(&self, direction: Vec3, i: u32, j: u32) -> u32 {
        // Signs of directions are as good as random, so nothing here may branch on them.
        let signed = |n: u32, sign: f32| {
            let mask = (sign.to_bits() as i32) >> 31;
            (n as i32 ^ mask) - mask
        };
        let (x, z) = (signed(i, direction.x), signed(j, direction.z));
        let row = self.rows[(z + self.octant.divisions as i32) as usize];
        let lower = (direction.y.to_bits() >> 31) * (self.count() / 2);
        (lower as i32 + row + x) as u32
    }
}

#[cfg(test)]
mod tests;
