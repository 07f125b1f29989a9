//! From the triangles of a brick to its cells and their values.

use glam::{DVec3, IVec3, UVec3};
use rayon::prelude::*;

use crate::areas::Areas;
use crate::cell_sums::{self, Closed, FlatFace, MERGED};
use crate::channels::{Accumulator, FlatPiece, FlatWriter, Fragment, Values};
use crate::coverage::{self, CellBox, Coverage, Triangle};
use crate::fragment::{self, Piece};
use crate::job::Job;
use crate::sparse::{CELLS, Mask, SHIFT, SIDE};
use crate::surface::Face;

/// Triangles of one mesh in one brick, and sums of others.
#[derive(Clone, Copy)]
pub(crate) struct Batch<'a> {
    pub(crate) mesh: usize,
    pub(crate) triangles: &'a [u32],
    /// Cells that are marked already.
    pub(crate) mask: &'a Mask,
    /// Their sums, if there are any.
    pub(crate) sums: &'a [FlatPiece],
    pub(crate) closed: &'a [Closed],
}

/// A brick with more triangles than this is shared among threads.
const SHARE: usize = 4096;

/// What a thread works with.
pub(crate) struct Worker<'a> {
    job: &'a Job<'a>,
    sums: Accumulator<'a>,
    values: Vec<[f32; 4]>,
    fixed: Vec<[i64; 4]>,
    /// Material of the flat triangles that are being summed.
    constants: Option<usize>,
    areas: Areas,
    /// Sums of a brick from several chunks.
    merged: Vec<FlatPiece>,
    writer: FlatWriter,
}

impl<'a> Worker<'a> {
    pub(crate) fn new(job: &'a Job<'a>) -> Self {
        let count = job.channels.len();
        let sums = Accumulator::new(job.channels);
        Self {
            job,
            sums,
            values: vec![[0.0; 4]; count],
            fixed: vec![[0; 4]; count],
            constants: None,
            areas: Areas::default(),
            merged: vec![FlatPiece::NOTHING; CELLS],
            writer: FlatWriter::default(),
        }
    }

    /// Marks the cells of a brick in `mask`, beside those that are, and appends the values of all that are marked.
    pub(crate) fn brick(
        &mut self,
        brick: UVec3,
        batches: &[Batch<'_>],
        mask: &mut Mask,
        results: &mut [Values],
    ) {
        if let Some(face) = self.one_face(batches) {
            return self.write_sums(&face, batches, mask, results);
        }
        let count: usize = batches.iter().map(|batch| batch.triangles.len()).sum();
        if count > 2 * SHARE {
            self.shared(brick, batches, mask);
        } else {
            batches.iter().for_each(|batch| self.batch(brick, batch, mask));
        }
        if self.job.channels.is_empty() {
            return;
        }
        for (z, &word) in mask.iter().enumerate() {
            let mut word = word;
            while word != 0 {
                self.sums.take(64 * z + word.trailing_zeros() as usize, results);
                word &= word - 1;
            }
        }
    }

    /// What the faces of a brick have in common that holds nothing but sums of flat triangles, all of one material.
    fn one_face(&self, batches: &[Batch<'_>]) -> Option<Face<'a>> {
        let is_summed = |batch: &Batch<'_>| {
            !batch.sums.is_empty() && batch.closed.is_empty() && batch.triangles.is_empty()
        };
        let (first, rest) = batches.split_first()?;
        if !batches.iter().all(is_summed) || batches.len() > MERGED {
            return None;
        }
        let face = Face::flat(self.job, first.mesh)?;
        let is_alike = |batch: &Batch<'_>| {
            batch.mesh == first.mesh
                || Face::flat(self.job, batch.mesh).is_some_and(|other| other.constants() == face.constants())
        };
        rest.iter().all(is_alike).then_some(face)
    }

    /// Appends the values of such a brick.
    fn write_sums(&mut self, face: &Face<'_>, batches: &[Batch<'_>], mask: &Mask, results: &mut [Values]) {
        let Self { job, fixed, merged, writer, .. } = self;
        face.shade_flat(job.channels, fixed);
        if let [batch] = batches {
            return writer.write(job.channels, fixed, batch.sums.iter(), results);
        }
        let mut seen: Mask = [0; SIDE as usize];
        for batch in batches {
            for (cell, sum) in cell_sums::cells(batch.mask).zip(batch.sums) {
                if seen[cell >> 6] >> (cell & 63) & 1 == 1 {
                    merged[cell].add(sum);
                } else {
                    merged[cell] = *sum;
                }
            }
            seen.iter_mut().zip(batch.mask).for_each(|(a, b)| *a |= b);
        }
        let merged = &*merged;
        writer.write(job.channels, fixed, cell_sums::cells(mask).map(|cell| &merged[cell]), results);
    }

