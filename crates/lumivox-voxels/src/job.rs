//! A model on its grid: triangles in units of cells, cut into chunks of work, with progress and limits watched.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DVec3, UVec3};
use lumivox_core::Grid;
use rayon::prelude::*;

use crate::channels::{Parts, takes_flat};
use crate::coverage::{CellBox, Triangle};
use crate::flat::{BLOCK_SHIFT, Colors};
use crate::model::MaterialOf;
use crate::options::{Progress, Stage, VoxelizeOptions};
use crate::placement::{PackedCell, Placement};
use crate::sparse::SHIFT;
use crate::surface::{Asked, Placed};
use crate::{Channel, Coverage, Material, Model, VoxelizeError};

/// Triangles of one mesh that are binned together.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    pub(crate) mesh: usize,
    /// Their places in the order that [`Colors`] has for the mesh, if it has one, else their numbers.
    pub(crate) triangles: Range<u32>,
    /// The number of their colour, if there are [`Colors`].
    pub(crate) color: u32,
}

/// The cells that a triangle reaches.
pub(crate) enum Reached {
    /// All corners lie in one cell.
    One(PackedCell),
    /// A box of cells.
    Box(CellBox),
}

impl Reached {
    /// What a triangle with corners in these cells reaches; none if one of them is not finite.
    #[inline(always)]
    pub(crate) fn of([a, b, c]: [PackedCell; 3]) -> Option<Self> {
        if a == b && b == c {
            return (a != PackedCell::NONE).then_some(Self::One(a));
        }
        if a == PackedCell::NONE || b == PackedCell::NONE || c == PackedCell::NONE {
            return None;
        }
        let (a, b, c) = (a.cell(), b.cell(), c.cell());
        Some(Self::Box(CellBox { low: a.min(b).min(c), high: a.max(b).max(c) }))
    }

    #[inline]
    pub(crate) fn cells(&self) -> CellBox {
        match self {
            Self::One(cell) => CellBox { low: cell.cell(), high: cell.cell() },
            Self::Box(cells) => *cells,
        }
    }
}

/// Everything that stages of the work share.
pub(crate) struct Job<'a> {
    pub(crate) model: &'a Model<'a>,
    pub(crate) channels: &'a [Channel],
    pub(crate) coverage: Coverage,
    pub(crate) grid: Grid,
    /// What of a fragment has to be known.
    pub(crate) parts: Parts,
    /// Whether there is more to do than to mark cells.
    pub(crate) needs_fragments: bool,
    /// Whether the channels are such that flat triangles can be summed in short.
    pub(crate) takes_flat: bool,
    pub(crate) asked: Asked,
    /// Of each mesh.
    pub(crate) placed: Vec<Placed>,
    /// The material of triangles that name none.
    pub(crate) plain: Material<'a>,
    pub(crate) placements: Vec<Placement>,
    /// The cell of each vertex of each mesh: vertices have more triangles than one, and most of those need no more.
    vertex_cells: Vec<Vec<PackedCell>>,
    /// The colours of triangles, if all of them have one colour and one normal each.
    pub(crate) colors: Option<Colors>,
    options: &'a VoxelizeOptions<'a>,
    cancelled: AtomicBool,
    /// Bytes of finished bricks.
    pub(crate) finished_bytes: AtomicU64,
}

impl<'a> Job<'a> {
    pub(crate) fn new(
        model: &'a Model<'a>,
        options: &'a VoxelizeOptions<'a>,
        grid: Grid,
    ) -> Result<Self, VoxelizeError> {
        for (mesh, view) in model.meshes.iter().enumerate() {
            if let Some(fault) = view.fault() {
                return Err(VoxelizeError::Mesh { mesh, fault });
            }
            let found = view.triangles.len();
            if u32::try_from(found).is_err() {
                return Err(VoxelizeError::TooManyTriangles { mesh, found });
            }
        }
        let is_masked = model.materials.iter().any(|m| m.alpha_cutoff.is_some());
        let mut parts = Parts::of(&options.channels);
        parts.point |= is_masked;
        let mut job = Self {
            model,
            channels: &options.channels,
            coverage: options.coverage,
            grid,
            parts,
            needs_fragments: is_masked || !options.channels.is_empty(),
            takes_flat: takes_flat(&options.channels),
            asked: Asked::new(&options.channels),
            placed: model.meshes.iter().map(Placed::new).collect(),
            plain: Material::default(),
            placements: model
                .meshes
                .iter()
                .map(|mesh| Placement::new(&grid, &mesh.world_from_local, options.snap))
                .collect(),
            vertex_cells: Vec::new(),
            colors: None,
            options,
            cancelled: AtomicBool::new(false),
            finished_bytes: AtomicU64::new(0),
        };
        let cells = model.meshes.iter().enumerate().map(|(mesh, view)| {
            let positions = view.triangles.positions.par_iter().with_min_len(4096);
            let placement = &job.placements[mesh];
            match placement.scaled() {
                Some(scaled) => positions.map(|p| placement.cell(scaled.corner(p))).collect(),
                None => positions.map(|p| placement.cell(placement.corner(p))).collect(),
            }
        });
        job.vertex_cells = cells.collect();
        job.colors = Colors::of(&job);
        Ok(job)
    }

