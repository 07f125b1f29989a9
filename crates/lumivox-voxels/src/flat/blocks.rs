//! Blocks of cells: what chunks have summed, and the triangles that they have not.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use super::mixed::MixedSums;
use super::{AHEAD, Ahead, BrickSums, Colors, LONGEST, for_each_piece};
use crate::areas::Areas;
use crate::cells::{Batch, SHARE};
use crate::channels::{FlatPiece, FlatWriter, to_f64, write_mixed};
use crate::coverage::CellBox;
use crate::job::{Job, Reached};
use crate::packet::Packet;
use crate::sparse::{CELLS, Mask, SHIFT, SIDE, bits, brick_index, brick_of, bricks_along};
use crate::surface::Face;

/// Cell coordinates shifted by this are block coordinates.
pub(crate) const BLOCK_SHIFT: u32 = 5;
/// Bricks along each axis of a block, and in it.
const BRICKS_ALONG: u32 = 1 << (BLOCK_SHIFT - SHIFT);
const BRICKS: usize = (BRICKS_ALONG * BRICKS_ALONG * BRICKS_ALONG) as usize;

/// What one chunk has of a block.
#[derive(Clone, Copy)]
pub(crate) enum Part<'a> {
    Triangles(Batch<'a>),
    /// Of one of its bricks.
    Sums(BrickSums<'a>),
}

/// What a thread works with.
pub(crate) struct BlockWorker<'a> {
    job: &'a Job<'a>,
    areas: Areas,
    /// Of each brick and cell; those that are not marked hold anything.
    sums: Vec<[i64; 4]>,
    /// Marked cells, brick after brick.
    marks: [u64; BRICKS * SIDE as usize],
    /// Sums that were put aside, and their cells.
    aside: Vec<(u32, FlatPiece)>,
    writer: FlatWriter,
    mixed: MixedSums,
}

impl<'a> BlockWorker<'a> {
    pub(crate) fn new(job: &'a Job<'a>) -> Self {
        Self {
            job,
            areas: Areas::default(),
            sums: vec![[0; 4]; BRICKS * CELLS],
            marks: [0; BRICKS * SIDE as usize],
            aside: Vec::new(),
            writer: FlatWriter::new(),
            mixed: MixedSums::default(),
        }
    }

