//! Flat triangles, all of one colour, to cells and their values.
//!
//! To find the cells of such a triangle takes as long as to sum what it leaves there: an area and an area times a normal
//! for each cell, as integers, so that no order matters. Most triangles are small. They are looked at once, where they
//! come in the mesh, and summed in the cells that their neighbours have just been summed in ([`cells`]). Large ones, and
//! all of a mesh whose triangles come in no order, are sorted into blocks of 32 x 32 x 32 cells, of which a surface touches
//! few enough that their sums stay in a processor's cache ([`blocks`]). Blocks then take what both have.

mod blocks;
mod cells;

use std::sync::atomic::Ordering;

use glam::IVec3;

use crate::areas::Areas;
use crate::binning::{Bins, Budget, Builder};
use crate::channels::FlatPiece;
use crate::coverage::{CellBox, Coverage};
use crate::job::{Chunk, Job, Reached};
use crate::surface::{Face, FlatFace};
pub(crate) use blocks::{BLOCK_SHIFT, BlockWorker, Part};
use cells::CellSums;
pub(crate) use cells::{BrickSums, SumList};

/// Triangles that reach fewer cells than this along each axis are small.
const SMALL: i32 = 8;
/// Sums are put aside before their normals could overflow: at 256 cell faces.
const LONGEST: i64 = 1 << 30;

/// What a thread works with.
#[derive(Debug)]
pub(crate) struct ChunkWorker {
    areas: Areas,
    sums: CellSums,
}

impl ChunkWorker {
    pub(crate) fn new(job: &Job<'_>) -> Self {
        Self { areas: Areas::default(), sums: CellSums::new(job.dims()) }
    }

    /// As [`binning::bin`](crate::binning::bin), in blocks: sums the small triangles of a chunk, and lists the others.
    pub(crate) fn bin(
        &mut self,
        job: &Job<'_>,
        chunk: &Chunk,
        slab: &CellBox,
        budget: &Budget,
    ) -> Option<Bins> {
        let cells = slab.finer(BLOCK_SHIFT).intersection(&CellBox::of_grid(job.dims()));
        let face = Face::flat(job, chunk.mesh)?;
        let Self { areas, sums } = self;
        let mut builder = Builder::new(job.along());
        let mut list = SumList::default();
        let mut skipped = 0;
        let mut sums_here = budget.has_room_for_sums();
        for number in chunk.triangles.clone() {
            let Some(reach) = job.reach(chunk.mesh, number) else {
                skipped += 1;
                continue;
            };
            if sums_here && is_small(&reach) {
                let triangle = (chunk.mesh, number);
                for_each_piece(job, areas, &face, triangle, &reach, &cells, |cell, piece| sums.add(cell, piece));
                if sums.is_full() {
                    // Neighbours that are far apart are better sorted.
                    sums_here = sums.is_dense();
                    sums.flush(&mut list);
                    sums_here &= budget.has_room_for_sums();
                }
                continue;
            }
            builder.push_all(job, (chunk.mesh, number), &reach, &cells);
            if !budget.takes(&mut builder, false) {
                sums.clear();
                return None;
            }
        }
        sums.flush(&mut list);
        budget.sums.fetch_add(list.bytes(), Ordering::Relaxed);
        let is_room = budget.takes(&mut builder, true);
        is_room.then(|| builder.finish(skipped, list))
    }
}

fn is_small(reach: &Reached) -> bool {
    match reach {
        Reached::One(_) => true,
        Reached::Box(CellBox { low, high }) => (high - low).max_element() < SMALL,
    }
}

/// Calls `add` for each cell of `cells` that a triangle marks, with its piece there. What comes is the same whatever the
/// cells, so that parts of the grid may be worked out apart: of a small triangle all is looked at, of a large one what lies
/// in the block that `cells` are.
#[inline(always)]
fn for_each_piece(
    job: &Job<'_>,
    areas: &mut Areas,
    face: &Face<'_>,
    (mesh, number): (usize, u32),
    reach: &Reached,
    cells: &CellBox,
    mut add: impl FnMut(IVec3, &FlatPiece),
) {
    let triangle = job.triangle(mesh, number, reach.cells());
    let normal = triangle.normal();
    let Some(direction) = face.direction_of(number, normal, job.asked.normal) else { return };
    if let (Coverage::Exact, Reached::One(cell)) = (job.coverage, reach) {
        let cell = cell.cell();
        if cells.contains(cell) {
            add(cell, &FlatFace::whole(normal, direction));
        }
        return;
    }
    let face = FlatFace::new(normal, direction);
    let plane = (normal, face.length);
    if is_small(reach) {
        let all = CellBox::of_grid(job.dims());
        areas.for_each(job.coverage, &triangle, plane, &all, |cell, area| {
            if cells.contains(cell) {
                add(cell, &face.piece(area));
            }
        });
    } else {
        areas.for_each(job.coverage, &triangle, plane, cells, |cell, area| add(cell, &face.piece(area)));
    }
}
