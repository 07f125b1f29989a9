//! The overlap test behind `exact` and `thin`, arranged so that few cells are asked.
//!
//! A triangle and a cube are apart if an axis of the cube, the triangle's normal, or one of the nine products of axis
//! and edge separates them (Akenine-Moeller 2001). The nine are the edges of the triangle's projections along the axes
//! (Schwarz and Seidel 2010), and each is a line `a p + b q + c >= 0` over the cells of that projection.
//!
//! - Along the axis `d` that the triangle faces most, the three lines of that projection bound each row of columns.
//! - In a column the plane leaves an interval of cells, mostly one or two.
//! - Only those are asked about the six other lines.
//!
//! Small triangles of the exact set need less. In one cell, or cells in one line, all are touched. In one layer of cells
//! three lines decide.

use glam::{DVec3, IVec3};

use super::triangle::{CellBox, Triangle, axis, ceil, dominant, floor};

/// Cells count as larger by this, relative to their size, so that closed tests stay closed under rounding.
const SLACK: f64 = 1e-9;

/// How far from its centre a cell counts.
pub(crate) trait Reach {
    /// Whether a cell counts as soon as the triangle has a point in it.
    const TOUCHES: bool;

    /// Extent along a direction `(a, b, c)`, times its length.
    fn reach(a: f64, b: f64, c: f64) -> f64;
}

/// The line of an edge in a projection: cells `(p, q)` with `a p + b q + c >= 0` are on the inner side or reach it.
#[derive(Clone, Copy)]
struct Line {
    a: f64,
    b: f64,
    c: f64,
}

impl Line {
    #[inline]
    fn passes(&self, p: f64, q: f64) -> bool {
        self.a * p + self.b * q + self.c >= 0.0
    }
}

/// The three lines of the projection onto axes `p` and `q`, seen so that the triangle runs counter-clockwise.
#[inline]
fn lines<R: Reach>(triangle: &Triangle, edges: &[DVec3; 3], facing: f64, p: usize, q: usize) -> [Line; 3] {
    let side = if facing < 0.0 { -1.0 } else { 1.0 };
    std::array::from_fn(|i| {
        let (a, b) = (-side * axis(edges[i], q), side * axis(edges[i], p));
        let corner = triangle.corners[i];
        let at_corner = a * axis(corner, p) + b * axis(corner, q);
        let grown = R::reach(a, b, 0.0) + SLACK * (a.abs() + b.abs());
        Line { a, b, c: 0.5 * (a + b) + grown - at_corner }
    })
}

/// Calls `mark` for each cell of `within` that the triangle marks.
#[inline]
pub(crate) fn walk<R: Reach>(triangle: &Triangle, within: &CellBox, mark: &mut impl FnMut(IVec3)) {
    let CellBox { low, high } = triangle.reach.intersection(within);
    if R::TOUCHES {
        let wide = triangle.reach.low.cmpne(triangle.reach.high);
        let spread = usize::from(wide.x) + usize::from(wide.y) + usize::from(wide.z);
        if spread <= 1 {
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    (low.x..=high.x).for_each(|x| mark(IVec3::new(x, y, z)));
                }
            }
            return;
        }
        if spread == 2 {
            let d = if !wide.x { 0 } else if !wide.y { 1 } else { 2 };
            return layer::<R>(triangle, low, high, d, mark);
        }
    }
    volume::<R>(triangle, low, high, mark);
}

/// All cells have the same `d` coordinate: the projection along `d` decides.
fn layer<R: Reach>(triangle: &Triangle, low: IVec3, high: IVec3, d: usize, mark: &mut impl FnMut(IVec3)) {
    let (p, q) = ((d + 1) % 3, (d + 2) % 3);
    let edges = triangle.edges();
    let facing = axis(edges[0], p) * axis(edges[1], q) - axis(edges[0], q) * axis(edges[1], p);
    let lines = lines::<R>(triangle, &edges, facing, p, q);
    let mut cell = low;
    for j in low[q]..=high[q] {
        for i in low[p]..=high[p] {
            if lines.iter().all(|line| line.passes(f64::from(i), f64::from(j))) {
                cell[p] = i;
                cell[q] = j;
                mark(cell);
            }
        }
    }
}

/// The general case.
fn volume<R: Reach>(triangle: &Triangle, low: IVec3, high: IVec3, mark: &mut impl FnMut(IVec3)) {
    let edges = triangle.edges();
    let normal = triangle.normal();
    let d = dominant(normal);
    let (p, q) = ((d + 1) % 3, (d + 2) % 3);
    let bounds = lines::<R>(triangle, &edges, axis(normal, d), p, q);
    let along_p = lines::<R>(triangle, &edges, axis(normal, p), q, d);
    let along_q = lines::<R>(triangle, &edges, axis(normal, q), d, p);
    let plane = Plane::new::<R>(triangle, normal, d);
    let mut cell = low;
    for j in low[q]..=high[q] {
        let (first, last) = row(&bounds, f64::from(j), low[p], high[p]);
        for i in first..=last {
            let (bottom, top) = plane.interval(f64::from(i), f64::from(j), low[d], high[d]);
            for k in bottom..=top {
                let (i, j, k) = (f64::from(i), f64::from(j), f64::from(k));
                if along_p.iter().all(|line| line.passes(j, k)) && along_q.iter().all(|line| line.passes(k, i)) {
                    cell[d] = k as i32;
                    cell[p] = i as i32;
                    cell[q] = j as i32;
                    mark(cell);
                }
            }
        }
    }
}

/// The columns of row `q` that pass all three lines, within `low..=high`; none if the first is beyond the last.
#[inline]
fn row(lines: &[Line; 3], q: f64, low: i32, high: i32) -> (i32, i32) {
    let (mut first, mut last) = (low, high);
    for line in lines {
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

/// The triangle's plane as heights `low.p * p + low.q * q + low.c` over the columns, between which cells reach it.
struct Plane {
    p: f64,
    q: f64,
    middle: f64,
    half: f64,
}

impl Plane {
    #[inline]
    fn new<R: Reach>(triangle: &Triangle, normal: DVec3, d: usize) -> Self {
        let height = axis(normal, d);
        if height == 0.0 {
            return Self { p: 0.0, q: 0.0, middle: 0.0, half: f64::INFINITY };
        }
        let (p, q) = (axis(normal, (d + 1) % 3) / height, axis(normal, (d + 2) % 3) / height);
        let corner = triangle.corners[0];
        let offset = axis(corner, d) + p * axis(corner, (d + 1) % 3) + q * axis(corner, (d + 2) % 3);
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