    /// Works out a block and appends its bricks; parts come with their colours, and in the order of these.
    pub(crate) fn block(&mut self, block: UVec3, parts: &[(u32, Part<'_>)], packet: &mut Packet) {
        let colors = self.job.colors.as_ref().map_or(&[][..], Colors::values);
        let [Some(first), Some(last)] = [parts.first(), parts.last()] else { return };
        if first.0 == last.0 {
            self.sum(block, parts);
            return self.write(block, colors.get(first.0 as usize).map_or(&[], Vec::as_slice), packet);
        }
        for same in parts.chunk_by(|a, b| a.0 == b.0) {
            self.sum(block, same);
            let Self { mixed, marks, sums, aside, .. } = self;
            mixed.add((same[0].0, colors), marks, sums, aside);
        }
        self.write_mixed(block, colors, packet);
    }

    /// Sums parts of one colour.
    fn sum(&mut self, block: UVec3, parts: &[(u32, Part<'_>)]) {
        let mut batches = Vec::new();
        for (_, part) in parts {
            match part {
                Part::Triangles(batch) => batches.push(*batch),
                Part::Sums(sums) => self.add_all(sums),
            }
        }
        let count: usize = batches.iter().map(|batch| batch.triangles.len()).sum();
        // A worker's sums are a megabyte: sharing pays only where a thread would else be left with more than half of its part.
        let threads = rayon::current_num_threads();
        let fair = self.job.triangle_count() as usize / (2 * threads);
        if threads > 1 && count > fair.max(2 * SHARE) {
            self.shared(block, &batches);
        } else {
            batches.iter().for_each(|batch| self.batch(block, batch));
        }
    }

    /// Many triangles, in parts that go to threads.
    fn shared(&mut self, block: UVec3, batches: &[Batch<'_>]) {
        let parts: Vec<Batch<'_>> = batches
            .iter()
            .flat_map(|batch| batch.triangles.chunks(SHARE).map(|triangles| Batch { triangles, ..*batch }))
            .collect();
        let group = parts.len().div_ceil(rayon::current_num_threads()).max(1);
        let done: Vec<Self> = parts
            .par_chunks(group)
            .map(|parts| {
                let mut worker = Self::new(self.job);
                parts.iter().for_each(|part| worker.batch(block, part));
                worker
            })
            .collect();
        for mut part in done {
            for (n, word) in part.marks.into_iter().enumerate() {
                bits(word).for_each(|bit| self.add(64 * n + bit, &FlatPiece(part.sums[64 * n + bit])));
            }
            self.aside.append(&mut part.aside);
        }
    }

    fn batch(&mut self, block: UVec3, batch: &Batch<'_>) {
        let job = self.job;
        let low = block.as_ivec3() << BLOCK_SHIFT;
        let cells = CellBox { low, high: low + ((1 << BLOCK_SHIFT) - 1) };
        let cells = cells.intersection(&CellBox::of_grid(job.dims()));
        let Some(&any) = batch.triangles.first() else { return };
        let Some(face) = Face::plain(job, batch.mesh, job.material_of(batch.mesh, any)) else { return };
        let mut areas = std::mem::take(&mut self.areas);
        let mut ahead = Ahead::new();
        for numbers in batch.triangles.chunks(AHEAD) {
            let fetched = ahead.fetch(job, batch.mesh, numbers.iter().copied());
            for (&number, flat) in numbers.iter().zip(fetched) {
                if let Some(reach) = Reached::of(flat.cells) {
                    let triangle = (number, &reach, flat);
                    for_each_piece(job, &mut areas, &face, triangle, &cells, |cell, piece| {
                        self.add(place(cell - low), piece);
                    });
                }
            }
        }
        self.areas = areas;
    }

    /// Adds what a chunk has summed.
    fn add_all(&mut self, part: &BrickSums<'_>) {
        let brick = brick_of(bricks_along(self.job.dims()), part.brick) % BRICKS_ALONG;
        let first = CELLS * (brick.x + BRICKS_ALONG * (brick.y + BRICKS_ALONG * brick.z)) as usize;
        let places =
            part.mask.iter().enumerate().flat_map(|(z, &word)| bits(word).map(move |bit| 64 * z + bit));
        places.zip(part.sums).for_each(|(place, sum)| self.add(first + place, &FlatPiece(*sum)));
    }

    /// Adds a piece to the cell at a place, and marks it.
    #[inline(always)]
    fn add(&mut self, place: usize, piece: &FlatPiece) {
        let (word, bit) = (&mut self.marks[place >> 6], place & 63);
        let sum = &mut self.sums[place];
        // What is not marked counts as nothing, without a branch: nobody foresees it.
        let keep = 0i64.wrapping_sub((*word >> bit & 1) as i64);
        let [a, b, c, d] = *sum;
        let [w, x, y, z] = piece.0;
        *word |= 1 << bit;
        if (a & keep) + w >= LONGEST {
            self.aside.push((place as u32, FlatPiece([a & keep, b & keep, c & keep, d & keep])));
            *sum = piece.0;
            return;
        }
        *sum = [(a & keep) + w, (b & keep) + x, (c & keep) + y, (d & keep) + z];
    }

    /// Appends the bricks that have cells, all of one colour, and forgets them.
    fn write(&mut self, block: UVec3, colors: &[[i64; 4]], packet: &mut Packet) {
        let Self { job, sums, marks, aside, writer, .. } = self;
        let along = bricks_along(job.dims());
        aside.sort_unstable_by_key(|(place, _)| *place);
        for (n, marks) in marks.chunks_exact_mut(SIDE as usize).enumerate() {
            let mask: Mask = std::array::from_fn(|z| std::mem::take(&mut marks[z]));
            if mask == [0; SIDE as usize] {
                continue;
            }
            packet.bricks.push(brick_index(along, BRICKS_ALONG * block + brick_in_block(n)));
            packet.masks.push(mask);
            let places = (0..mask.len()).flat_map(|z| bits(mask[z]).map(move |bit| 64 * z + bit));
            let sums = &sums[CELLS * n..CELLS * (n + 1)];
            let values = &mut packet.values;
            if aside.is_empty() {
                let sums = places.map(|place| sums[place].map(|sum| sum as f64));
                writer.write(job.channels, colors, sums, values);
            } else {
                let sums = places.map(|place| all(&sums[place], (CELLS * n + place) as u32, aside));
                writer.write(job.channels, colors, sums, values);
            }
        }
        aside.clear();
    }

    /// The same where colours meet.
    fn write_mixed(&mut self, block: UVec3, colors: &[Vec<[i64; 4]>], packet: &mut Packet) {
        let Self { job, mixed, .. } = self;
        let along = bricks_along(job.dims());
        for n in 0..BRICKS {
            let words = mixed.marks(n * SIDE as usize..(n + 1) * SIDE as usize);
            let Ok(mask) = Mask::try_from(words) else { continue };
            if mask == [0; SIDE as usize] {
                continue;
            }
            packet.bricks.push(brick_index(along, BRICKS_ALONG * block + brick_in_block(n)));
            packet.masks.push(mask);
            let places = (0..mask.len()).flat_map(|z| bits(mask[z]).map(move |bit| 64 * z + bit));
            let cells = places.map(|place| mixed.cell(CELLS * n + place));
            write_mixed(job.channels, colors, cells, &mut packet.values);
        }
        mixed.clear();
    }
}

/// The place of brick number `n` in its block.
fn brick_in_block(n: usize) -> UVec3 {
    brick_of(UVec3::splat(BRICKS_ALONG), n as u32)
}

/// A sum with those of the same place that were put aside, which are in order.
fn all(sum: &[i64; 4], place: u32, aside: &[(u32, FlatPiece)]) -> [f64; 4] {
    let first = aside.partition_point(|(other, _)| *other < place);
    let mut all = sum.map(i128::from);
    for (_, piece) in aside[first..].iter().take_while(|(other, _)| *other == place) {
        all.iter_mut().zip(piece.0).for_each(|(all, number)| *all += i128::from(number));
    }
    all.map(to_f64)
}

/// The place of a cell in a block: its brick, and its place there.
#[inline(always)]
fn place(cell: IVec3) -> usize {
    let IVec3 { x, y, z } = cell;
    let brick = x >> 3 | (y >> 3) << 2 | (z >> 3) << 4;
    (brick << 9 | (x & 7) | (y & 7) << 3 | (z & 7) << 6) as usize
}
