//! A model on its grid: triangles in units of cells, cut into chunks of work, with progress and limits watched.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{DAffine3, DMat3, DVec3, UVec3};
use lumivox_core::Grid;

use crate::channels::Parts;
use crate::coverage::Triangle;
use crate::options::{Progress, Stage, VoxelizeOptions};
use crate::{Channel, Coverage, Model, VoxelizeError};

/// Triangles of one mesh that are binned together.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    pub(crate) mesh: usize,
    pub(crate) triangles: Range<u32>,
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
    grid_from_local: Vec<DAffine3>,
    rim: f64,
    snap: f64,
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
        let side = f64::from(grid.cell_size);
        let grid_from_world = DAffine3 {
            matrix3: DMat3::from_diagonal(DVec3::splat(1.0 / side)),
            translation: -grid.origin.as_dvec3() / side,
        };
        let is_masked = model.materials.iter().any(|m| m.alpha_cutoff.is_some());
        let mut parts = Parts::of(&options.channels);
        parts.point |= is_masked;
        // Half of the last bit of coordinates in f32 is 2^-13 cells in a grid of 2048.
        let rim = (f64::from(grid.dims.max_element()) * 2f64.powi(-23)).max(1e-4);
        Ok(Self {
            model,
            channels: &options.channels,
            coverage: options.coverage,
            grid,
            parts,
            needs_fragments: is_masked || !options.channels.is_empty(),
            grid_from_local: model
                .meshes
                .iter()
                .map(|mesh| grid_from_world * DAffine3::from_mat4(mesh.world_from_local.as_dmat4()))
                .collect(),
            rim,
            snap: if options.snap > 0.0 { options.snap.min(0.5) } else { 0.0 },
            options,
            cancelled: AtomicBool::new(false),
            finished_bytes: AtomicU64::new(0),
        })
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
            chunks.extend((0..count.div_ceil(size)).map(|n| {
                let start = n * size;
                Chunk { mesh, triangles: start..count.min(start.saturating_add(size)) }
            }));
        }
        chunks
    }

    /// A triangle in units of cells; none if it names no vertex or is not finite.
    #[inline]
    pub(crate) fn triangle(&self, mesh: usize, number: u32) -> Option<Triangle> {
        let view = &self.model.meshes[mesh].triangles;
        let [a, b, c] = view.indices[number as usize];
        let at = |n: u32| view.positions.get(n as usize);
        let positions = [at(a)?, at(b)?, at(c)?];
        let grid_from_local = &self.grid_from_local[mesh];
        let mut corners =
            positions.map(|p| grid_from_local.transform_point3(DVec3::from_array(p.map(f64::from))));
        // Sums carry what is not finite.
        if !(corners[0] + corners[1] + corners[2]).element_sum().is_finite() {
            return None;
        }
        if self.snap > 0.0 {
            for corner in &mut corners {
                let boundary = corner.round();
                let is_near = (*corner - boundary).abs().cmple(DVec3::splat(self.snap));
                *corner = DVec3::select(is_near, boundary, *corner);
            }
        }
        Some(Triangle::new(corners, self.grid.dims, self.rim))
    }

    /// Whether the mesh is mirrored where it stands, so that its triangles turn the other way.
    pub(crate) fn is_mirrored(&self, mesh: usize) -> bool {
        self.grid_from_local[mesh].matrix3.determinant() < 0.0
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
        let reached = self.finished_bytes.load(Ordering::Relaxed);
        if reached > self.memory_limit() {
            return Err(VoxelizeError::TooLarge { dims: self.dims(), reached, limit: self.memory_limit() });
        }
        Ok(())
    }
}