    /// Many triangles, in parts that go to threads; sums are integers, so that it does not matter which.
    fn shared(&mut self, brick: UVec3, batches: &[Batch<'_>], mask: &mut Mask) {
        for batch in batches.iter().filter(|batch| !batch.sums.is_empty()) {
            self.batch(brick, &Batch { triangles: &[], ..*batch }, mask);
        }
        let parts: Vec<Batch<'_>> = batches
            .iter()
            .flat_map(|batch| {
                let triangles = batch.triangles.chunks(SHARE);
                triangles.map(|triangles| Batch { triangles, sums: &[], closed: &[], ..*batch })
            })
            .collect();
        // Groups of parts, so that small batches do not each bring sums of their own.
        let group = parts.len().div_ceil(4 * rayon::current_num_threads()).max(1);
        let done: Vec<(Mask, Accumulator<'_>)> = parts
            .par_chunks(group)
            .map(|parts| {
                let mut worker = Worker::new(self.job);
                let mut mask = [0; SIDE as usize];
                parts.iter().for_each(|part| worker.batch(brick, part, &mut mask));
                worker.sums.settle();
                (mask, worker.sums)
            })
            .collect();
        self.sums.settle();
        for (part, sums) in &done {
            mask.iter_mut().zip(part).for_each(|(a, b)| *a |= b);
            self.sums.merge(sums);
        }
    }

    fn batch(&mut self, brick: UVec3, batch: &Batch<'_>, mask: &mut Mask) {
        let low = brick.as_ivec3() << SHIFT;
        let cells = CellBox { low, high: low + (SIDE as i32 - 1) };
        let cells = cells.intersection(&CellBox::of_grid(self.job.dims()));
        let flat = Face::flat(self.job, batch.mesh);
        if let (Some(face), false) = (&flat, batch.sums.is_empty()) {
            self.begin_flat(face);
            let sums = cell_sums::cells(batch.mask).zip(batch.sums);
            sums.for_each(|(cell, sum)| self.sums.add_flat(cell, sum));
            batch.closed.iter().for_each(|closed| self.sums.add_flat(closed.cell as usize, &closed.sum));
        }
        for &number in batch.triangles {
            if self.job.needs_fragments {
                self.fragments(&cells, (batch.mesh, number), flat.as_ref(), mask);
            } else if let Some(reach) = self.job.reach(batch.mesh, number) {
                let triangle = self.job.triangle(batch.mesh, number, reach.cells());
                coverage::walk(self.job.coverage, &triangle, &cells, &mut |cell| {
                    let local = (cell - low).as_uvec3();
                    mask[local.z as usize] |= 1 << (local.x + SIDE * local.y);
                });
            }
        }
    }

    /// `flat` stands for the faces of the mesh, if they are flat but for their normals.
    fn fragments(
        &mut self,
        cells: &CellBox,
        (mesh, number): (usize, u32),
        flat: Option<&Face<'_>>,
        mask: &mut Mask,
    ) {
        let job = self.job;
        let Some(reach) = job.reach(mesh, number) else { return };
        let triangle = job.triangle(mesh, number, reach.cells());
        let normal = triangle.normal();
        if let Some(face) = flat
            && let Some(direction) = face.direction_of(number, normal, job.asked.normal)
        {
            self.begin_flat(face);
            return self.flat(cells, &triangle, normal, direction, mask);
        }
        let face = Face::new(job, mesh, number, normal);
        if !face.varies && job.takes_flat {
            self.begin_flat(&face);
            return self.flat(cells, &triangle, normal, face.direction(), mask);
        }
        let nothing = Piece { area: 0.0, point: DVec3::ZERO };
        if !face.varies {
            face.shade(job, &triangle, &nothing, &mut self.values, &mut self.fixed);
        }
        let needs_point = face.varies || job.parts.point;
        self.areas.begin(normal, normal.length());
        coverage::walk(job.coverage, &triangle, cells, &mut |cell: IVec3| {
            let piece = match job.coverage {
                Coverage::Sampled => coverage::sample(&triangle, cell),
                _ if needs_point => fragment::in_cell(&triangle, cell),
                _ if job.parts.area => Piece { area: self.areas.in_cell(&triangle, cell), ..nothing },
                _ => nothing,
            };
            if face.varies && !face.shade(job, &triangle, &piece, &mut self.values, &mut self.fixed) {
                return;
            }
            self.sums.add(&Fragment {
                cell: mark(mask, cells, cell),
                area: piece.area,
                distance: if needs_point {
                    piece.point.distance_squared(cell.as_dvec3() + 0.5) as f32
                } else {
                    0.0
                },
                values: &self.values,
                fixed: &self.fixed,
            });
        });
    }

    /// From now on flat triangles are like this one.
    #[inline]
    fn begin_flat(&mut self, face: &Face<'_>) {
        if self.constants != Some(face.constants()) {
            self.constants = Some(face.constants());
            face.shade_flat(self.job.channels, &mut self.fixed);
            self.sums.set_flat(&self.fixed);
        }
    }

    /// A triangle with one colour and one normal, in channels of averages; `direction` is that of [`Face::direction`].
    #[inline]
    fn flat(
        &mut self,
        cells: &CellBox,
        triangle: &Triangle,
        normal: DVec3,
        direction: (DVec3, bool),
        mask: &mut Mask,
    ) {
        let face = FlatFace::new(normal, direction);
        self.areas.begin(normal, face.length);
        let Self { job, areas, sums, .. } = self;
        match job.coverage {
            Coverage::Sampled => {
                let piece = face.piece(areas.under_one_sample());
                coverage::walk(Coverage::Sampled, triangle, cells, &mut |cell| {
                    sums.add_flat(mark(mask, cells, cell), &piece);
                });
            }
            // One place for the work on a cell: the walk has many where it finds one.
            exact_or_thin => coverage::walk(exact_or_thin, triangle, cells, &mut |cell| {
                add_part(areas, sums, mask, (triangle, cells), cell, &face);
            }),
        }
    }
}

/// Adds the part of a flat triangle in one cell.
#[inline(never)]
fn add_part(
    areas: &mut Areas,
    sums: &mut Accumulator<'_>,
    mask: &mut Mask,
    (triangle, cells): (&Triangle, &CellBox),
    cell: IVec3,
    face: &FlatFace,
) {
    let area = areas.in_cell(triangle, cell);
    sums.add_flat(mark(mask, cells, cell), &face.piece(area));
}

/// Marks a cell of the brick whose first cell is `cells.low`, and returns its number in it.
#[inline(always)]
fn mark(mask: &mut Mask, cells: &CellBox, cell: IVec3) -> usize {
    let local = (cell - cells.low).as_uvec3();
    let bit = local.x + SIDE * local.y;
    mask[local.z as usize] |= 1 << bit;
    (64 * local.z + bit) as usize
}
