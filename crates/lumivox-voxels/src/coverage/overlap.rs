//! The overlap test behind `exact` and `thin`, arranged so that few cells are asked.
//!
//! A triangle and a cube are apart if an axis of the cube, the triangle's normal, or one of the nine products of axis
//! and edge separates them (Akenine-Moeller 2001). The nine are the edges of the triangle's projections along the axes
//! (Schwarz and Seidel 2010), and each is a line `a p + b q + c >= 0` over the cells of that projection.
//!
//! - Along the axis `d` that the triangle faces most, the three lines of that projection bound each row of columns.
//! - In a column the plane leaves an interval of cells, mostly one or two.
//! - Only where there is more than one, or for `thin`, those are asked about the six other lines.
//!
//! Boxes of up to 27 cells are simply asked cell by cell, the plane first. Small triangles of the exact set need less still:
//! in one cell, or cells in one line, all are touched, and in one layer of cells three lines decide.

use glam::{DVec3, IVec3};

use super::triangle::{CellBox, Triangle, ceil, dominant, floor};

/// Cells count as larger by this, relative to their size, so that closed tests stay closed under rounding.
const SLACK: f64 = 1e-9;

/// Rows shorter than this are asked column by column, which takes less than the divisions for their ends.
const NARROW: i32 = 8;

/// Boxes of up to this many cells along each axis are asked cell by cell.
const SMALL: i32 = 3;

/// How far from its centre a cell counts.
pub(crate) trait Reach {
    /// Whether a cell counts as soon as the triangle has a point in it.
    const TOUCHES: bool;

    /// Extent along a direction `(a, b, c)`, times its length.
    fn reach(a: f64, b: f64, c: f64) -> f64;
}

/// Calls `mark` for each cell of `within` that the triangle marks.
#[inline(always)]
pub(crate) fn walk<R: Reach>(
    triangle: &Triangle,
    normal: impl FnOnce() -> DVec3,
    within: &CellBox,
    mark: &mut impl FnMut(IVec3),
) {
    let CellBox { low, high } = triangle.reach.intersection(within);
    let mut facing = None;
    if R::TOUCHES {
        let CellBox { low: from, high: to } = triangle.reach;
        let flat = [from.x == to.x, from.y == to.y, from.z == to.z];
        match flat.iter().filter(|flat| **flat).count() {
            0 => {}
            1 => facing = flat.iter().position(|flat| *flat),
            _ => {
                for z in low.z..=high.z {
                    for y in low.y..=high.y {
                        (low.x..=high.x).for_each(|x| mark(IVec3::new(x, y, z)));
                    }
                }
                return;
            }
        }
    }
    if let Some(d) = facing {
        return match d {
            0 => layer::<R, 0>(triangle, low, high, mark),
            1 => layer::<R, 1>(triangle, low, high, mark),
            _ => layer::<R, 2>(triangle, low, high, mark),
        };
    }
    let normal = normal();
    let extent = high - low + 1;
    if extent.max_element() <= SMALL {
        return block::<R>(triangle, normal, low, high, mark);
    }
    match dominant(normal) {
        0 => volume::<R, 0>(triangle, normal, low, high, mark),
        1 => volume::<R, 1>(triangle, normal, low, high, mark),
        _ => volume::<R, 2>(triangle, normal, low, high, mark),
    }
}

/// The line of an edge in a projection: cells `(p, q)` with `a p + b q + c >= 0` are on the inner side or reach it.
#[derive(Clone, Copy)]
struct Line {
    a: f64,
    b: f64,
    c: f64,
}

impl Line {
    /// The line from `corner` along `edge`, with the inner side on the left times `side`.
    #[inline]
    fn new<R: Reach>(corner: DVec3, edge: DVec3, side: f64, p: usize, q: usize) -> Self {
        let (a, b) = (-side * edge[q], side * edge[p]);
        let at_corner = a * corner[p] + b * corner[q];
        let grown = R::reach(a, b, 0.0) + SLACK * (a.abs() + b.abs());
        Self { a, b, c: 0.5 * (a + b) + grown - at_corner }
    }

    #[inline]
    fn at(&self, p: f64, q: f64) -> f64 {
        self.a * p + self.b * q + self.c
    }
}

/// The three lines of a projection.
struct Lines([Line; 3]);

impl Lines {
    /// The projection onto axes `p` and `q`, seen so that the triangle runs counter-clockwise.
    #[inline]
    fn new<R: Reach>(triangle: &Triangle, facing: f64, p: usize, q: usize) -> Self {
        let side = if facing < 0.0 { -1.0 } else { 1.0 };
        let [a, b, c] = triangle.corners;
        let [e0, e1, e2] = triangle.edges();
        Self([
            Line::new::<R>(a, e0, side, p, q),
            Line::new::<R>(b, e1, side, p, q),
            Line::new::<R>(c, e2, side, p, q),
        ])
    }

    #[inline]
    fn pass(&self, p: f64, q: f64) -> bool {
        let [a, b, c] = &self.0;
        // Without short cuts: three additions take less than a branch that nobody can foresee.
        (a.at(p, q) >= 0.0) & (b.at(p, q) >= 0.0) & (c.at(p, q) >= 0.0)
    }

