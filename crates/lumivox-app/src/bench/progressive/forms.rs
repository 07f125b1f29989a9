//! What a frame of each form takes.

use anyhow::Result;
use glam::{UVec2, UVec3, Vec3};
use lumivox::VolumeBuffer;
use lumivox::core::{Grid, View};
use lumivox::gpu::Gpu;
use lumivox::progressive::{
    AttributeChannel, CHANNELS, CleanupRule, DenseVoxelizer, FrameDiagnostics, Progressive, SinglePass,
    Storage, ViewInput,
};

use super::rig::{Bricks, Rig};
use crate::bench::timing::Timer;

/// Bytes of a cell's sums in the dense form.
const SUM_BYTES: u64 = 40;

/// The dense form over a grid, in slabs of layers where its sums do not fit the device.
pub(super) struct Dense {
    pub(super) cleanup: f64,
    /// Clearing the sums, and sums to means.
    pub(super) rest: f64,
    pub(super) injection: f64,
    pub(super) slabs: usize,
}

impl Dense {
    pub(super) fn total(&self) -> f64 {
        self.cleanup + self.rest + self.injection
    }

    /// Measures it slab by slab, after views that fill it. The points are injected once for each slab; of that the longest time
    /// alone counts.
    pub(super) fn measure(
        timer: &Timer<'_>,
        rig: &mut Rig,
        grid: Grid,
        points: UVec2,
        rule: CleanupRule,
        views: &[View],
    ) -> Result<Self> {
        let gpu = timer.gpu;
        let room = gpu.device.limits().max_storage_buffer_binding_size / SUM_BYTES;
        let layer = u64::from(grid.dims.x) * u64::from(grid.dims.y);
        let layers = ((room / layer) as u32).clamp(1, grid.dims.z);
        let mut all = Self { cleanup: 0.0, rest: 0.0, injection: 0.0, slabs: 0 };
        for first in (0..grid.dims.z).step_by(layers as usize) {
            let slab = Grid {
                origin: grid.origin + Vec3::Z * (first as f32 * grid.cell_size),
                dims: UVec3::new(grid.dims.x, grid.dims.y, layers.min(grid.dims.z - first)),
                ..grid
            };
            let mut volume = VolumeBuffer::new(gpu, slab, &CHANNELS)?;
            let mut progressive = Progressive::of_surfaces(gpu, &volume, rule)?;
            let last = rig.camera.view;
            for view in views.iter().chain([&last]) {
                rig.look(gpu, *view);
                rig.draw(timer)?;
                let input = input(gpu, rig, points);
                timer.submit(|e| {
                    progressive.record_cleanup(gpu, e, &input, &mut volume)?;
                    progressive.record_begin_surfaces(e);
                    progressive.record_surfaces(gpu, e, [&input], &volume)?;
                    progressive.record_end_surfaces(gpu, e, &input, &mut volume)
                })?;
            }
            let input = input(gpu, rig, points);
            all.cleanup += timer
                .median(|| timer.submit(|e| progressive.record_cleanup(gpu, e, &input, &mut volume)))?
                .ms;
            let injection =
                timer.median(|| timer.submit(|e| progressive.record_surfaces(gpu, e, [&input], &volume)))?.ms;
            all.injection = all.injection.max(injection);
            all.rest += timer
                .median(|| {
                    timer.submit(|e| {
                        progressive.record_begin_surfaces(e);
                        progressive.record_end_surfaces(gpu, e, &input, &mut volume)
                    })
                })?
                .ms;
            all.slabs += 1;
        }
        Ok(all)
    }
}

/// The camera's pictures with so many points.
fn input(gpu: &Gpu, rig: &Rig, points: UVec2) -> ViewInput {
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
    let mut bricks = Bricks::new(timer.gpu, rig, grid, channels, points, rule)?;
    let last = rig.camera.view;
    for view in views.iter().chain([&last]) {
        rig.look(timer.gpu, *view);
        rig.draw(timer)?;
        bricks.step(timer, rig)?;
    }
    let time = timer.median(|| bricks.step(timer, rig))?.ms;
    let happened = bricks.voxelizer.diagnostics(timer.gpu, Some(time))?;
    anyhow::ensure!(happened.refused == 0, "bricks found no room: {happened:?}");
    Ok((time, happened))
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
