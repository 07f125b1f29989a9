//! From triangles to bricks: which triangles each brick has to look at.
//!
//! A chunk of triangles at a time, each thread for itself. A triangle goes to the bricks that it touches, found by the
//! same walk that finds cells, on a grid of bricks, or of the larger blocks that flat triangles are summed in
//! ([`flat`](crate::flat)). Where only occupancy is wanted, triangles of few bricks mark their cells at once, and no list
//! is needed.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{IVec3, UVec3};

use crate::coverage::{self, CellBox, Coverage};
use crate::flat::SumList;
use crate::job::{Chunk, Job, Reached};
use crate::sparse::{Directory, Mask, SHIFT, SIDE, brick_index};

/// Triangles that reach more bricks than this leave their cells to the stage that works brick by brick, so that one
/// large triangle keeps all threads busy.
const FEW_BRICKS: i32 = 8;

/// What the lists of all chunks may take.
pub(crate) struct Budget {
    most: u64,
    pairs: AtomicU64,
    /// Bytes of sums.
    sums: AtomicU64,
}

impl Budget {
    /// A quarter of the memory allowed for pairs, and as much for sums, beyond which a thread may go by what it has at a
    /// time.
    pub(crate) fn new(memory_limit: u64) -> Self {
        Self { most: memory_limit / 4, pairs: AtomicU64::new(0), sums: AtomicU64::new(0) }
    }

    /// Whether there may be more sums after so many bytes of them.
    pub(crate) fn has_room_for_sums(&self, bytes: u64) -> bool {
        self.sums.fetch_add(bytes, Ordering::Relaxed) + bytes < self.most
    }

    /// Whether the pairs that a chunk has made fit with those of others. Asked for each triangle, since one may have a
    /// hundred thousand bricks, and looked at now and then, or at the end.
    #[inline]
    pub(crate) fn takes(&self, builder: &mut Builder, at_end: bool) -> bool {
        let new = builder.pairs.len() - builder.counted;
        if !at_end && new <= 4096 {
            return true;
        }
        builder.counted = builder.pairs.len();
        let pairs = self.pairs.fetch_add(new as u64, Ordering::Relaxed) + new as u64;
        pairs <= self.most / PAIR_BYTES
    }

    /// Without room for sums.
    #[cfg(test)]
    pub(crate) fn of_pairs(memory_limit: u64) -> Self {
        Self { sums: AtomicU64::new(memory_limit), ..Self::new(memory_limit) }
    }

    /// Bytes of memory with which the pairs so far would have fitted.
    pub(crate) fn needed(&self) -> u64 {
        4 * PAIR_BYTES * self.pairs.load(Ordering::Relaxed)
    }
}

/// A pair of triangle and brick takes eight bytes while it is made and four more when it is sorted.
const PAIR_BYTES: u64 = 12;

/// Lists of one chunk.
pub(crate) struct Bins {
    /// Linear indices of the bricks, in no order.
    pub(crate) bricks: Vec<u32>,
    /// For each brick the cells that are already marked.
    pub(crate) masks: Vec<Mask>,
    /// For each brick the start of its triangles, and their number at the end.
    starts: Vec<u32>,
    /// Triangles, by number in their mesh.
    items: Vec<u32>,
    /// Triangles that were not finite or named no vertex.
    pub(crate) skipped: u64,
    /// What flat triangles that are in no list have left.
    pub(crate) sums: SumList,
}

impl Bins {
    /// The triangles of brick number `n` of this chunk.
    pub(crate) fn items(&self, n: u32) -> &[u32] {
        &self.items[self.starts[n as usize] as usize..self.starts[n as usize + 1] as usize]
    }
}

/// The bricks that a chunk is about to fill.
pub(crate) struct Builder {
    along: UVec3,
    directory: Directory,
    bricks: Vec<u32>,
    masks: Vec<Mask>,
    pairs: Vec<[u32; 2]>,
    /// Pairs that a budget knows of.
    counted: usize,
    last: (IVec3, u32),
}

impl Builder {
    pub(crate) fn new(along: UVec3) -> Self {
        Self {
            along,
            directory: Directory::new(along),
            bricks: Vec::new(),
            masks: Vec::new(),
            pairs: Vec::new(),
            counted: 0,
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
        self.pairs.push([number as u32, triangle]);
    }

    /// Lists a triangle in all bricks, or blocks, that it reaches in `cells`.
    #[inline]
    pub(crate) fn push_all(
        &mut self,
        job: &Job<'_>,
        (mesh, number): (usize, u32),
        reach: &Reached,
        cells: &CellBox,
    ) {
        let shift = job.shift();
        let reach = reach.cells();
        let within = reach.intersection(cells);
        if within.is_empty() {
            return;
        }
        let bricks = within.coarser(shift);
        let extent = bricks.high - bricks.low + 1;
        let count = extent.element_product();
        if count <= 2 {
            // Its corners lie in both.
            self.push(bricks.low, number);
            if count == 2 {
                self.push(bricks.high, number);
            }
        } else {
            // All coverages lie inside the exact one.
            let coarse = job.triangle(mesh, number, reach).coarser(shift);
            coverage::walk(Coverage::Exact, &coarse, &bricks, &mut |brick| self.push(brick, number));
        }
    }

    /// Sorts everything by brick.
    pub(crate) fn finish(self, skipped: u64, sums: SumList) -> Bins {
        let (starts, items) = sorted(self.bricks.len(), self.pairs.iter().map(|&[number, t]| (number, t)));
        Bins { bricks: self.bricks, masks: self.masks, starts, items, skipped, sums }
    }
}

/// Items in the order of their numbers, with the start of each number and the end of the last.
fn sorted<T: Copy>(numbers: usize, items: impl Iterator<Item = (u32, T)> + Clone) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0; numbers + 1];
    items.clone().for_each(|(number, _)| starts[number as usize + 1] += 1);
    for n in 0..numbers {
        starts[n + 1] += starts[n];
    }
    let Some((_, any)) = items.clone().next() else { return (starts, Vec::new()) };
    let mut next = starts.clone();
    let mut sorted = vec![any; starts[numbers] as usize];
    for (number, item) in items {
        let place = &mut next[number as usize];
        sorted[*place as usize] = item;
        *place += 1;
    }
    (starts, sorted)
}

/// Sorts a chunk into the bricks of `slab`; none if there would be more pairs of triangle and brick than the budget has.
pub(crate) fn bin(job: &Job<'_>, chunk: &Chunk, slab: &CellBox, budget: &Budget) -> Option<Bins> {
    let mut builder = Builder::new(job.along());
    let cells = slab.finer(SHIFT).intersection(&CellBox::of_grid(job.dims()));
    // A triangle in one cell marks it, whatever its shape.
    let marks_one = !job.needs_fragments && job.coverage == Coverage::Exact;
    let mut last_one = None;
    let mut skipped = 0;
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
        if !job.needs_fragments {
            let reach = reach.cells();
            let within = reach.intersection(&cells);
            let bricks = within.coarser(SHIFT);
            if (bricks.high - bricks.low + 1).element_product() <= FEW_BRICKS {
                if !within.is_empty() {
                    let triangle = job.triangle(chunk.mesh, number, reach);
                    coverage::walk(job.coverage, &triangle, &within, &mut |cell| builder.mark(cell));
                }
                continue;
            }
        }
        builder.push_all(job, (chunk.mesh, number), &reach, &cells);
        if !budget.takes(&mut builder, false) {
            return None;
        }
    }
    budget.takes(&mut builder, true).then(|| builder.finish(skipped, SumList::default()))
}