    /// The columns of row `q` that pass, within `low..=high`; none if the first is beyond the last.
    #[inline]
    fn row(&self, q: f64, low: i32, high: i32) -> (i32, i32) {
        let (mut first, mut last) = (low, high);
        for line in &self.0 {
            let rest = line.b * q + line.c;
            if line.a > 0.0 {
                first = first.max(ceil(-rest / line.a));
            } else if line.a < 0.0 {
                last = last.min(floor(rest / -line.a));
            } else if rest < 0.0 {
                return (1, 0);
            }
        }
        (first, last)
    }
}

#[inline]
fn cell<const D: usize>(d: i32, p: i32, q: i32) -> IVec3 {
    match D {
        0 => IVec3::new(d, p, q),
        1 => IVec3::new(q, d, p),
        _ => IVec3::new(p, q, d),
    }
}

/// A few cells in all directions: the plane, then all nine lines, for one after the other.
#[inline]
fn block<R: Reach>(
    triangle: &Triangle,
    normal: DVec3,
    low: IVec3,
    high: IVec3,
    mark: &mut impl FnMut(IVec3),
) {
    let xy = Lines::new::<R>(triangle, normal.z, 0, 1);
    let yz = Lines::new::<R>(triangle, normal.x, 1, 2);
    let zx = Lines::new::<R>(triangle, normal.y, 2, 0);
    let offset = normal.dot(triangle.corners[0] - 0.5);
    let half = R::reach(normal.x, normal.y, normal.z) + SLACK * normal.abs().element_sum();
    for k in low.z..=high.z {
        for j in low.y..=high.y {
            for i in low.x..=high.x {
                let (x, y, z) = (f64::from(i), f64::from(j), f64::from(k));
                let height = normal.x * x + normal.y * y + normal.z * z - offset;
                if height.abs() <= half && xy.pass(x, y) & yz.pass(y, z) & zx.pass(z, x) {
                    mark(IVec3::new(i, j, k));
                }
            }
        }
    }
}

/// All cells have the same `D` coordinate: the projection along `D` decides.
#[inline]
fn layer<R: Reach, const D: usize>(
    triangle: &Triangle,
    low: IVec3,
    high: IVec3,
    mark: &mut impl FnMut(IVec3),
) {
    let (p, q) = ((D + 1) % 3, (D + 2) % 3);
    let [e0, e1, _] = triangle.edges();
    let lines = Lines::new::<R>(triangle, e0[p] * e1[q] - e0[q] * e1[p], p, q);
    for j in low[q]..=high[q] {
        for i in low[p]..=high[p] {
            if lines.pass(f64::from(i), f64::from(j)) {
                mark(cell::<D>(low[D], i, j));
            }
        }
    }
}

/// The general case; the triangle faces `D` most.
#[inline]
fn volume<R: Reach, const D: usize>(
    triangle: &Triangle,
    normal: DVec3,
    low: IVec3,
    high: IVec3,
    mark: &mut impl FnMut(IVec3),
) {
    let (p, q) = ((D + 1) % 3, (D + 2) % 3);
    let bounds = Lines::new::<R>(triangle, normal[D], p, q);
    let plane = Plane::new::<R, D>(triangle, normal);
    let (lowest, highest) = (triangle.reach.low[D], triangle.reach.high[D]);
    let mut sides = None;
    let is_narrow = high[p] - low[p] < NARROW;
    for j in low[q]..=high[q] {
        let y = f64::from(j);
        let (first, last) = if is_narrow { (low[p], high[p]) } else { bounds.row(y, low[p], high[p]) };
        for i in first..=last {
            let x = f64::from(i);
            if is_narrow && !bounds.pass(x, y) {
                continue;
            }
            let (bottom, top) = plane.interval(x, y, lowest, highest);
            if R::TOUCHES && bottom == top {
                // The triangle is in this column, and can be nowhere else in it.
                if low[D] <= bottom && bottom <= high[D] {
                    mark(cell::<D>(bottom, i, j));
                }
                continue;
            }
            let (along_p, along_q) = sides.get_or_insert_with(|| {
                let along_p = Lines::new::<R>(triangle, normal[p], q, D);
                (along_p, Lines::new::<R>(triangle, normal[q], D, p))
            });
            for k in bottom.max(low[D])..=top.min(high[D]) {
                let height = f64::from(k);
                if along_p.pass(y, height) && along_q.pass(height, x) {
                    mark(cell::<D>(k, i, j));
                }
            }
        }
    }
}

/// The triangle's plane as heights `middle - p i - q j` over the columns, give or take `half` where cells reach it.
struct Plane {
    p: f64,
    q: f64,
    middle: f64,
    half: f64,
}

impl Plane {
    #[inline]
    fn new<R: Reach, const D: usize>(triangle: &Triangle, normal: DVec3) -> Self {
        let height = normal[D];
        if height == 0.0 {
            return Self { p: 0.0, q: 0.0, middle: 0.0, half: f64::INFINITY };
        }
        let (p, q) = (normal[(D + 1) % 3] / height, normal[(D + 2) % 3] / height);
        let corner = triangle.corners[0];
        let offset = corner[D] + p * corner[(D + 1) % 3] + q * corner[(D + 2) % 3];
        let middle = offset - 0.5 * (1.0 + p + q);
        Self { p, q, middle, half: R::reach(1.0, p, q) + SLACK * (1.0 + p.abs() + q.abs()) }
    }

    /// The cells of column `(i, j)` that reach the plane, within `low..=high`.
    #[inline]
    fn interval(&self, i: f64, j: f64, low: i32, high: i32) -> (i32, i32) {
        let middle = self.middle - self.p * i - self.q * j;
        (low.max(ceil(middle - self.half)), high.min(floor(middle + self.half)))
    }
}
