//! Cells and areas of a small triangle at once, from one walk along its outline.
//!
//! A triangle touches the cells that its edges pass, those that its chords at the boundaries of layers pass, above and
//! below them, and those that it crosses from side to side, which no such line enters: these hold a whole square of it,
//! or nothing. So the lines that areas are summed along ([`sweep`](super::sweep)) know the cells too, and nobody has to
//! test the others.
//!
//! Tests are closed, with a slack of 1e-9 cells, and a walk is not. What can differ lies near cells of another number:
//! corners near a boundary, edges that pass near an edge of a cell, and planes near a corner of a cell. Such triangles,
//! one of some hundreds, are left to the tests.

use glam::{DVec3, IVec3};

use crate::coverage::{CellBox, Triangle};
use crate::sparse::bits;

/// Cells along each axis of the boxes that triangles may reach.
const SIDE: i32 = 8;
/// Cells of a slice of the box, at most, and of all slices.
const SLICE: usize = (SIDE * SIDE) as usize;
const SUMS: usize = SLICE * SIDE as usize;

/// Corners nearer than this to a boundary, in cells, are near it. So an edge that crosses it is at least twice as long
/// across, and where it comes nearer than a slack to an edge of a cell, it crosses both boundaries there within 1e-5 of
/// its length.
const CORNER: f64 = 1e-4;
/// Crossings of an edge that follow each other in less than this part of its length are near to each other.
const CROSSING: f64 = 1e-4;
/// Corners of cells less than this above or below the triangle's plane, in cells, are near it.
const PLANE: f64 = 1e-6;
/// Twice the area of the thinnest triangles that have a plane, over the square of their size.
const THINNEST: f64 = 1e-6;

/// The sums of one triangle, along axes of which the last is one that the triangle faces.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// What lines add to cell `(x, y, z)`, at `64 x + y z_count + z`, as in [`Sweep`](super::sweep::Sweep).
    sums: [f64; SUMS + SLICE],
    /// Cells that lines pass: a slice of one `x` in each word.
    passed: [u64; SIDE as usize],
    /// Axes of the grid.
    axes: [usize; 3],
    low: IVec3,
    size: IVec3,
    /// Area of the triangle over that of its projection.
    scale: f64,
}

impl Default for Outline {
    fn default() -> Self {
        Self {
            sums: [0.0; SUMS + SLICE],
            passed: [0; SIDE as usize],
            axes: [0, 1, 2],
            low: IVec3::ZERO,
            size: IVec3::ZERO,
            scale: 0.0,
        }
    }
}

/// An end of a line and its cell.
#[derive(Clone, Copy)]
struct Stop {
    point: DVec3,
    cell: IVec3,
}

impl Outline {
    /// Works out a triangle; false if it is not small, reaches beyond `within`, or is one for the tests.
    #[inline(never)]
    pub(super) fn run(
        &mut self,
        triangle: &Triangle,
        (normal, length): (DVec3, f64),
        within: &CellBox,
    ) -> bool {
        let CellBox { low, high } = triangle.reach;
        let extent = high - low;
        let is_inside = low.cmpge(within.low).all() && high.cmple(within.high).all();
        let longest = f64::from(extent.element_sum() + 3);
        if !is_inside || extent.max_element() >= SIDE || length <= THINNEST * longest * longest {
            return false;
        }
        let axes = axes_of(normal, length, extent);
        let turned = |v: &DVec3| {
            let v: &[f64; 3] = v.as_ref();
            DVec3::new(v[axes[0]], v[axes[1]], v[axes[2]])
        };
        let size: &[i32; 3] = extent.as_ref();
        let size = IVec3::new(size[axes[0]], size[axes[1]], size[axes[2]]) + 1;
        let origin = turned(&low.as_dvec3());
        let [a, b, c] = &triangle.corners;
        let corners = [turned(a) - origin, turned(b) - origin, turned(c) - origin];
        let corners = [Stop::new(corners[0], size), Stop::new(corners[1], size), Stop::new(corners[2], size)];
        let normal = turned(&normal);
        let are_clear = corners[0].is_clear(size) & corners[1].is_clear(size) & corners[2].is_clear(size);
        if !are_clear || !is_clear_of_corners(corners[0].point, normal, size) {
            return false;
        }
        (self.axes, self.low, self.size) = (axes, low, size);
        self.scale = length / normal.z.abs();
        self.passed = [0; SIDE as usize];
        let fours = self.fours();
        for sums in self.sums.chunks_exact_mut(SLICE).take(size.x as usize + 1) {
            for four in sums.chunks_exact_mut(4).take(fours) {
                four.fill(0.0);
            }
        }
        if !self.edges(&corners) {
            return false;
        }
        self.chords(&corners);
        self.sum();
        true
    }

