//! From a direction to the triangle of the subdivision around it, in constant time.
//!
//! The directions of an octant, projected to the plane `x + y + z = 1`, are cut into square cells; each remembers the
//! triangle around its centre, and the corner nearest to that. The triangles are wider than the cells, so that at most a
//! few steps from triangle to triangle remain to the right one.

use glam::Vec3;

use super::Octant;

/// Three sample points and their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surrounding {
    /// Numbers of the points.
    pub points: [u32; 3],
    /// Not negative, with a sum of one.
    pub weights: [f32; 3],
}

/// Cells along the side of the table for each division of the octant.
const CELLS_PER_DIVISION: u32 = 8;

/// Enough for every direction that the tests try; what is left of the way is then ignored.
const STEPS: usize = 6;

/// A triangle of the octant, either as the whole is (`down` is false) with the corners `(i, j)`, `(i + 1, j)` and
/// `(i, j + 1)`, or turned by half a turn with `(i + 1, j + 1)`, `(i, j + 1)` and `(i + 1, j)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    i: u32,
    j: u32,
    down: bool,
}

impl Place {
    #[inline]
    fn corners(self) -> [[u32; 2]; 3] {
        let Self { i, j, down } = self;
        let first = if down { [i + 1, j + 1] } else { [i, j] };
        let (second, third) = ([i + 1, j], [i, j + 1]);
        if down { [first, third, second] } else { [first, second, third] }
    }

    /// The neighbour across the edge that does not touch corner `n`, unless the octant ends there.
    #[inline]
    fn across(self, n: usize, divisions: u32) -> Option<Self> {
        let Self { i, j, down } = self;
        let (i, j) = match (down, n) {
            (_, 0) => (i, j),
            (true, 1) => (i + 1, j),
            (true, _) => (i, j + 1),
            (false, 1) => (i.checked_sub(1)?, j),
            (false, _) => (i, j.checked_sub(1)?),
        };
        let across = Self { i, j, down: !down };
        (i + j + u32::from(across.down) < divisions).then_some(across)
    }

    fn pack(self) -> u16 {
        (self.i | self.j << 6 | u32::from(self.down) << 12) as u16
    }

    #[inline]
    fn unpack(packed: u16) -> Self {
        let packed = u32::from(packed);
        Self { i: packed & 63, j: packed >> 6 & 63, down: packed >> 12 != 0 }
    }
}

/// A triangle with a direction in it.
pub(super) struct Located {
    place: Place,
    /// Cosine times the direction's length, per corner.
    nearness: [f32; 3],
    /// Of the corners, not scaled; negative where the direction lies outside.
    volumes: [f32; 3],
}

impl Located {
    #[inline]
    pub(super) fn corners(&self) -> [[u32; 2]; 3] {
        self.place.corners()
    }

    /// The corner nearest to the direction. No triangle is obtuse, so no other point of the octant is nearer.
    fn nearest(&self) -> [u32; 2] {
        let [a, b, c] = self.nearness;
        let corners = self.corners();
        if a >= b && a >= c {
            corners[0]
        } else if b >= c {
            corners[1]
        } else {
            corners[2]
        }
    }

    #[inline]
    pub(super) fn weights(&self) -> [f32; 3] {
        let inside = self.volumes.map(|v| v.max(0.0));
        let sum: f32 = inside.iter().sum();
        if sum > 0.0 { inside.map(|v| v / sum) } else { [1.0, 0.0, 0.0] }
    }
}

pub(super) struct Table {
    side: u32,
    triangles: Vec<u16>,
    /// `i` and `j` of the corner, 7 bits each.
    nearest: Vec<u16>,
}

impl Table {
    pub(super) fn new(octant: &Octant) -> Self {
        let side = CELLS_PER_DIVISION * octant.divisions;
        let mut triangles = vec![0; (side * side) as usize];
        let mut nearest = triangles.clone();
        let centre = |n: u32| (n as f32 + 0.5) / side as f32;
        let mut row_start = Place { i: 0, j: 0, down: false };
        for row in 0..side {
            let mut place = row_start;
            for column in 0..side {
                let (x, z) = (centre(column), centre(row));
                // Cells across the edge X-Z are reached by rounding alone: the edge stands in for them.
                let sum = (x + z).max(1.0);
                let direction = Vec3::new(x / sum, (1.0 - x - z).max(0.0), z / sum);
                let located = walk(octant, direction, place, 4 * side as usize);
                place = located.place;
                if column == 0 {
                    row_start = place;
                }
                let [i, j] = located.nearest();
                triangles[(column + side * row) as usize] = place.pack();
                nearest[(column + side * row) as usize] = (i | j << 7) as u16;
            }
        }
        Self { side, triangles, nearest }
    }

    /// The triangle around a direction with no negative coordinate.
    #[inline]
    pub(super) fn locate(&self, octant: &Octant, direction: Vec3) -> Located {
        walk(octant, direction, Place::unpack(self.triangles[self.cell(direction)]), STEPS)
    }

    /// The corner nearest to the middle of a direction's cell.
    #[inline(always)]
    pub(super) fn nearest(&self, direction: Vec3) -> [u32; 2] {
        let packed = u32::from(self.nearest[self.cell(direction)]);
        [packed & 127, packed >> 7]
    }

    /// Cells along a side.
    pub(super) fn side(&self) -> u32 {
        self.side
    }

    /// What each cell knows: the corner in bits 0 to 13, the triangle above.
    pub(super) fn cells(&self) -> impl Iterator<Item = u32> + '_ {
        let pair = |(&near, &triangle): (&u16, &u16)| u32::from(near) | u32::from(triangle) << 14;
        self.nearest.iter().zip(&self.triangles).map(pair)
    }

    #[inline(always)]
    fn cell(&self, direction: Vec3) -> usize {
        let scale = self.side as f32 / (direction.x + direction.y + direction.z);
        // A conversion to integers saturates, and takes what is no number as 0.
        let cell = |v: f32| ((v * scale) as u32).min(self.side - 1);
        (cell(direction.x) + self.side * cell(direction.z)) as usize
    }
}

#[inline]
fn walk(octant: &Octant, direction: Vec3, mut place: Place, steps: usize) -> Located {
    let mut steps = steps;
    loop {
        let [a, b, c] = place.corners().map(|[i, j]| octant.corner(i, j));
        let volumes = [c.cross(b).dot(direction), a.cross(c).dot(direction), b.cross(a).dot(direction)];
        let [va, vb, vc] = volumes;
        if steps > 0 && va.min(vb).min(vc) < 0.0 {
            steps -= 1;
            let farthest = if va <= vb && va <= vc {
                0
            } else if vb <= vc {
                1
            } else {
                2
            };
            if let Some(next) = place.across(farthest, octant.divisions) {
                place = next;
                continue;
            }
        }
        return Located { place, nearness: [a, b, c].map(|p| p.dot(direction)), volumes };
    }
}
