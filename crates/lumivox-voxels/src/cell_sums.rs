//! Sums of small flat triangles, cell by cell, while triangles are binned.
//!
//! What a small triangle leaves in cells takes less than to look it up again brick by brick. So areas and normals of these
//! are summed where they are met first, and bricks get one entry for a cell and chunk. Sums are integers, so that it does
//! not matter which.

use glam::{DVec3, IVec3};

use crate::areas::Areas;
use crate::channels::FlatPiece;
use crate::coverage::{self, CellBox, Coverage, Triangle};
use crate::fragment::share_above;
use crate::sparse::{CELLS, Mask};

/// No sum yet.
const NONE: u32 = u32::MAX;
/// Sums are closed before their normals, and those of up to [`MERGED`] chunks together, could overflow: at 16 cell faces.
const LONGEST: u64 = 1 << 26;
/// So many sums of a cell can be added up.
pub(crate) const MERGED: usize = 16;

/// A sum that was closed: the cell within the brick, and what there is in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closed {
    pub(crate) cell: u32,
    pub(crate) sum: FlatPiece,
}

/// The sums of one chunk, by the number of the brick in the chunk.
#[derive(Default)]
pub(crate) struct CellSums {
    /// Where the sum of each cell of each brick is.
    places: Vec<[u32; CELLS]>,
    sums: Vec<FlatPiece>,
    closed: Vec<(u32, Closed)>,
}

impl CellSums {
    /// Room for the cells of so many bricks.
    #[inline]
    pub(crate) fn make_room(&mut self, bricks: usize) {
        if self.places.len() < bricks {
            self.places.resize(bricks, [NONE; CELLS]);
        }
    }

    /// Adds a piece to a cell, which it marks.
    #[inline(always)]
    pub(crate) fn add(&mut self, brick: usize, cell: u32, mask: &mut Mask, piece: &FlatPiece) {
        let place = &mut self.places[brick][cell as usize];
        if *place == NONE {
            *place = self.sums.len() as u32;
            mask[cell as usize >> 6] |= 1 << (cell & 63);
            self.sums.push(*piece);
            return;
        }
        let sum = &mut self.sums[*place as usize];
        if sum.weight < LONGEST {
            sum.add(piece);
        } else {
            self.closed.push((brick as u32, Closed { cell, sum: std::mem::replace(sum, *piece) }));
        }
    }

    /// Numbers of sums and of closed ones.
    pub(crate) fn len(&self) -> usize {
        self.sums.len() + self.closed.len()
    }

    /// All sums, brick after brick in the order of the bits of their masks, with the start of each brick and the end of the last.
    pub(crate) fn sorted(&self, masks: &[Mask]) -> (Vec<u32>, Vec<FlatPiece>) {
        let mut starts = Vec::with_capacity(masks.len() + 1);
        let mut sums = Vec::with_capacity(self.sums.len());
        for (mask, places) in masks.iter().zip(&self.places) {
            starts.push(sums.len() as u32);
            cells(mask).for_each(|cell| sums.push(self.sums[places[cell] as usize]));
        }
        starts.resize(masks.len() + 1, sums.len() as u32);
        (starts, sums)
    }

    pub(crate) fn closed(&self) -> impl Iterator<Item = (u32, Closed)> + Clone {
        self.closed.iter().copied()
    }
}

/// The cells of a mask, in order.
pub(crate) fn cells(mask: &Mask) -> impl Iterator<Item = usize> + Clone {
    let words = *mask;
    (0..words.len()).flat_map(move |z| {
        let mut word = words[z];
        std::iter::from_fn(move || {
            let bit = (word != 0).then(|| word.trailing_zeros())?;
            word &= word - 1;
            Some(64 * z + bit as usize)
        })
    })
}

/// What pieces of triangles are cut with; used again for the next.
#[derive(Default)]
pub(crate) struct Cutter {
    cells: Vec<IVec3>,
    /// The areas in these.
    found: Vec<f64>,
    areas: Areas,
}

impl Cutter {
    /// Calls `add` for each cell of `grid` that a triangle marks in exact coverage, with the piece of it there. The triangle must not
    /// reach more than eight bricks.
    #[inline(always)]
    pub(crate) fn cut(
        &mut self,
        triangle: &Triangle,
        face: FlatFace,
        grid: &CellBox,
        mut add: impl FnMut(IVec3, &FlatPiece),
    ) {
        let CellBox { low, high } = triangle.reach;
        let extent = high - low;
        match extent.element_sum() {
            0 => {
                if grid.contains(low) {
                    add(low, &face.piece(0.5 * face.length));
                }
            }
            // Two cells: one cut.
            1 => {
                let axis = usize::from(extent.y == 1) + 2 * usize::from(extent.z == 1);
                let boundary = f64::from(high[axis]);
                let [a, b, c] = triangle.corners;
                let above = share_above(a[axis] - boundary, b[axis] - boundary, c[axis] - boundary);
                for (cell, share) in [(low, 1.0 - above), (high, above)] {
                    if grid.contains(cell) {
                        add(cell, &face.piece(share * (0.5 * face.length)));
                    }
                }
            }
            _ => {
                self.parts(triangle, &face, grid);
                for (&cell, &area) in self.cells.iter().zip(&self.found) {
                    add(cell, &face.piece(area));
                }
            }
        }
    }

    /// Finds the cells of a triangle and the areas in them. Not inlined: walks are long, and the code of small triangles has to stay near.
    #[inline(never)]
    fn parts(&mut self, triangle: &Triangle, face: &FlatFace, grid: &CellBox) {
        self.cells.clear();
        self.found.clear();
        let Self { cells, found, areas } = self;
        coverage::walk(Coverage::Exact, triangle, grid, &mut |cell| cells.push(cell));
        let is_all = grid.contains(triangle.reach.low) && grid.contains(triangle.reach.high);
        areas.begin(face.normal, face.length);
        areas.of_cells(triangle, cells, is_all, found);
    }
}

/// The plane of a flat triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatFace {
    /// Square to its edges, twice the area long.
    pub(crate) normal: DVec3,
    /// Twice its area.
    pub(crate) length: f64,
    /// Its normal as channels see it, for each cell face of its area.
    pub(crate) per_area: DVec3,
    /// Anything that points like that.
    pub(crate) direction: DVec3,
}

impl FlatFace {
    /// `direction` as that of [`Face::direction`](crate::surface::Face::direction).
    #[inline(always)]
    pub(crate) fn new(normal: DVec3, (direction, is_doubled_area): (DVec3, bool)) -> Self {
        let length = normal.length();
        let per_area = match is_doubled_area {
            true if length > 0.0 => direction * (1.0 / length),
            true => DVec3::ZERO,
            false => direction,
        };
        Self { normal, length, per_area, direction }
    }

    /// A part of it.
    #[inline(always)]
    pub(crate) fn piece(&self, area: f64) -> FlatPiece {
        FlatPiece::new(area, area * self.per_area, self.direction)
    }
}