    /// Adds the edges; false if one comes near an edge of a cell.
    #[inline(always)]
    fn edges(&mut self, corners: &[Stop; 3]) -> bool {
        let mut is_clear = true;
        for (n, m) in [(0, 1), (1, 2), (2, 0)] {
            let Self { sums, passed, .. } = self;
            is_clear &= pass(&corners[n], &corners[m], self.size, |cell, here, next| {
                let cell = cell & (SUMS - 1);
                sums[cell] += here;
                sums[cell + SLICE] += next;
                passed[cell / SLICE] |= 1 << (cell % SLICE);
            });
        }
        is_clear
    }

    /// Fours of a slice.
    #[inline(always)]
    fn fours(&self) -> usize {
        ((self.size.y * self.size.z) as usize).div_ceil(4)
    }

    /// Adds the chords.
    #[inline(always)]
    fn chords(&mut self, corners: &[Stop; 3]) {
        for plane in 1..self.size.z {
            let height = f64::from(plane);
            // Which edges cross the boundary, downwards and upwards: of each kind one.
            let is_low = |n: usize| usize::from(corners[n].cell.z < plane);
            let (a, b, c) = (is_low(0), is_low(1), is_low(2));
            let (down, up) = ((1 - b) * c + 2 * (1 - c) * a, b * (1 - c) + 2 * c * (1 - a));
            let crossing = |edge: usize| {
                let (from, to) = (corners[edge % 3].point, corners[(edge + 1) % 3].point);
                let share = (height - from.z) / (to.z - from.z);
                // In the layer above.
                let point = from.truncate() + share * (to - from).truncate();
                Stop::new(point.extend(height + 0.5), self.size)
            };
            let (from, to) = (crossing(down), crossing(up));
            let Self { sums, passed, .. } = self;
            pass(&from, &to, self.size, |above, here, next| {
                let above = above & (SUMS - 1);
                let below = above.saturating_sub(1);
                sums[above] += here;
                sums[above + SLICE] += next;
                sums[below] -= here;
                sums[below + SLICE] -= next;
                passed[above / SLICE] |= 1 << (above % SLICE);
                passed[below / SLICE] |= 1 << (below % SLICE);
            });
        }
    }

    /// Makes areas of the sums, and marks cells that are filled.
    #[inline(always)]
    fn sum(&mut self) {
        let fours = self.fours();
        let (y_count, z_count) = (self.size.y as usize, self.size.z as usize);
        let mut before = [0.0; SLICE];
        for (x, sums) in self.sums.chunks_exact_mut(SLICE).take(self.size.x as usize).enumerate() {
            for (before, sums) in before.chunks_exact_mut(4).zip(sums.chunks_exact_mut(4)).take(fours) {
                before.iter_mut().zip(&*sums).for_each(|(before, sum)| *before += sum);
                sums.copy_from_slice(before);
            }
            // Cells at the sides of the box are not filled, as no corner is near a boundary.
            if x > 0 && y_count > 2 && x + 1 < self.size.x as usize {
                let mut marks = 0;
                for bit in z_count..z_count * (y_count - 1) {
                    marks |= u64::from(before[bit % SLICE].abs() > 0.5) << bit;
                }
                self.passed[x % SIDE as usize] |= marks;
            }
        }
    }

    /// Calls `add` for each cell that the triangle touches, with the area in it.
    #[inline(always)]
    pub(super) fn for_each(&self, mut add: impl FnMut(IVec3, f64)) {
        let z_count = self.size.z as usize;
        // Bits over the number of layers, by a product: exact for all bits of a word.
        let per_row = 512usize.div_ceil(z_count.max(1));
        let [x, y, z] = self.axes;
        let at = [IVec3::AXES[x], IVec3::AXES[y], IVec3::AXES[z]];
        for (x, (marks, areas)) in self.passed.iter().zip(self.sums.chunks_exact(SLICE)).enumerate() {
            if x >= self.size.x as usize {
                break;
            }
            let low = self.low + x as i32 * at[0];
            for bit in bits(*marks) {
                let y = (bit * per_row) >> 9;
                let z = bit - y * z_count;
                let area = areas[bit].abs();
                let area = self.scale * if area < 1.0 { area } else { 1.0 };
                add(low + y as i32 * at[1] + z as i32 * at[2], area);
            }
        }
    }
}

impl Stop {
    #[inline(always)]
    fn new(point: DVec3, size: IVec3) -> Self {
        // Rounding may take a point out of the box.
        let cell = |x: f64, n: i32| ((x - 0.5 + MAGIC).to_bits() as i32).max(0).min(n - 1);
        Self { point, cell: IVec3::new(cell(point.x, size.x), cell(point.y, size.y), cell(point.z, size.z)) }
    }

