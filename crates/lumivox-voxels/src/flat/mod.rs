//! Flat triangles, each of one colour, to cells and their values.
//!
//! To find the cells of such a triangle takes as long as to sum what it leaves there: an area and an area times a normal
//! for each cell, as integers, so that no order matters. Most triangles are small. They are looked at once, where they
//! come in the mesh, and summed in the cells that their neighbours have just been summed in ([`cells`]). Large ones, and
//! those of meshes where cells have few triangles or neighbours are far apart, are sorted into blocks of 32 x 32 x 32
//! cells, of which a surface touches few enough that their sums stay in a processor's cache ([`blocks`]). Blocks then
//! take what both have, and where colours meet in a block they take one after the other ([`mixed`]). Triangles are sorted
//! by colour beforehand ([`colors`]), so that a chunk has one.

mod blocks;
mod cells;
mod colors;
mod mixed;

use glam::{DVec3, IVec3};

use crate::areas::Areas;
use crate::binning::{Bins, Budget, Builder};
use crate::channels::FlatPiece;
use crate::coverage::{CellBox, Coverage, Triangle, normal_of};
use crate::job::{Chunk, Job, Reached};
use crate::placement::PackedCell;
use crate::surface::{Face, FlatFace};
pub(crate) use blocks::{BLOCK_SHIFT, BlockWorker, Part};
use cells::CellSums;
pub(crate) use cells::{BrickSums, SumList};
pub(crate) use colors::Colors;

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

    /// As [`binning::bin`](crate::binning::bin), in blocks: sums the small triangles of a chunk, all of one colour, and
    /// lists the others.
    pub(crate) fn bin(
        &mut self,
        job: &Job<'_>,
        chunk: &Chunk,
        slab: &CellBox,
        budget: &Budget,
    ) -> Option<Bins> {
        let cells = slab.finer(BLOCK_SHIFT).intersection(&CellBox::of_grid(job.dims()));
        let order = job.colors.as_ref().and_then(|colors| colors.order(chunk.mesh));
        let number_of = |n: u32| order.map_or(n, |order| order[n as usize]);
        let face =
            Face::plain(job, chunk.mesh, job.material_of(chunk.mesh, number_of(chunk.triangles.start)))?;
        let Self { areas, sums } = self;
        let mut builder = Builder::new(job.along());
        let mut list = SumList::default();
        let mut skipped = 0;
        let mut has_room = budget.has_room_for_sums(0);
        let mut pays = true;
        let mut ahead = Ahead::new();
        for place in chunk.triangles.clone() {
            let n = (place - chunk.triangles.start) as usize % AHEAD;
            if n == 0 {
                ahead.fetch(job, chunk.mesh, (place..chunk.triangles.end).map(number_of));
            }
            let number = number_of(place);
            let flat = &ahead.0[n];
            let Some(reach) = Reached::of(flat.cells) else {
                skipped += 1;
                continue;
            };
            // What reaches several blocks would be looked at in each.
            if has_room && is_small(&reach) && (pays || !is_in_one_block(&reach)) {
                let triangle = (number, &reach, flat);
                for_each_piece(job, areas, &face, triangle, &cells, |cell, piece| sums.add(cell, piece));
                if sums.is_full() {
                    pays &= sums.pays();
                    has_room = budget.has_room_for_sums(sums.flush(&mut list));
                }
                continue;
            }
            builder.push_all(job, (chunk.mesh, number), &reach, &cells);
            if !budget.takes(&mut builder, false) {
                sums.clear();
                return None;
            }
        }
        budget.has_room_for_sums(sums.flush(&mut list));
        budget.takes(&mut builder, true).then(|| builder.finish(skipped, list))
    }
}

/// How many triangles are fetched at a time.
const AHEAD: usize = 64;

/// A flat triangle.
#[derive(Clone, Copy)]
struct Flat {
    cells: [PackedCell; 3],
    corners: [DVec3; 3],
    normal: DVec3,
    length: f64,
}

impl Flat {
    const NONE: Self =
        Self { cells: [PackedCell::NONE; 3], corners: [DVec3::ZERO; 3], normal: DVec3::ZERO, length: 0.0 };

    #[inline(always)]
    fn new(job: &Job<'_>, mesh: usize, number: u32, corner: impl Fn(&[f32; 3]) -> DVec3) -> Self {
        let view = &job.model.meshes[mesh].triangles;
        let at = |n: u32| corner(view.positions.get(n as usize).unwrap_or(&[0.0; 3]));
        let [a, b, c] = view.indices[number as usize];
        let corners = [at(a), at(b), at(c)];
        let normal = normal_of(corners);
        Self { cells: job.cells_of(mesh, number), corners, normal, length: normal.length() }
    }
}

/// Triangles that come next. Vertices are in no order that a processor foresees: so many are fetched in one go that it
/// waits for all of them together.
struct Ahead([Flat; AHEAD]);

impl Ahead {
    fn new() -> Self {
        Self([Flat::NONE; AHEAD])
    }

    /// Some triangles of a mesh, as many as there is room for.
    #[inline(always)]
    fn fetch(&mut self, job: &Job<'_>, mesh: usize, numbers: impl Iterator<Item = u32>) -> &[Flat; AHEAD] {
        let placement = &job.placements[mesh];
        let all = numbers.zip(&mut self.0);
        match placement.scaled() {
            Some(scaled) => all.for_each(|(n, flat)| *flat = Flat::new(job, mesh, n, |p| scaled.corner(p))),
            None => all.for_each(|(n, flat)| *flat = Flat::new(job, mesh, n, |p| placement.corner(p))),
        }
        &self.0
    }
}

fn is_in_one_block(reach: &Reached) -> bool {
    match reach {
        Reached::One(_) => true,
        Reached::Box(cells) => {
            let CellBox { low, high } = cells.coarser(BLOCK_SHIFT);
            low == high
        }
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
    (number, reach, flat): (u32, &Reached, &Flat),
    cells: &CellBox,
    mut add: impl FnMut(IVec3, &FlatPiece),
) {
    let (normal, length) = (flat.normal, flat.length);
    let Some(direction) = face.direction_of(number, normal, job.asked.normal) else { return };
    if let (Coverage::Exact, Reached::One(cell)) = (job.coverage, reach) {
        let cell = cell.cell();
        if cells.contains(cell) {
            add(cell, &FlatFace::whole(length, direction));
        }
        return;
    }
    let triangle = Triangle { corners: flat.corners, reach: reach.cells() };
    let face = FlatFace::new(length, direction);
    let plane = (normal, length);
    if !is_small(reach) {
        areas.for_each(job.coverage, &triangle, plane, cells, |cell, area| add(cell, &face.piece(area)));
        return;
    }
    let all = CellBox::of_grid(job.dims());
    let is_within = triangle.reach.intersection(cells) == triangle.reach;
    areas.for_each(job.coverage, &triangle, plane, &all, |cell, area| {
        if is_within || cells.contains(cell) {
            add(cell, &face.piece(area));
        }
    });
}
