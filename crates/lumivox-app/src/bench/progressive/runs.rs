//! Forms of progressive voxelization that are fed with the same views, and what becomes of their cells from frame to frame.

use anyhow::Result;
use glam::{UVec2, UVec3};
use half::f16;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, TriangleView};
use lumivox::gpu::{Gpu, read_buffer};
use lumivox::progressive::{CHANNELS, CleanupRule, Progressive, SinglePass};
use lumivox::volume::NORMAL;
use lumivox_oracle::voxels::{Coverage, VoxelSet};

use super::quality::BEYOND;
use super::rig::{Bricks, Rig, three_channels};
use crate::bench::timing::Timer;

/// The cells that a model touches.
pub(super) struct Truth {
    pub(super) grid: Grid,
    pub(super) thin: VoxelSet,
    pub(super) thin_count: usize,
    /// With a margin of [`BEYOND`].
    pub(super) exact: VoxelSet,
}

impl Truth {
    pub(super) fn new(grid: Grid, mesh: TriangleView<'_>) -> Self {
        let thin = VoxelSet::of(grid, mesh, Coverage::Thin);
        let exact = VoxelSet::with_margin(grid, mesh, Coverage::Exact, 2.0 * BEYOND);
        Self { grid, thin_count: thin.len(), thin, exact }
    }
}

/// A form of progressive voxelization that is fed with the same views as the others.
enum Form {
    Bricks(Box<Bricks>),
    SinglePass(Box<(SinglePass, VolumeBuffer, lumivox::progressive::DirectLight)>),
}

/// A form on one grid, and what became of it.
pub(super) struct Run {
    pub(super) name: &'static str,
    form: Form,
    /// Occupied cells after the last frame.
    pub(super) cells: Vec<UVec3>,
    /// The share of those before each frame that it cleared, where that is counted.
    pub(super) lost: Vec<f64>,
    /// The share of the thin cells that were occupied after each frame, and the cells that were and touch nothing.
    pub(super) found: Vec<f64>,
    pub(super) strays: Vec<f64>,
    /// Strays as shares of the occupied cells.
    pub(super) stale: Vec<f64>,
}

impl Run {
    fn read(&self, gpu: &Gpu, grid: &Grid) -> Result<Vec<UVec3>> {
        Ok(match &self.form {
            Form::Bricks(bricks) => {
                bricks.voxelizer.read_occupied(gpu)?.iter().map(|c| c.as_uvec3()).collect()
            }
            Form::SinglePass(single) => {
                let Some(normals) = single.1.channel(NORMAL) else { return Ok(Vec::new()) };
                let normals: Vec<[f16; 4]> = read_buffer(gpu, normals)?;
                grid.cells().filter(|c| normals[grid.index(*c)][3] > f16::ZERO).collect()
            }
        })
    }

    /// A frame of what the camera sees, and what it does to the cells.
    pub(super) fn frame(&mut self, timer: &Timer<'_>, rig: &Rig, truth: &Truth) -> Result<()> {
        let before = self.cells.len();
        if let Some(cleaned) = self.step(timer, rig)?
            && before > 0
        {
            self.lost.push(f64::from(cleaned) / before as f64);
        }
        self.cells = self.read(timer.gpu, &truth.grid)?;
        let count = |is: &dyn Fn(UVec3) -> bool| self.cells.iter().filter(|c| is(**c)).count() as f64;
        let (found, strays) =
            (count(&|c| truth.thin.contains(c)), count(&|c| !truth.exact.verdict(c).possibly));
        self.found.push(found / truth.thin_count.max(1) as f64);
        self.strays.push(strays);
        self.stale.push(strays / self.cells.len().max(1) as f64);
        Ok(())
    }

    /// Returns how many cells it cleared, where that is counted.
    fn step(&mut self, timer: &Timer<'_>, rig: &Rig) -> Result<Option<u32>> {
        match &mut self.form {
            Form::Bricks(bricks) => {
                let happened = bricks.frame(timer, rig)?;
                anyhow::ensure!(happened.refused == 0, "{}: bricks found no room: {happened:?}", self.name);
                Ok(Some(happened.cleaned))
            }
            Form::SinglePass(single) => {
                let (single, volume, light) = &mut **single;
                timer.submit(|e| {
                    single.record_begin(e, light);
                    single.record_camera(timer.gpu, e, &rig.camera.input, volume, light)
                })?;
                Ok(None)
            }
        }
    }
}

/// The forms that a grid has room for.
pub(super) fn forms(gpu: &Gpu, rig: &Rig, grid: Grid, size: UVec2) -> Result<Vec<Run>> {
    let run = |name, form| Run {
        name,
        form,
        cells: Vec::new(),
        lost: Vec::new(),
        found: Vec::new(),
        strays: Vec::new(),
        stale: Vec::new(),
    };
    let mut runs = Vec::new();
    let rules =
        [("footprint", CleanupRule::Footprint), ("rays", CleanupRule::Rays), ("center", CleanupRule::Center)];
    for (name, rule) in rules {
        let bricks = Bricks::new(gpu, rig, grid, &three_channels(), size, rule)?;
        runs.push(run(name, Form::Bricks(Box::new(bricks))));
    }
    if grid.dims.max_element() <= 128 {
        for (name, rule) in
            [("single pass", CleanupRule::Center), ("single pass, footprint", CleanupRule::Footprint)]
        {
            let volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
            let single = SinglePass::with_rule(gpu, &volume, rule)?;
            let light = Progressive::direct_light(gpu, &volume)?;
            runs.push(run(name, Form::SinglePass(Box::new((single, volume, light)))));
        }
    }
    Ok(runs)
}
