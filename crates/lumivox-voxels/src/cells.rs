//! From the triangles of a brick to its cells and their values.

use glam::{DVec3, IVec3, UVec3};
use rayon::prelude::*;

use crate::areas::{self, Areas};
use crate::channels::{Accumulator, Fragment, Values};
use crate::coverage::{self, CellBox, Coverage, Triangle};
use crate::fragment::{self, Piece};
use crate::job::Job;
use crate::sparse::{Mask, SHIFT, SIDE};
use crate::surface::{Face, FlatFace};

/// Triangles of one mesh in one brick.
#[derive(Clone, Copy)]
pub(crate) struct Batch<'a> {
    pub(crate) mesh: usize,
    pub(crate) triangles: &'a [u32],
}

/// A brick with more triangles than this is shared among threads.
pub(crate) const SHARE: usize = 4096;

/// What a thread works with.
pub(crate) struct Worker<'a> {
    job: &'a Job<'a>,
    sums: Accumulator<'a>,
    values: Vec<[f32; 4]>,
    fixed: Vec<[i64; 4]>,
    /// Material of the flat triangles that are being summed.
    constants: Option<usize>,
    areas: Areas,
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

    /// Many triangles, in parts that go to threads; sums are integers, so that it does not matter which.
    fn shared(&mut self, brick: UVec3, batches: &[Batch<'_>], mask: &mut Mask) {
        let parts: Vec<Batch<'_>> = batches
            .iter()
            .flat_map(|batch| {
                let triangles = batch.triangles.chunks(SHARE);
                triangles.map(|triangles| Batch { triangles, ..*batch })
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
        let Self { sums, values, fixed, areas, .. } = self;
        let mut add = |cell: IVec3, piece: Piece| {
            if face.varies && !face.shade(job, &triangle, &piece, values, fixed) {
                return;
            }
            sums.add(&Fragment {
                cell: mark(mask, cells, cell),
                area: piece.area,
                distance: if needs_point {
                    piece.point.distance_squared(cell.as_dvec3() + 0.5) as f32
                } else {
                    0.0
                },
                values,
                fixed,
            });
        };
        let is_sampled = job.coverage == Coverage::Sampled;
        if !is_sampled && !needs_point && job.parts.area {
            let plane = (normal, normal.length());
            areas.for_each(job.coverage, &triangle, plane, cells, |cell, area| {
                add(cell, Piece { area, ..nothing });
            });
            return;
        }
        coverage::walk(job.coverage, &triangle, cells, &mut |cell: IVec3| {
            let piece = match () {
                () if is_sampled => coverage::sample(&triangle, cell),
                () if needs_point => fragment::in_cell(&triangle, cell),
                () => nothing,
            };
            add(cell, piece);
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
        let length = normal.length();
        let face = FlatFace::new(length, direction);
        let Self { job, areas, sums, .. } = self;
        if job.coverage == Coverage::Sampled {
            let piece = face.piece(areas::under_one_sample(normal));
            coverage::walk(Coverage::Sampled, triangle, cells, &mut |cell| {
                sums.add_flat(mark(mask, cells, cell), &piece);
            });
            return;
        }
        areas.for_each(job.coverage, triangle, (normal, length), cells, |cell, area| {
            sums.add_flat(mark(mask, cells, cell), &face.piece(area));
        });
    }
}

/// Marks a cell of the brick whose first cell is `cells.low`, and returns its number in it.
#[inline(always)]
fn mark(mask: &mut Mask, cells: &CellBox, cell: IVec3) -> usize {
    let local = (cell - cells.low).as_uvec3();
    let bit = local.x + SIDE * local.y;
    mask[local.z as usize] |= 1 << bit;
    (64 * local.z + bit) as usize
}
