//! The stages in their order: fit the grid, bin triangles, work out bricks, put them together, fill.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use rayon::prelude::*;

use crate::binning::{self, Bins, Budget};
use crate::cells::{Batch, Worker};
use crate::coverage::CellBox;
use crate::fill;
use crate::flat::{BLOCK_SHIFT, BlockWorker, ChunkWorker, Part};
use crate::job::{Chunk, Job};
use crate::options::{Stage, VoxelizeOptions};
use crate::packet::Packet;
use crate::plan;
use crate::sparse::{BrickSet, ChannelData, Mask, SHIFT, SIDE, brick_index, brick_of, bricks_along};
use crate::{Model, SparseVolume, VoxelizeError, VoxelizeReport};

/// Least work of a task, in triangles of bricks.
const TASK: usize = 2048;

/// Makes a volume of a model's triangles.
///
/// Runs on the threads of the current `rayon` pool. The same model gives the same bits whatever the number of threads and
/// the order of triangles and meshes: cells are joined with OR and values with integers (see [`Channel`](crate::Channel)).
///
/// ```
/// use lumivox_core::TriangleView;
/// use lumivox_voxels::{Channel, Model, VoxelizeOptions, voxelize};
///
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]];
/// let triangles = TriangleView { positions: &positions, indices: &[[0, 1, 2]] };
/// let options = VoxelizeOptions { channels: vec![Channel::normal()], ..VoxelizeOptions::resolution(64) };
/// let volume = voxelize(&Model::from(triangles), &options)?;
/// assert!(volume.contains_point(positions[1].into()));
/// assert!(volume.cells().all(|cell| volume.value("normal", cell).is_some_and(|n| n.y < -0.7)));
/// # Ok::<(), lumivox_voxels::VoxelizeError>(())
/// ```
///
/// # Errors
/// If the grid is impossible, an attribute does not fit its mesh, the volume would take more memory than allowed, or the
/// progress callback said stop.
pub fn voxelize(model: &Model<'_>, options: &VoxelizeOptions<'_>) -> Result<SparseVolume, VoxelizeError> {
    let bounds = options.bounds.unwrap_or_else(|| match options.grid {
        crate::GridSpec::Grid(grid) => grid.bounds(),
        _ => model.bounds(),
    });
    if bounds.is_empty() && options.bounds.is_none() {
        return Err(VoxelizeError::Empty);
    }
    let grid = options.grid.fit(&bounds)?;
    plan::check(model, options, &grid)?;
    let job = Job::new(model, options, grid)?;
    let mut report = VoxelizeReport { triangles: job.triangle_count(), ..VoxelizeReport::default() };
    let mut all = Packet::new(&job);
    let all_bricks = CellBox { low: IVec3::ZERO, high: job.along().as_ivec3() - 1 };
    report.skipped_triangles = slab(&job, &job.chunks(), &all_bricks, &mut all)?;
    let surface = BrickSet::new(grid.dims, all.bricks, all.masks);
    let channels = job.channels.iter().zip(all.values);
    let channels = channels.map(|(channel, values)| ChannelData::new(channel, values)).collect();
    let filled = if options.solid { Some(fill::solid(&job, &surface)?) } else { None };
    let volume = SparseVolume::new(grid, surface, None, channels, report);
    Ok(match filled {
        Some((solid, found)) => volume.with_solid(solid, found),
        None => volume,
    })
}

/// Works out the bricks of a slab and appends them; returns the number of skipped triangles. A slab whose lists do not
/// fit into a quarter of the memory is halved: large triangles that cross in many bricks.
fn slab(job: &Job<'_>, chunks: &[Chunk], bricks: &CellBox, all: &mut Packet) -> Result<u64, VoxelizeError> {
    let budget = Budget::new(job.memory_limit());
    if let Some(bins) = all_bins(job, chunks, bricks, &budget)? {
        let skipped = bins.iter().map(|bins| bins.skipped).sum();
        packets(job, chunks, &bins, all)?;
        return Ok(skipped);
    }
    let middle = (bricks.low.z + bricks.high.z) / 2;
    if middle == bricks.high.z {
        return Err(job.too_large(budget.needed()));
    }
    let lower = CellBox { high: bricks.high.with_z(middle), ..*bricks };
    let upper = CellBox { low: bricks.low.with_z(middle + 1), ..*bricks };
    let skipped = slab(job, chunks, &lower, all)?;
    slab(job, chunks, &upper, all)?;
    Ok(skipped)
}

