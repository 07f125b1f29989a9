//! Areas of the parts of a triangle in all cells of a box at once, by sums along its edges.
//!
//! Seen along an axis that the triangle faces, a layer of cells holds a polygon of it. Its area in a square is what
//! lies to the right of its edges there, with the signs of their directions (Green's theorem). So each edge adds to
//! the squares that it passes what it climbs in them, shared with the next square by how far to the right it runs, and
//! running sums along the rows make areas of this, as in scan converters that smooth the outlines of letters. Edges of
//! the polygons are parts of the triangle's and chords at the boundaries of layers, each of which two layers share.
//! The work grows with the length of the edges, and a cell inside takes one addition, where cutting polygons takes it
//! all for every cell.

use glam::{DVec3, IVec3, Vec3Swizzles};

use crate::coverage::{CellBox, Triangle, dominant};

/// The sums of one triangle, along axes of which the last is one that the triangle faces.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweep {
    /// First what edges add to cell `(x, y, z)`, at `(x y_count + y) z_count + z`, then areas; one more `x` than there
    /// are cells.
    sums: Vec<f64>,
    axis: usize,
    low: IVec3,
    size: IVec3,
    /// From a cell to the next along each axis of the grid.
    strides: IVec3,
    /// Whether the triangle reaches beyond the box, along each axis below and above.
    is_cut: [[bool; 2]; 3],
    /// The same along any.
    is_any_cut: bool,
    /// Area of the triangle over that of its projection.
    scale: f64,
}

/// An end of a line, and its cell in the box.
#[derive(Clone, Copy)]
struct Stop {
    point: DVec3,
    cell: IVec3,
}

#[inline(always)]
fn cell_at(point: DVec3, size: IVec3) -> IVec3 {
    let cell = |x: f64, n: i32| (x as i32).max(0).min(n - 1);
    IVec3::new(cell(point.x, size.x), cell(point.y, size.y), cell(point.z, size.z))
}

/// To which layers a line adds.
#[derive(Clone, Copy)]
enum Line {
    /// An edge of the triangle: to those it passes.
    Edge,
    /// A chord between two layers: to the one above, and with the other sign to the one below.
    Chord(i32),
}

impl Sweep {
    /// The area in a cell of the box.
    #[inline(always)]
    pub(super) fn area(&self, cell: IVec3) -> f64 {
        let place = (cell - self.low).dot(self.strides);
        let sum = self.sums.get(place as usize).map_or(0.0, |sum| sum.abs());
        // No square holds more than itself, whatever becomes of triangles of a million cells.
        self.scale * if sum < 1.0 { sum } else { 1.0 }
    }

    /// Works out the areas in the cells of `within` that the triangle reaches.
    pub(super) fn run(&mut self, triangle: &Triangle, (normal, length): (DVec3, f64), within: &CellBox) {
        let CellBox { low, high } = triangle.reach.intersection(within);
        self.axis = axis_of(normal, length, high - low);
        let turned = |v: IVec3| IVec3::from(turned(self.axis, v.to_array()));
        self.low = low;
        self.size = turned(high - low + 1);
        let strides = IVec3::new(self.size.y * self.size.z, self.size.z, 1);
        self.strides = match self.axis {
            0 => strides.zxy(),
            1 => strides.yzx(),
            _ => strides,
        };
        let below = turned(low - triangle.reach.low);
        let above = turned(triangle.reach.high - high);
        self.is_cut = std::array::from_fn(|axis| [below[axis] > 0, above[axis] > 0]);
        self.is_any_cut = below != IVec3::ZERO || above != IVec3::ZERO;
        let facing = normal[self.axis].abs();
        self.scale = if facing > 0.0 { length / facing } else { 0.0 };
        self.sums.clear();
        if self.size.cmple(IVec3::ZERO).any() {
            return;
        }
        let row = (self.size.y * self.size.z) as usize;
        self.sums.resize((self.size.x as usize + 1) * row, 0.0);
        if facing > 0.0 {
            self.outline(triangle);
            for n in row..self.sums.len() {
                self.sums[n] += self.sums[n - row];
            }
        }
    }

