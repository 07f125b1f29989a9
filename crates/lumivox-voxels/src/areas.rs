//! Areas of the parts of a triangle in many cells, without cutting it into polygons.
//!
//! Seen along the axis that it faces most, the triangle is cut into layers of cells once. The part of a layer in a cell
//! is then a polygon in a square, and its area a sum over the polygon's edges (Green's theorem): what lies below an
//! edge within the square, `integral of clamp(y - low, 0, 1) dx`, which has a closed form. So a cell takes no branch and
//! no division, where cutting takes both for every corner.

use glam::{DVec3, IVec3};

use crate::coverage::{CellBox, Triangle, dominant};
use crate::fragment::share_above;
use crate::sparse::SIDE;

/// Edges of a triangle between two planes.
const EDGES: usize = 5;
/// Heights over one cell that differ by less count as level: quotients of such differences have no digits.
const LEVEL: f64 = 1e-7;

/// An edge from `x` to `x_end` at height `y + slope (x' - x)`.
#[derive(Clone, Copy, Debug, Default)]
struct Edge {
    x: f64,
    x_end: f64,
    y: f64,
    slope: f64,
    inverse: f64,
}

impl Edge {
    fn new([x, y]: [f64; 2], [x_end, y_end]: [f64; 2]) -> Self {
        let (dx, dy) = (x_end - x, y_end - y);
        let slope = if dx == 0.0 { 0.0 } else { dy / dx };
        let inverse = if slope == 0.0 { 0.0 } else { 1.0 / slope };
        Self { x, x_end, y, slope, inverse }
    }

    /// The signed area below the edge in the unit square at `low`.
    #[inline(always)]
    fn below(&self, low: [f64; 2]) -> f64 {
        let from = smaller(larger(self.x, low[0]), low[0] + 1.0);
        let to = smaller(larger(self.x_end, low[0]), low[0] + 1.0);
        let from_height = self.y + self.slope * (from - self.x) - low[1];
        let to_height = self.y + self.slope * (to - self.x) - low[1];
        let slanted = (integral(to_height) - integral(from_height)) * self.inverse;
        let level = unit_clamped(0.5 * (from_height + to_height)) * (to - from);
        if (to_height - from_height).abs() > LEVEL { slanted } else { level }
    }
}

/// The integral of `clamp(t, 0, 1)` from 0.
#[inline(always)]
fn integral(t: f64) -> f64 {
    let clamped = unit_clamped(t);
    clamped * (t - 0.5 * clamped)
}

#[inline(always)]
fn unit_clamped(t: f64) -> f64 {
    smaller(larger(t, 0.0), 1.0)
}

/// One instruction, where `f64::max` takes care of NaN with several.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The part of the triangle in one layer of cells.
#[derive(Clone, Copy, Debug, Default)]
struct Layer {
    edges: [Edge; EDGES],
    len: usize,
}

/// Room for the layers of one triangle in one brick, which is used again for the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Areas {
    layers: [Layer; SIDE as usize],
    /// Layers that are there, a bit each.
    made: u8,
    axis: usize,
    /// Area of the triangle over that of its projection.
    scale: f64,
    all: f64,
}

impl Areas {
    /// Begins with a triangle of this normal, whose length is twice the area.
    #[inline]
    pub(crate) fn begin(&mut self, normal: DVec3, length: f64) {
        self.axis = dominant(normal);
        let facing = normal[self.axis].abs();
        self.scale = if facing > 0.0 { length / facing } else { 0.0 };
        self.all = 0.5 * length;
        self.made = 0;
    }

    /// Area of the triangle under one column of the axis that it faces most.
    pub(crate) fn under_one_sample(&self) -> f64 {
        self.scale
    }

    /// Area in a cell that the triangle marks; `cell` must lie in one brick for all calls after [`Self::begin`].
    #[inline]
    pub(crate) fn in_cell(&mut self, triangle: &Triangle, cell: IVec3) -> f64 {
        let CellBox { low, high } = triangle.reach;
        let cells = high - low;
        match cells.element_sum() {
            0 => self.all,
            // Two cells: one cut.
            1 => {
                let [a, b, c] = triangle.corners;
                let axis = usize::from(cells.y == 1) + 2 * usize::from(cells.z == 1);
                let boundary = f64::from(high[axis]);
                let above = share_above(a[axis] - boundary, b[axis] - boundary, c[axis] - boundary);
                self.all * if cell[axis] == high[axis] { above } else { 1.0 - above }
            }
            _ => self.in_layer(triangle, cell),
        }
    }

