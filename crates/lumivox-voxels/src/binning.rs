//! From triangles to bricks: which triangles each brick has to look at.
//!
//! A chunk of triangles at a time, each thread for itself. A triangle goes to the bricks that it touches, found by the
//! same walk that finds cells, on a grid of bricks. Where only occupancy is wanted, triangles of few bricks mark their
//! cells at once, and no list is needed.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{IVec3, UVec3};

use crate::coverage::{self, CellBox, Coverage};
use crate::job::{Chunk, Job, Reached};
use crate::sparse::{Directory, Mask, SHIFT, SIDE, brick_index, bricks_along};

/// Triangles that reach more bricks than this leave their cells to the stage that works brick by brick, so that one
/// large triangle keeps all threads busy.
const FEW_BRICKS: i32 = 8;

/// Lists of one chunk.
pub(crate) struct Bins {
    /// Linear indices of the bricks, in no order.
    pub(crate) bricks: Vec<u32>,
    /// For each brick the cells that are already marked; empty if fragments are needed.
    pub(crate) masks: Vec<Mask>,
    /// For each brick the start of its triangles, and their number at the end.
    starts: Vec<u32>,
    /// Triangles, by number in their mesh.
    items: Vec<u32>,
    /// Triangles that were not finite or named no vertex.
    pub(crate) skipped: u64,
}

impl Bins {
    /// The triangles of brick number `n` of this chunk.
    pub(crate) fn items(&self, n: u32) -> &[u32] {
        &self.items[self.starts[n as usize] as usize..self.starts[n as usize + 1] as usize]
    }
}

/// The bricks that a chunk is about to fill.
struct Builder {
    along: UVec3,
    directory: Directory,
    bricks: Vec<u32>,
    masks: Vec<Mask>,
    counts: Vec<u32>,
    pairs: Vec<[u32; 2]>,
    last: (IVec3, u32),
}

impl Builder {
    fn new(dims: UVec3) -> Self {
        let along = bricks_along(dims);
        Self {
            along,
            directory: Directory::new(along),
            bricks: Vec::new(),
            masks: Vec::new(),
            counts: Vec::new(),
            pairs: Vec::new(),
            last: (IVec3::splat(-1), 0),
        }
    }

    /// The number of a brick in this chunk. Triangles come in neighbourhoods, so that the last one is asked first.
    #[inline(always)]
    fn number(&mut self, brick: IVec3) -> usize {
        if brick != self.last.0 {
            self.seek(brick);
        }
        self.last.1 as usize
    }

    /// Not inlined: there are many places where cells are marked, and their code has to stay near.
    #[inline(never)]
    fn seek(&mut self, brick: IVec3) {
        let new = self.bricks.len() as u32;
        let place = brick.as_uvec3();
        let number = self.directory.get_or_insert(place, new);
        if number == new {
            self.bricks.push(brick_index(self.along, place));
            self.masks.push([0; SIDE as usize]);
            self.counts.push(0);
        }
        self.last = (brick, number);
    }

    #[inline]
    fn mark(&mut self, cell: IVec3) {
        let number = self.number(cell >> SHIFT);
        let local = cell & (SIDE as i32 - 1);
        self.masks[number][local.z as usize] |= 1 << (local.x + SIDE as i32 * local.y);
    }

    #[inline]
    fn push(&mut self, brick: IVec3, triangle: u32) {
        let number = self.number(brick);
        self.counts[number] += 1;
        self.pairs.push([number as u32, triangle]);
    }

    /// Sorts the pairs by brick.
    fn finish(self, keeps_masks: bool, skipped: u64) -> Bins {
        let mut starts = Vec::with_capacity(self.counts.len() + 1);
        let mut sum = 0;
        for count in self.counts {
            starts.push(sum);
            sum += count;
        }
        starts.push(sum);
        let mut next = starts.clone();
        let mut items = vec![0; self.pairs.len()];
        for [number, triangle] in self.pairs {
            let place = &mut next[number as usize];
            items[*place as usize] = triangle;
            *place += 1;
        }
        let masks = if keeps_masks { self.masks } else { Vec::new() };
        Bins { bricks: self.bricks, masks, starts, items, skipped }
    }
}

/// Sorts a chunk into the bricks of `slab`; none if, with what other chunks have counted in `pairs`, there would be more
/// than `budget` pairs of triangle and brick.
pub(crate) fn bin(
    job: &Job<'_>,
    chunk: &Chunk,
    slab: &CellBox,
    pairs: &AtomicU64,
    budget: u64,
) -> Option<Bins> {
    let mut builder = Builder::new(job.dims());
    let cells = CellBox { low: slab.low << SHIFT, high: (slab.high << SHIFT) + (SIDE as i32 - 1) };
    let cells = cells.intersection(&CellBox::of_grid(job.dims()));
    // A triangle in one cell marks it, whatever its shape.
    let marks_one = !job.needs_fragments && job.coverage == Coverage::Exact;
    let mut last_one = None;
    let mut skipped = 0;
    let mut counted = 0;
    for number in chunk.triangles.clone() {
        let Some(reach) = job.reach(chunk.mesh, number) else {
            skipped += 1;
            continue;
        };
        if let (true, Reached::One(cell)) = (marks_one, &reach) {
            // Triangles come in neighbourhoods, and the last one's cell is marked already.
            if last_one != Some(*cell) {
                last_one = Some(*cell);
                let cell = cell.cell();
                if cells.contains(cell) {
                    builder.mark(cell);
                }
            }
            continue;
        }
        let reach = reach.cells();
        let within = reach.intersection(&cells);
        if within.is_empty() {
            continue;
        }
        let bricks = within.coarser(SHIFT);
        let extent = bricks.high - bricks.low + 1;
        let count = extent.element_product();
        if !job.needs_fragments && count <= FEW_BRICKS {
            let triangle = job.triangle(chunk.mesh, number, reach);
            coverage::walk(job.coverage, &triangle, &within, &mut |cell| builder.mark(cell));
        } else if count == 1 {
            builder.push(bricks.low, number);
        } else {
            // All coverages lie inside the exact one.
            let coarse = job.triangle(chunk.mesh, number, reach).coarser(SHIFT);
            coverage::walk(Coverage::Exact, &coarse, &bricks, &mut |brick| builder.push(brick, number));
        }
        // Counted now and then, since one triangle may have a hundred thousand bricks.
        if builder.pairs.len() - counted > 4096 {
            let new = (builder.pairs.len() - counted) as u64;
            counted = builder.pairs.len();
            if pairs.fetch_add(new, Ordering::Relaxed) + new > budget {
                return None;
            }
        }
    }
    let new = (builder.pairs.len() - counted) as u64;
    if pairs.fetch_add(new, Ordering::Relaxed) + new > budget {
        return None;
    }
    Some(builder.finish(!job.needs_fragments, skipped))
}