    /// Whether all triangles have one colour and one normal each.
    pub(crate) fn is_flat(&self) -> bool {
        self.colors.is_some()
    }

    /// Triangles are sorted by cubes of two to the power of this many cells.
    pub(crate) fn shift(&self) -> u32 {
        if self.is_flat() { BLOCK_SHIFT } else { SHIFT }
    }

    /// Such cubes along the axes of the grid.
    pub(crate) fn along(&self) -> UVec3 {
        let side = 1 << self.shift();
        (self.dims() + (side - 1)) / side
    }

    pub(crate) fn dims(&self) -> UVec3 {
        self.grid.dims
    }

    pub(crate) fn memory_limit(&self) -> u64 {
        self.options.memory_limit
    }

    /// Triangles over all meshes.
    pub(crate) fn triangle_count(&self) -> u64 {
        self.model.meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum()
    }

    /// All triangles in pieces, small enough for all threads to have work.
    pub(crate) fn chunks(&self) -> Vec<Chunk> {
        let per_thread = self.triangle_count() / (8 * rayon::current_num_threads() as u64);
        let size = per_thread.clamp(512, 16384) as u32;
        let mut chunks = Vec::new();
        for (mesh, view) in self.model.meshes.iter().enumerate() {
            let count = view.triangles.len() as u32;
            let runs = self.colors.as_ref().map_or_else(|| vec![(0, 0..count)], |c| c.runs(mesh, count));
            for (color, run) in runs {
                chunks.extend((0..(run.end - run.start).div_ceil(size)).map(|n| {
                    let start = run.start + n * size;
                    Chunk { mesh, triangles: start..run.end.min(start.saturating_add(size)), color }
                }));
            }
        }
        chunks
    }

    /// The number of a triangle's material.
    #[inline]
    pub(crate) fn material_of(&self, mesh: usize, number: u32) -> usize {
        match self.model.meshes[mesh].material {
            MaterialOf::Mesh(material) => material,
            MaterialOf::Triangle(numbers) => numbers[number as usize] as usize,
        }
    }

    /// The cells that a triangle reaches; none if it names no vertex or is not finite.
    #[inline(always)]
    pub(crate) fn reach(&self, mesh: usize, number: u32) -> Option<Reached> {
        Reached::of(self.cells_of(mesh, number))
    }

    /// The cells of a triangle's corners.
    #[inline(always)]
    pub(crate) fn cells_of(&self, mesh: usize, number: u32) -> [PackedCell; 3] {
        let cells = self.vertex_cells[mesh].as_slice();
        let cell = |n: u32| cells.get(n as usize).copied().unwrap_or(PackedCell::NONE);
        // Written out, since `map` is a call.
        let [a, b, c] = self.model.meshes[mesh].triangles.indices[number as usize];
        [cell(a), cell(b), cell(c)]
    }

    /// A triangle in units of cells, of which [`Self::reach`] knows the reach.
    #[inline(always)]
    pub(crate) fn triangle(&self, mesh: usize, number: u32, reach: CellBox) -> Triangle {
        let view = &self.model.meshes[mesh].triangles;
        let [a, b, c] = view.indices[number as usize].map(|n| n as usize);
        let positions = [&view.positions[a], &view.positions[b], &view.positions[c]];
        Triangle { corners: self.placements[mesh].corners(positions), reach }
    }

    /// A point in cells, in the world.
    pub(crate) fn world_from_grid(&self, point: DVec3) -> DVec3 {
        self.grid.origin.as_dvec3() + f64::from(self.grid.cell_size) * point
    }

    /// Tells about progress.
    pub(crate) fn report(&self, stage: Stage, done: u64, total: u64) -> Result<(), VoxelizeError> {
        if let Some(progress) = self.options.progress
            && progress(Progress { stage, done, total }).is_break()
        {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        self.check()
    }

    /// An error if it was asked to stop or takes too much memory.
    pub(crate) fn check(&self) -> Result<(), VoxelizeError> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(VoxelizeError::Cancelled);
        }
        self.check_bytes(0)
    }

    /// An error if finished bricks and so many bytes more are too much.
    pub(crate) fn check_bytes(&self, more: usize) -> Result<(), VoxelizeError> {
        let reached = self.finished_bytes.load(Ordering::Relaxed) + more as u64;
        if reached > self.memory_limit() {
            return Err(self.too_large(reached));
        }
        Ok(())
    }

    /// The error that so many bytes are too many.
    pub(crate) fn too_large(&self, needed: u64) -> VoxelizeError {
        VoxelizeError::TooLarge { dims: self.dims(), needed, limit: self.memory_limit(), largest: None }
    }
}