/// The bins of all chunks, if they fit.
fn all_bins(
    job: &Job<'_>,
    chunks: &[Chunk],
    bricks: &CellBox,
    budget: &Budget,
) -> Result<Option<Vec<Bins>>, VoxelizeError> {
    let idle = Idle::default();
    let done = AtomicU64::new(0);
    chunks
        .par_iter()
        .map(|chunk| {
            let bins = if job.is_flat() {
                let mut worker = idle.take(|| ChunkWorker::new(job));
                let bins = worker.bin(job, chunk, bricks, budget);
                idle.put(worker);
                bins
            } else {
                binning::bin(job, chunk, bricks, budget)
            };
            let count = u64::from(chunk.triangles.end - chunk.triangles.start);
            let done = done.fetch_add(count, Ordering::Relaxed) + count;
            job.report(Stage::Binning, done, job.triangle_count()).map(|()| bins)
        })
        .collect()
}

/// What threads work with, as many as there are threads.
struct Idle<T>(Mutex<Vec<T>>);

impl<T> Default for Idle<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Idle<T> {
    fn take(&self, new: impl FnOnce() -> T) -> T {
        let idle = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(new)
    }

    fn put(&self, worker: T) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(worker);
    }
}

/// What one chunk knows about one brick.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Segment {
    brick: u32,
    chunk: u32,
    number: u32,
    /// Whether it is of sums.
    is_summed: bool,
}

impl Segment {
    /// Of chunk number `chunk`.
    fn all<'b>(job: &'b Job<'_>, chunk: usize, bins: &'b Bins) -> impl Iterator<Item = Self> + 'b {
        let chunk = chunk as u32;
        let (along, blocks) = (bricks_along(job.dims()), job.along());
        let lists = bins.bricks.iter().enumerate();
        let lists = lists.map(move |(n, &brick)| Self { brick, chunk, number: n as u32, is_summed: false });
        let sums = (0..bins.sums.len()).map(move |n| {
            let block = brick_of(along, bins.sums.get(n).brick) >> (BLOCK_SHIFT - SHIFT);
            Self { brick: brick_index(blocks, block), chunk, number: n as u32, is_summed: true }
        });
        lists.chain(sums)
    }

    /// How much there is to do, in triangles.
    fn work(&self, bins: &Bins) -> usize {
        if self.is_summed {
            1 + bins.sums.get(self.number as usize).sums.len() / 8
        } else {
            8 + bins.items(self.number).len()
        }
    }
}

/// Gathers the bins of all chunks brick by brick and works the bricks out.
fn packets(job: &Job<'_>, chunks: &[Chunk], bins: &[Bins], all: &mut Packet) -> Result<(), VoxelizeError> {
    let mut segments: Vec<Segment> =
        Vec::with_capacity(bins.iter().map(|b| b.bricks.len() + b.sums.len()).sum());
    for (chunk, bins) in bins.iter().enumerate() {
        segments.extend(Segment::all(job, chunk, bins));
    }
    segments.par_sort_unstable();
    let mut tasks: Vec<&[Segment]> = Vec::new();
    let mut rest = segments.as_slice();
    let mut work = 0;
    let mut end = 0;
    while end < rest.len() {
        let segment = rest[end];
        work += segment.work(&bins[segment.chunk as usize]);
        end += 1;
        let is_last = rest.get(end).is_none_or(|next| next.brick != segment.brick);
        if is_last && (work >= TASK || end == rest.len()) {
            let (task, others) = rest.split_at(end);
            tasks.push(task);
            (rest, end, work) = (others, 0, 0);
        }
    }
    let (done, total) = (AtomicU64::new(0), segments.len() as u64);
    let idle = Idle::default();
    let packets: Result<Vec<Packet>, VoxelizeError> = tasks
        .par_iter()
        .map(|task| {
            let packet = if job.is_flat() {
                flat_packet(job, chunks, bins, task, &idle)
            } else {
                packet(job, chunks, bins, task)
            };
            job.finished_bytes.fetch_add(packet.bytes(), Ordering::Relaxed);
            let done = done.fetch_add(task.len() as u64, Ordering::Relaxed) + task.len() as u64;
            job.report(Stage::Cells, done, total).map(|()| packet)
        })
        .collect();
    let packets = packets?;
    if job.is_flat() {
        all.append_in_order(packets);
    } else {
        packets.into_iter().for_each(|packet| all.append(packet));
    }
    Ok(())
}

