//! Areas of the parts of a triangle in many cells, without cutting it into polygons.
//!
//! Seen along the axis that it faces most, the triangle is cut into layers of cells once. The part of a layer in a cell
//! is then a polygon in a square, and its area a sum over the polygon's edges (Green's theorem): what lies below an
//! edge within the square, `integral of clamp(y - low, 0, 1) dx`, which has a closed form. So a cell takes no branch and
//! no division, where cutting takes both for every corner; edges go in pairs through vector registers.

use glam::{DVec3, IVec3};

use crate::coverage::{CellBox, Triangle, dominant};
use crate::fragment::share_above;
use crate::sparse::SIDE;

/// Edges of the part of a triangle between two planes: of the side through the middle corner the lower and the upper
/// part, the long side, and two chords; one more makes pairs.
const EDGES: usize = 6;
/// Of these the ones that a whole triangle has, and one more.
const WHOLE: usize = 4;
const LOWER: usize = 0;
const UPPER: usize = 1;
const LONG: usize = 2;
// Number 3 stays empty.
const BOTTOM: usize = 4;
const TOP: usize = 5;
/// Layers of cells of a triangle that are there at once: those of eight bricks one above the other.
const LAYERS: usize = 64;
/// Heights over one cell that differ by less count as level: quotients of such differences have no digits.
const LEVEL: f64 = 1e-7;

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

/// The edges of the part in one layer of cells, from `x` to `x_end`, at height `y` where they begin.
#[derive(Clone, Copy, Debug, Default)]
struct Layer {
    x: [f64; EDGES],
    x_end: [f64; EDGES],
    y: [f64; EDGES],
    is_whole: bool,
}

impl Layer {
    fn set(&mut self, edge: usize, from: DVec3, to: DVec3) {
        (self.x[edge], self.x_end[edge], self.y[edge]) = (from.x, to.x, from.y);
    }

    /// The area of the part in the unit square at `low`, with a sign.
    #[inline(always)]
    fn within<const N: usize>(&self, slopes: &Slopes, low: [f64; 2]) -> f64 {
        let mut below = [0.0; N];
        for (n, below) in below.iter_mut().enumerate() {
            let from = smaller(larger(self.x[n], low[0]), low[0] + 1.0);
            let to = smaller(larger(self.x_end[n], low[0]), low[0] + 1.0);
            let from_height = self.y[n] - low[1] + slopes.slope[n] * (from - self.x[n]);
            let to_height = self.y[n] - low[1] + slopes.slope[n] * (to - self.x[n]);
            let slanted = (integral(to_height) - integral(from_height)) * slopes.inverse[n];
            let level = unit_clamped(0.5 * (from_height + to_height)) * (to - from);
            *below = if (to_height - from_height).abs() > LEVEL { slanted } else { level };
        }
        below.iter().sum()
    }
}

/// What an edge rises by per unit, and the inverse; zero for upright and level ones. All chords are parallel.
#[derive(Clone, Copy, Debug, Default)]
struct Slopes {
    slope: [f64; EDGES],
    inverse: [f64; EDGES],
}

impl Slopes {
    fn set(&mut self, edge: usize, dx: f64, dy: f64) {
        (self.slope[edge], self.inverse[edge]) = match () {
            () if dx == 0.0 || !(dy / dx).is_finite() => (0.0, 0.0),
            () if dy == 0.0 || !(dx / dy).is_finite() => (0.0, 0.0),
            () => (dy / dx, dx / dy),
        };
    }
}

/// Room for the layers of one triangle, which is used again for the next.
#[derive(Clone, Debug)]
pub(crate) struct Areas {
    layers: [Layer; LAYERS],
    /// Layers that are there, a bit each.
    made: u64,
    /// Whether what follows is there.
    is_set: bool,
    slopes: Slopes,
    /// Corners with the axis as z, the lowest first, and the inverse heights of the edges.
    corners: [DVec3; 3],
    per_height: [f64; 3],
    normal: DVec3,
    axis: usize,
    /// Area of the triangle over that of its projection.
    scale: f64,
    all: f64,
    /// Of each layer, cells that are still to be worked out, and the area in them.
    waiting: [u16; LAYERS],
    rest: [f64; LAYERS],
}

