//! What a frame of each form takes.

use anyhow::Result;
use glam::UVec2;
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, View};
use lumivox::gpu::Gpu;
use lumivox::progressive::{
    AttributeChannel, BrickCell, CHANNELS, CleanupRule, DenseVoxelizer, FrameDiagnostics, Progressive,
    SinglePass, Storage, ViewInput,
};

use super::rig::{Bricks, Rig};
use crate::bench::timing::Timer;

/// The camera's pictures with so many points.
pub(super) fn input(gpu: &Gpu, rig: &Rig, points: UVec2) -> ViewInput {
    let input = ViewInput::new(gpu, "bench", rig.camera.input.textures.clone(), points);
    input.update(gpu, &rig.camera.view, rig.scale());
    input
}

/// Milliseconds of cleanup and of injection with any channels over all cells, in a storage.
pub(super) fn measure_storage(
    timer: &Timer<'_>,
    rig: &mut Rig,
    grid: Grid,
    channels: &[AttributeChannel],
    points: UVec2,
    storage: Storage,
) -> Result<[f64; 2]> {
    let gpu = timer.gpu;
    let mut dense = DenseVoxelizer::new(gpu, grid, channels, storage, CleanupRule::Center)?;
    let view = rig.attribute_view(gpu, channels, points);
    view.update(gpu, &rig.camera.view, view.point_count(), 0);
    rig.draw(timer)?;
    timer.submit(|e| dense.record(gpu, e, &[&view]))?;
    let cleanup = timer.median(|| timer.submit(|e| dense.record_cleanup(gpu, e, &view)))?.ms;
    let injection = timer.median(|| timer.submit(|e| dense.record_injection(gpu, e, &[&view])))?.ms;
    Ok([cleanup, injection])
}

/// A volume of bricks after some views.
pub(super) struct InBricks {
    bricks: Bricks,
    pub(super) cells: Vec<BrickCell>,
}

impl InBricks {
    /// After views, the rig's own last.
    pub(super) fn filled(
        timer: &Timer<'_>,
        rig: &mut Rig,
        grid: Grid,
        channels: &[AttributeChannel],
        points: UVec2,
        rule: CleanupRule,
        views: &[View],
    ) -> Result<Self> {
        let mut bricks = Bricks::new(timer.gpu, rig, grid, channels, points, rule)?;
        let last = rig.camera.view;
        for view in views.iter().chain([&last]) {
            rig.look(timer.gpu, *view);
            rig.draw(timer)?;
            bricks.step(timer, rig)?;
        }
        Ok(Self { bricks, cells: Vec::new() })
    }

    /// The same with its cells in memory.
    pub(super) fn read(self, gpu: &Gpu) -> Result<Self> {
        Ok(Self { cells: self.bricks.voxelizer.read_cells(gpu)?, ..self })
    }

    /// Milliseconds of a frame of the last view, and what it did.
    pub(super) fn measure(&mut self, timer: &Timer<'_>, rig: &Rig) -> Result<(f64, FrameDiagnostics)> {
        let time = timer.median(|| self.bricks.step(timer, rig))?.ms;
        let happened = self.bricks.voxelizer.diagnostics(timer.gpu, Some(time))?;
        anyhow::ensure!(happened.refused == 0, "bricks found no room: {happened:?}");
        Ok((time, happened))
    }
}

/// Milliseconds of a frame in bricks, after views that fill them, and what it did.
pub(super) fn measure_bricks(
    timer: &Timer<'_>,
    rig: &mut Rig,
    grid: Grid,
    channels: &[AttributeChannel],
    points: UVec2,
    rule: CleanupRule,
    views: &[View],
) -> Result<(f64, FrameDiagnostics)> {
    InBricks::filled(timer, rig, grid, channels, points, rule, views)?.measure(timer, rig)
}

/// Milliseconds of a frame of the single pass, with light.
pub(super) fn single_pass(timer: &Timer<'_>, rig: &Rig, grid: Grid, rule: CleanupRule) -> Result<f64> {
    let gpu = timer.gpu;
    let mut volume = VolumeBuffer::new(gpu, grid, &CHANNELS)?;
    let mut light = Progressive::direct_light(gpu, &volume)?;
    let mut single = SinglePass::with_rule(gpu, &volume, rule)?;
    let time = timer.median(|| {
        timer.submit(|e| {
            single.record_begin(e, &mut light);
            single.record_camera(gpu, e, &rig.camera.input, &mut volume, &mut light)
        })
    })?;
    Ok(time.ms)
}