/// Works out the blocks of some segments.
fn flat_packet<'a>(
    job: &'a Job<'a>,
    chunks: &[Chunk],
    bins: &[Bins],
    segments: &[Segment],
    idle: &Idle<BlockWorker<'a>>,
) -> Packet {
    let mut packet = Packet::new(job);
    let mut worker = idle.take(|| BlockWorker::new(job));
    for same_block in segments.chunk_by(|a, b| a.brick == b.brick) {
        let part = |segment: &Segment| {
            let part = match segment.is_summed {
                true => Part::Sums(bins[segment.chunk as usize].sums.get(segment.number as usize)),
                false => Part::Triangles(batch(chunks, bins, segment)),
            };
            (chunks[segment.chunk as usize].color, part)
        };
        let mut parts: Vec<(u32, Part<'_>)> = same_block.iter().map(part).collect();
        parts.sort_by_key(|part| part.0);
        worker.block(brick_of(job.along(), same_block[0].brick), &parts, &mut packet);
    }
    idle.put(worker);
    packet
}

/// The triangles of a segment.
fn batch<'b>(chunks: &[Chunk], bins: &'b [Bins], segment: &Segment) -> Batch<'b> {
    let chunk = segment.chunk as usize;
    Batch { mesh: chunks[chunk].mesh, triangles: bins[chunk].items(segment.number) }
}

/// Works out the bricks of some segments.
fn packet(job: &Job<'_>, chunks: &[Chunk], all_bins: &[Bins], segments: &[Segment]) -> Packet {
    let mut packet = Packet::new(job);
    let mut worker = Worker::new(job);
    let along = bricks_along(job.dims());
    for same_brick in segments.chunk_by(|a, b| a.brick == b.brick) {
        let mut mask: Mask = [0; SIDE as usize];
        let mut batches = Vec::with_capacity(same_brick.len());
        for segment in same_brick {
            let bins = &all_bins[segment.chunk as usize];
            let marked = &bins.masks[segment.number as usize];
            mask.iter_mut().zip(marked).for_each(|(a, b)| *a |= b);
            if !bins.items(segment.number).is_empty() {
                batches.push(batch(chunks, all_bins, segment));
            }
        }
        let brick = same_brick[0].brick;
        worker.brick(brick_of(along, brick), &batches, &mut mask, &mut packet.values);
        if mask != [0; SIDE as usize] {
            packet.bricks.push(brick);
            packet.masks.push(mask);
        }
    }
    packet
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;
    use crate::{Channel, Coverage, Format};
    use lumivox_core::{Grid, TriangleView};

    /// Triangles of up to `sizes` cells, all over a cube of so many.
    fn soup(count: u32, cube: f32, sizes: f32) -> Vec<[f32; 3]> {
        let mut state = 5u64;
        let mut roll = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let triangle = |_| {
            let (center, size) = ([roll() * cube, roll() * cube, roll() * cube], roll() * sizes);
            [(); 3].map(|()| center.map(|x| x + size * (roll() - 0.5)))
        };
        (0..count).flat_map(triangle).collect()
    }

    /// Flat triangles leave the same whether they are summed in chunks or listed, in one chunk or many.
    #[test]
    fn sums_of_chunks_and_lists_of_triangles_give_the_same_bits() {
        let all_in_one_cell = (0..1500).flat_map(|_| [[2.1, 2.0, 2.1], [2.9, 2.1, 2.5], [2.2, 2.8, 2.4]]);
        for positions in [soup(6000, 70.0, 24.0), soup(20_000, 40.0, 2.0), all_in_one_cell.collect()] {
            let indices: Vec<[u32; 3]> =
                (0..positions.len() as u32 / 3).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
            let model = Model::from(TriangleView { positions: &positions, indices: &indices });
            let grid = Grid { origin: glam::Vec3::ZERO, cell_size: 1.0, dims: glam::UVec3::new(66, 70, 40) };
            for coverage in [Coverage::Exact, Coverage::Thin] {
                let channels = vec![Channel::albedo(), Channel::normal().format(Format::F32)];
                let options = VoxelizeOptions { coverage, channels, ..VoxelizeOptions::default() };
                let job = Job::new(&model, &options, grid).unwrap();
                let all_bricks = CellBox { low: IVec3::ZERO, high: job.along().as_ivec3() - 1 };
                let run = |chunks: &[Chunk], budget: &Budget| {
                    let bins = all_bins(&job, chunks, &all_bricks, budget).unwrap().unwrap();
                    let mut packet = Packet::new(&job);
                    packets(&job, chunks, &bins, &mut packet).unwrap();
                    let sums: usize = bins.iter().map(|bins| bins.sums.len()).sum();
                    (packet.bricks, packet.masks, packet.values, sums > 0)
                };
                let one = [Chunk { mesh: 0, triangles: 0..indices.len() as u32, color: 0 }];
                let limit = options.memory_limit;
                let listed = run(&one, &Budget::of_pairs(limit));
                assert!(!listed.3 && !listed.0.is_empty());
                for chunks in [&one[..], &job.chunks()] {
                    let summed = run(chunks, &Budget::new(limit));
                    assert!(summed.3);
                    assert_eq!((&summed.0, &summed.1), (&listed.0, &listed.1), "{coverage:?}");
                    assert_eq!(summed.2, listed.2, "{coverage:?}");
                }
            }
        }
    }
}