impl Default for Areas {
    fn default() -> Self {
        Self {
            layers: [Layer::default(); LAYERS],
            made: 0,
            is_set: false,
            slopes: Slopes::default(),
            corners: [DVec3::ZERO; 3],
            per_height: [0.0; 3],
            normal: DVec3::ZERO,
            axis: 0,
            scale: 0.0,
            all: 0.0,
            waiting: [0; LAYERS],
            rest: [0.0; LAYERS],
        }
    }
}

impl Areas {
    /// Begins with a triangle of this normal, whose length is twice the area.
    #[inline]
    pub(crate) fn begin(&mut self, normal: DVec3, length: f64) {
        self.axis = dominant(normal);
        let facing = normal[self.axis].abs();
        self.scale = if facing > 0.0 { length / facing } else { 0.0 };
        self.all = 0.5 * length;
        self.normal = normal;
        (self.made, self.is_set) = (0, false);
    }

    /// Area of the triangle under one column of the axis that it faces most.
    pub(crate) fn under_one_sample(&self) -> f64 {
        self.scale
    }

    /// Area in a cell that the triangle marks; all cells after [`Self::begin`] must lie in one brick.
    #[inline(always)]
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
            _ => self.in_layer(triangle, cell, (cell[self.axis] & (SIDE as i32 - 1)) as usize),
        }
    }

    #[inline(always)]
    fn in_layer(&mut self, triangle: &Triangle, cell: IVec3, number: usize) -> f64 {
        let cell = turned(self.axis, cell.to_array());
        let number = number % LAYERS;
        if self.made >> number & 1 == 0 {
            self.made |= 1 << number;
            self.make(triangle, cell[2], number);
        }
        let layer = &self.layers[number];
        let low = [f64::from(cell[0]), f64::from(cell[1])];
        let sum = match layer.is_whole {
            true => layer.within::<WHOLE>(&self.slopes, low),
            false => layer.within::<EDGES>(&self.slopes, low),
        };
        self.scale * sum.abs()
    }

    /// Appends the areas in some cells that the triangle marks. With `is_all` they are all that it marks, and
    /// lie in no more than eight bricks: then the areas of a layer add up to what two cuts leave of the triangle, and one of them
    /// need not be worked out.
    #[inline(always)]
    pub(crate) fn of_cells(
        &mut self,
        triangle: &Triangle,
        cells: &[IVec3],
        is_all: bool,
        found: &mut Vec<f64>,
    ) {
        let (axis, all) = (self.axis, self.all);
        let lowest = triangle.reach.low[axis];
        if !is_all {
            let number = |cell: &IVec3| (cell[axis] - lowest) as usize;
            return found.extend(cells.iter().map(|cell| self.in_layer(triangle, *cell, number(cell))));
        }
        let count = (triangle.reach.high[axis] - lowest) as usize + 1;
        let Self { waiting, rest, .. } = self;
        waiting[..count].fill(0);
        cells.iter().for_each(|cell| waiting[(cell[axis] - lowest) as usize] += 1);
        let mut above = 1.0;
        for (n, rest) in rest[..count].iter_mut().enumerate() {
            let below = above;
            above = if n + 1 < count {
                let [a, b, c] = triangle.corners;
                let boundary = f64::from(lowest + n as i32 + 1);
                share_above(a[axis] - boundary, b[axis] - boundary, c[axis] - boundary)
            } else {
                0.0
            };
            *rest = all * (below - above);
        }
        for &cell in cells {
            let n = (cell[axis] - lowest) as usize;
            self.waiting[n] -= 1;
            found.push(if self.waiting[n] == 0 {
                larger(self.rest[n], 0.0)
            } else {
                let area = self.in_layer(triangle, cell, n);
                self.rest[n] -= area;
                area
            });
        }
    }

    /// Puts the corners in order and finds what all layers share.
    fn set(&mut self, triangle: &Triangle) {
        self.is_set = true;
        let mut corners = triangle.corners.map(|corner| DVec3::from(turned(self.axis, corner.to_array())));
        for (a, b) in [(0, 1), (1, 2), (0, 1)] {
            if corners[a].z > corners[b].z {
                corners.swap(a, b);
            }
        }
        let [low, middle, high] = corners;
        for (edge, way) in [(LOWER, middle - low), (UPPER, high - middle), (LONG, low - high)] {
            self.slopes.set(edge, way.x, way.y);
            self.per_height[edge] = if way.z == 0.0 { 0.0 } else { 1.0 / way.z };
        }
        let [p, q, _] = turned(self.axis, self.normal.to_array());
        self.slopes.set(BOTTOM, q, -p);
        (self.slopes.slope[TOP], self.slopes.inverse[TOP]) =
            (self.slopes.slope[BOTTOM], self.slopes.inverse[BOTTOM]);
        self.corners = corners;
    }

    #[inline(never)]
    fn make(&mut self, triangle: &Triangle, height: i32, number: usize) {
        if !self.is_set {
            self.set(triangle);
        }
        let [low, middle, high] = self.corners;
        let layer = &mut self.layers[number];
        layer.is_whole = triangle.reach.low[self.axis] == triangle.reach.high[self.axis];
        if layer.is_whole {
            layer.set(LOWER, low, middle);
            layer.set(UPPER, middle, high);
            layer.set(LONG, high, low);
            return;
        }
        let bottom = f64::from(height).max(low.z);
        let top = (f64::from(height) + 1.0).min(high.z);
        let at = |edge: usize, from: DVec3, to: DVec3, z: f64| {
            from + (z - from.z) * self.per_height[edge] * (to - from)
        };
        let lower = |z: f64| at(LOWER, low, middle, z);
        let upper = |z: f64| at(UPPER, middle, high, z);
        let long = [bottom, top].map(|z| at(LONG, high, low, z));
        let (begin, end) = match (bottom < middle.z, top < middle.z) {
            (true, true) => {
                let ends = (lower(bottom), lower(top));
                layer.set(LOWER, ends.0, ends.1);
                layer.set(UPPER, ends.1, ends.1);
                ends
            }
            (true, false) => {
                let ends = (lower(bottom), upper(top));
                layer.set(LOWER, ends.0, middle);
                layer.set(UPPER, middle, ends.1);
                ends
            }
            _ => {
                let ends = (upper(bottom), upper(top));
                layer.set(LOWER, ends.0, ends.0);
                layer.set(UPPER, ends.0, ends.1);
                ends
            }
        };
        layer.set(BOTTOM, long[0], begin);
        layer.set(TOP, end, long[1]);
        layer.set(LONG, long[1], long[0]);
    }
}