    /// All edges and chords, around each polygon in the same sense.
    fn outline(&mut self, triangle: &Triangle) {
        let origin = self.low.as_dvec3();
        let corner = |n: usize| {
            let point = DVec3::from(turned(self.axis, (triangle.corners[n] - origin).to_array()));
            Stop { point, cell: cell_at(point, self.size) }
        };
        let mut corners = [corner(0), corner(1), corner(2)];
        for (a, b) in [(0, 1), (1, 2), (0, 1)] {
            if corners[a].point.z > corners[b].point.z {
                corners.swap(a, b);
            }
        }
        let [low, middle, high] = corners;
        for (from, to) in [(low, middle), (middle, high), (high, low)] {
            if self.is_any_cut {
                self.cut(from.point, to.point, Line::Edge);
            } else {
                self.trace(from, to, Line::Edge);
            }
        }
        let [from_bottom, to_top] = self.is_cut[2].map(i32::from);
        let [low, middle, high] = corners.map(|corner| corner.point);
        for plane in 1 - from_bottom..self.size.z + to_top {
            let height = f64::from(plane);
            // Nothing lies below: an edge in the plane is one of the layer above, and no chord beside it.
            if height <= low.z {
                continue;
            }
            let long = at(low, high, height);
            let short = if height < middle.z { at(low, middle, height) } else { at(middle, high, height) };
            // Chords are in the layers that they are said to be in.
            let (from, to) = (long.with_z(0.5), short.with_z(0.5));
            if self.is_any_cut {
                self.cut(from, to, Line::Chord(plane));
            } else {
                let stop = |point| Stop { point, cell: cell_at(point, self.size) };
                self.trace(stop(from), stop(to), Line::Chord(plane));
            }
        }
    }

    /// Adds a line, of which only what lies in the box, or to the left of it, matters.
    #[inline(never)]
    fn cut(&mut self, mut from: DVec3, mut to: DVec3, line: Line) {
        for axis in [2, 1] {
            let [below, above] = self.is_cut[axis];
            let end = f64::from(self.size[axis]);
            let is_below = below && from[axis] < 0.0 && to[axis] < 0.0;
            if is_below || (above && from[axis] >= end && to[axis] >= end) {
                return;
            }
            for (is_cut, at, side) in [(below, 0.0, 1.0), (above, end, -1.0)] {
                if is_cut && side * (from[axis] - at) < 0.0 {
                    from = crossing(from, to, axis, at);
                } else if is_cut && side * (to[axis] - at) < 0.0 {
                    to = crossing(from, to, axis, at);
                }
            }
        }
        let [left, right] = self.is_cut[0];
        let end = f64::from(self.size.x);
        if right && from.x >= end && to.x >= end {
            return;
        }
        if right && from.x > end {
            from = crossing(from, to, 0, end);
        } else if right && to.x > end {
            to = crossing(from, to, 0, end);
        }
        // What is on the left is to the left of all cells of the row.
        let flat = |point: DVec3| point.with_x(0.0);
        let size = self.size;
        let mut trace = |from, to| {
            let [from, to] = [from, to].map(|point| Stop { point, cell: cell_at(point, size) });
            self.trace(from, to, line);
        };
        if left && from.x < 0.0 && to.x < 0.0 {
            return trace(flat(from), flat(to));
        }
        if left && from.x < 0.0 {
            let middle = crossing(from, to, 0, 0.0);
            trace(flat(from), middle);
            from = middle;
        } else if left && to.x < 0.0 {
            let middle = crossing(from, to, 0, 0.0);
            trace(middle, flat(to));
            to = middle;
        }
        trace(from, to);
    }