    #[inline]
    fn in_layer(&mut self, triangle: &Triangle, cell: IVec3) -> f64 {
        let (p, q) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let number = (cell[self.axis] & (SIDE as i32 - 1)) as usize;
        if self.made >> number & 1 == 0 {
            self.made |= 1 << number;
            self.make(triangle, cell[self.axis], number);
        }
        let layer = &self.layers[number];
        let low = [f64::from(cell[p]), f64::from(cell[q])];
        let sum: f64 = layer.edges[..layer.len].iter().map(|edge| edge.below(low)).sum();
        self.scale * sum.abs()
    }

    #[inline(never)]
    fn make(&mut self, triangle: &Triangle, height: i32, number: usize) {
        let (p, q) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut corners = [[0.0; 3]; EDGES];
        for (place, corner) in corners.iter_mut().zip(triangle.corners) {
            *place = [corner[p], corner[q], corner[self.axis]];
        }
        let mut len = 3;
        let CellBox { low, high } = triangle.reach;
        if low[self.axis] < height {
            (corners, len) = cut(&corners[..len], f64::from(height), 1.0);
        }
        if high[self.axis] > height {
            (corners, len) = cut(&corners[..len], f64::from(height) + 1.0, -1.0);
        }
        let layer = &mut self.layers[number];
        layer.len = len;
        for n in 0..len {
            let [from, to] = [corners[n], corners[if n + 1 == len { 0 } else { n + 1 }]];
            layer.edges[n] = Edge::new([from[0], from[1]], [to[0], to[1]]);
        }
    }
}

/// The corners of what lies at `side * (z - at) >= 0`.
fn cut(from: &[[f64; 3]], at: f64, side: f64) -> ([[f64; 3]; EDGES], usize) {
    let mut kept = [[0.0; 3]; EDGES];
    let mut len = 0;
    let mut push = |corner| {
        if let Some(place) = kept.get_mut(len) {
            *place = corner;
            len += 1;
        }
    };
    for (n, &corner) in from.iter().enumerate() {
        let before = from[if n == 0 { from.len() - 1 } else { n - 1 }];
        let (d0, d1) = (side * (before[2] - at), side * (corner[2] - at));
        if (d0 > 0.0 && d1 < 0.0) || (d0 < 0.0 && d1 > 0.0) {
            let t = d0 / (d0 - d1);
            push([before[0] + t * (corner[0] - before[0]), before[1] + t * (corner[1] - before[1]), at]);
        }
        if d1 >= 0.0 {
            push(corner);
        }
    }
    (kept, len)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec3;
    use proptest::prelude::*;

    use crate::coverage::{Coverage, walk};
    use crate::fragment::in_cell;

    const DIMS: UVec3 = UVec3::splat(8);

    fn compare(corners: [DVec3; 3], tolerance: f64) -> Result<(), TestCaseError> {
        let triangle = Triangle::on_grid(corners, DIMS);
        let normal = triangle.normal();
        let mut areas = Areas::default();
        areas.begin(normal, normal.length());
        let mut worst = 0.0f64;
        let mut sum = 0.0;
        walk(Coverage::Exact, &triangle, &CellBox::of_grid(DIMS), &mut |cell| {
            let area = areas.in_cell(&triangle, cell);
            worst = worst.max((area - in_cell(&triangle, cell).area).abs());
            sum += area;
        });
        prop_assert!(worst < tolerance, "{}", worst);
        prop_assert!((sum - 0.5 * normal.length()).abs() < 512.0 * tolerance);
        Ok(())
    }

    fn corner() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(0.0..8.0).prop_map(DVec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        /// The same as cutting gives, for triangles of all sizes.
        #[test]
        fn areas_are_those_of_the_pieces(a in corner(), b in corner(), c in corner(), size in -4.0..0.0f64) {
            let near = |corner: DVec3| a + (corner - a) * 10f64.powf(size);
            compare([a, near(b), near(c)], 1e-8)?;
        }

        /// Edges along the axes and through corners of cells.
        #[test]
        fn areas_on_whole_numbers_are_those_of_the_pieces(corners in prop::array::uniform3(prop::array::uniform3(0..17i32))) {
            compare(corners.map(|c| 0.5 * DVec3::from(c.map(f64::from))), 1e-8)?;
        }
    }

    #[test]
    fn slivers_have_the_area_of_their_pieces() {
        for n in 0..200 {
            let thin = 10f64.powi(-n / 20);
            let tilt = f64::from(n % 20) / 20.0;
            let from = DVec3::new(0.1 + tilt, 0.3, 0.2);
            let to = DVec3::new(7.9, 0.3 + 7.0 * tilt, 6.0 * tilt);
            compare([from, to, from + DVec3::new(thin, -0.3 * thin, thin)], 1e-8).unwrap();
        }
    }
}