/// Coordinates with `axis` as the last, in the same turn.
#[inline(always)]
fn turned<T: Copy>(axis: usize, [x, y, z]: [T; 3]) -> [T; 3] {
    match axis {
        0 => [y, z, x],
        1 => [z, x, y],
        _ => [x, y, z],
    }
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
        // What the triangle before has left must not show.
        let other = Triangle::on_grid(
            [DVec3::new(0.1, 7.9, 0.2), DVec3::new(7.7, 0.3, 3.1), DVec3::splat(7.5)],
            DIMS,
        );
        areas.begin(other.normal(), other.normal().length());
        walk(Coverage::Exact, &other, &CellBox::of_grid(DIMS), &mut |cell| {
            areas.in_cell(&other, cell);
        });
        areas.begin(normal, normal.length());
        let mut worst = 0.0f64;
        let mut sum = 0.0;
        walk(Coverage::Exact, &triangle, &CellBox::of_grid(DIMS), &mut |cell| {
            let area = areas.in_cell(&triangle, cell);
            worst = worst.max((area - in_cell(&triangle, cell).area).abs());
            sum += area;
        });
        prop_assert!(worst < tolerance, "{}", worst);
        let mut cells = Vec::new();
        walk(Coverage::Exact, &triangle, &CellBox::of_grid(DIMS), &mut |cell| cells.push(cell));
        areas.begin(normal, normal.length());
        let mut found = Vec::new();
        areas.of_cells(&triangle, &cells, true, &mut found);
        let apart =
            cells.iter().zip(&found).map(|(&cell, area)| (area - in_cell(&triangle, cell).area).abs());
        let worst = apart.fold(0.0, f64::max);
        prop_assert!(worst < tolerance && found.len() == cells.len(), "{} at once", worst);
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