    /// Adds a line in the box.
    #[inline]
    fn trace(&mut self, from: Stop, to: Stop, line: Line) {
        let Self { sums, size, .. } = self;
        let row = (size.y * size.z) as usize;
        match line {
            Line::Edge => pass(from, to, *size, |cell, here, next| {
                // Rounding may take a line out of the box where hardly anything is left of it.
                if let Some(sum) = sums.get_mut(cell) {
                    *sum += here;
                }
                if let Some(sum) = sums.get_mut(cell.wrapping_add(row)) {
                    *sum += next;
                }
            }),
            Line::Chord(plane) => {
                let layers = [(plane - 1, -1.0), (plane, 1.0)];
                let layers = layers.map(|(layer, sign)| {
                    let is_there = 0 <= layer && layer < size.z;
                    (layer.clamp(0, size.z - 1) as usize, if is_there { sign } else { 0.0 })
                });
                pass(from, to, *size, |cell, here, next| {
                    for (layer, sign) in layers {
                        let cell = cell.wrapping_add(layer);
                        if let Some(sum) = sums.get_mut(cell) {
                            *sum += sign * here;
                        }
                        if let Some(sum) = sums.get_mut(cell.wrapping_add(row)) {
                            *sum += sign * next;
                        }
                    }
                });
            }
        }
    }
}

/// Goes from cell to cell along a line in a box, and says for each what the line climbs in it, in two shares: that of
/// the cell, and that of the cells to the right of it.
#[inline(always)]
fn pass(from: Stop, to: Stop, size: IVec3, mut add: impl FnMut(usize, f64, f64)) {
    let way = to.point - from.point;
    if way.y == 0.0 {
        return;
    }
    let (first, last, from) = (from.cell, to.cell, from.point);
    let strides = [size.y * size.z, size.z, 1];
    let mut cell = ((first.x * size.y + first.y) * size.z + first.z) as usize;
    let mut column = f64::from(first.x);
    // Where the line leaves the cell along each axis, in parts of the line; one more for masks.
    let mut next = [f64::INFINITY; 4];
    let (mut further, mut column_step, mut cell_step) = ([0.0; 4], [0.0; 4], [0usize; 4]);
    let cells = last - first;
    for axis in 0..3 {
        let ahead = f64::from(first[axis] + i32::from(cells[axis] > 0));
        let per_way = 1.0 / way[axis];
        let reached = (ahead - from[axis]) * per_way;
        // Selected, and not asked: nobody foresees it.
        next[axis] = if cells[axis] == 0 { f64::INFINITY } else { reached };
        further[axis] = per_way.abs();
        cell_step[axis] = (cells[axis].signum() * strides[axis]) as isize as usize;
    }
    let steps = cells.abs().element_sum();
    column_step[0] = f64::from(cells.x.signum());
    let mut begin = 0.0;
    let mut part = |cell: usize, column: f64, begin: f64, end: f64| {
        let height = (end - begin) * way.y;
        let right = height * (from.x - column + 0.5 * (begin + end) * way.x);
        add(cell, height - right, right);
    };
    for _ in 0..steps {
        // Without branches: nobody foresees them.
        let axis = usize::from(next[1] < next[0]);
        let axis = if next[2] < next[axis] { 2 } else { axis };
        let end = next[axis];
        part(cell, column, begin, end);
        begin = end;
        next[axis] += further[axis];
        column += column_step[axis];
        cell = cell.wrapping_add(cell_step[axis]);
    }
    part(cell, column, begin, 1.0);
}

/// The point of an edge at a height, between its ends.
#[inline(always)]
fn at(low: DVec3, high: DVec3, height: f64) -> DVec3 {
    let way = high - low;
    if way.z > 0.0 { low + (height - low.z) / way.z * way } else { low }
}

/// The axis to look along: of those that the triangle faces well, the first along which it reaches the fewest cells, which
/// leaves the fewest chords. Some axis is faced at 0.57 of the whole.
fn axis_of(normal: DVec3, length: f64, extent: IVec3) -> usize {
    let mut best = dominant(normal);
    for axis in 0..3 {
        if extent[axis] < extent[best] && normal[axis].abs() >= 0.25 * length {
            best = axis;
        }
    }
    best
}

/// Where a line meets a plane across an axis that parts its ends.
fn crossing(from: DVec3, to: DVec3, axis: usize, at: f64) -> DVec3 {
    let way = to - from;
    let mut point = from + (at - from[axis]) / way[axis] * way;
    point[axis] = at;
    point
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