    /// Whether it is not near a boundary between cells.
    #[inline(always)]
    fn is_clear(&self, size: IVec3) -> bool {
        let is_clear = |axis: usize| {
            let offset = self.point[axis] - f64::from(self.cell[axis]) - 0.5;
            (offset.abs() <= 0.5 - CORNER) | (size[axis] == 1)
        };
        is_clear(0) & is_clear(1) & is_clear(2)
    }
}

/// The axes of the box: the last is one that the triangle faces, of these one along which it reaches the fewest cells, and
/// the others follow in turn.
#[inline(always)]
fn axes_of(normal: DVec3, length: f64, extent: IVec3) -> [usize; 3] {
    // Some axis is faced at 0.57 of the whole.
    let cost = |axis: usize| if normal[axis].abs() >= 0.25 * length { extent[axis] } else { i32::MAX };
    let (x, y, z) = (cost(0), cost(1), cost(2));
    let select = |is: bool, yes: usize, no: usize| if is { yes } else { no };
    let axis = select(z < x.min(y), 2, select(y < x, 1, 0));
    [(axis + 1) % 3, (axis + 2) % 3, axis]
}

/// Goes from cell to cell along a line, and says for each what the line climbs in it, as [`Sweep`](super::sweep::Sweep)
/// shares it; false if it crosses two boundaries near to each other.
#[inline(always)]
fn pass(from: &Stop, to: &Stop, size: IVec3, mut add: impl FnMut(usize, f64, f64)) -> bool {
    let way = to.point - from.point;
    let per_way = way.recip();
    let further = per_way.abs();
    let cells = to.cell - from.cell;
    // Values are selected, and not branched to: nobody foresees them.
    let select = |is: bool, yes: f64, no: f64| if is { yes } else { no };
    // Where the line leaves the cell along each axis, in parts of the line.
    let first = |axis: usize| {
        let boundary = f64::from(from.cell[axis] + i32::from(cells[axis] > 0));
        select(cells[axis] == 0, f64::INFINITY, (boundary - from.point[axis]) * per_way[axis])
    };
    let (mut x, mut y, mut z) = (first(0), first(1), first(2));
    let side = cells.signum();
    let step = side.as_dvec3() * DVec3::new(SLICE as f64, f64::from(size.z), 1.0);
    // The number of the cell stands in the last bits of a number.
    let number = |cell: f64| cell.to_bits() as usize;
    let place = from.cell.x * SLICE as i32 + from.cell.y * size.z + from.cell.z;
    let mut cell = MAGIC + f64::from(place);
    let mut right = from.point.x - f64::from(from.cell.x);
    let (column, slope) = (f64::from(side.x), 0.5 * way.x);
    let (mut begin, mut nearest, mut before) = (0.0, f64::INFINITY, -1.0);
    for _ in 0..cells.abs().element_sum() {
        let nearer = select(x < y, x, y);
        let end = select(nearer < z, nearer, z);
        let height = (end - begin) * way.y;
        let share = height * (right + (begin + end) * slope);
        add(number(cell), height - share, share);
        let gap = end - before;
        nearest = select(gap < nearest, gap, nearest);
        (begin, before) = (end, end);
        let (is_x, is_y, is_z) = (x == end, y == end, z == end);
        x += select(is_x, further.x, 0.0);
        y += select(is_y, further.y, 0.0);
        z += select(is_z, further.z, 0.0);
        right -= select(is_x, column, 0.0);
        cell += select(is_x, step.x, 0.0) + select(is_y, step.y, 0.0) + select(is_z, step.z, 0.0);
    }
    let height = (1.0 - begin) * way.y;
    let share = height * (right + (begin + 1.0) * slope);
    add(number(cell), height - share, share);
    // Of crossings at the same place one step has taken several, and gone on beyond the end.
    (nearest >= CROSSING) & (begin <= 1.0)
}

/// The nearest whole number, in two additions.
#[inline(always)]
fn rounded(x: f64) -> f64 {
    (x + MAGIC) - MAGIC
}

const MAGIC: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// Whether the plane of a triangle passes no corner of cells inside the box closely.
#[inline(always)]
fn is_clear_of_corners(point: DVec3, normal: DVec3, size: IVec3) -> bool {
    let (along_x, along_y) = (-normal.x / normal.z, -normal.y / normal.z);
    let mut is_clear = true;
    // Of one layer all corners are at sides.
    let size = if size.z > 1 { size } else { IVec3::ONE };
    for y in 1..size.y {
        let start = point.z + along_y * (f64::from(y) - point.y) - along_x * point.x;
        for x in 1..size.x {
            let height = start + along_x * f64::from(x);
            is_clear &= (height - rounded(height)).abs() >= PLANE;
        }
    }
    is_clear
}
