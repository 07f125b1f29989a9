//! A frame, stage by stage.

use lumivox::gpu::{GpuError, StageTimer};

use super::indirect::{Indirect, Pace};
use super::view_voxelizer::Target;
use super::{FrameStats, GiMethod, Renderer, RendererError, Settings, Shade, VoxelSource, needs_volume};

impl Renderer {
    /// The stages that [`Settings::light_budget`] counts. Those of surfels take a look at each, whoever's turn it is.
    pub const PACED_STAGES: [&str; 4] = ["gather/surfels", "gather/direct", "gather/trace", "gather/bounce"];

    /// What the last frame's light took, milliseconds, if that is more than [`Settings::light_budget`] though as few surfels as
    /// possible had their turn.
    pub fn light_over_budget(&self) -> Option<f64> {
        self.over_budget
    }

    /// One frame. With a clock (milliseconds since any moment) every stage is submitted alone and timed.
    pub fn frame(&mut self, clock: Option<fn() -> f64>) -> Result<FrameStats, RendererError> {
        // Lights shine on the surfaces that the frame before left; the first frame makes them itself.
        let makes_surfaces = matches!(self.indirect, Indirect::Gathered(_)) && self.views_fill_volume();
        let is_first = std::mem::take(&mut self.fresh);
        if is_first && makes_surfaces {
            self.make_frame(clock, Pace::WHOLE)?;
        }
        let pace = if is_first { Pace::WHOLE } else { self.pace() };
        self.frames = self.frames.wrapping_add(1);
        self.make_frame(clock, pace)
    }

    fn make_frame(&mut self, clock: Option<fn() -> f64>, pace: Pace) -> Result<FrameStats, RendererError> {
        let mut timer = StageTimer::new(&self.gpu, clock);
        self.voxelize_triangles(&mut timer)?;
        if let Some(expected) = &mut self.expected {
            expected.record(&self.gpu, &mut timer)?;
        }
        self.record_view(&mut timer, pace)?;
        if needs_volume(&self.settings) && pace.updates() {
            self.record_volume(&mut timer)?;
        } else if matches!(self.indirect, Indirect::Gathered(_)) {
            self.record_between(&mut timer)?;
        }
        let mut stats = FrameStats { stages: timer.finish(&self.gpu)? };
        // A whole frame says nothing about turns.
        if let (Some(budget), Pace::Turns) = (&mut self.budget, pace) {
            let gathering = stats.stages.iter().filter(|s| Self::PACED_STAGES.contains(&s.stage));
            let taken = gathering.map(|s| s.millis).sum();
            self.over_budget = budget.is_exhausted(taken).then_some(taken);
            self.indirect.set_frames(budget.measured(taken));
        }
        stats.stages.extend(self.compose(clock)?.stages);
        Ok(stats)
    }

    /// What of the light is new in the next frame.
    fn pace(&self) -> Pace {
        match self.settings.light_every {
            0 | 1 => Pace::Turns,
            every => Pace::Nth { n: self.frames % every, every },
        }
    }

    /// What the camera sees, and how it is lit.
    fn record_view(&mut self, timer: &mut StageTimer, pace: Pace) -> Result<(), RendererError> {
        let Self { gpu, scene, camera, shadowed, injected, indirect, leaves, volumes, .. } = self;
        let (gpu, objects) = (&*gpu, &mut self.objects);
        camera.update(gpu, self.scale);
        shadowed.update(gpu, &self.bounds, &camera.view);
        injected.update(gpu, &self.bounds, self.scale);
        indirect.update(gpu, pace);
        if let Some(objects) = objects {
            objects.update(gpu, &self.places, &self.lights)?;
        }
        if let Some(leaves) = leaves {
            leaves.update(gpu, shadowed.samples(), &self.bounds, &camera.view);
        }
        if let Some(volumes) = volumes {
            volumes.update(gpu, shadowed.samples(), &self.bounds, &camera.view);
        }
        timer.stage(gpu, "raster/gbuffer", |e| {
            camera.record_clear_radiance(e);
            self.gbuffer_pass.record(gpu, e, scene, None, camera)
        })?;
        if let Some(objects) = objects {
            objects.record(gpu, timer, &camera.input)?;
        }
        if let Some(leaves) = leaves {
            leaves.record(gpu, timer, &camera.input)?;
        }
        if let Some(volumes) = volumes {
            volumes.record(gpu, timer, &camera.input)?;
        }
        for batch in &shadowed.batches {
            timer.stage(gpu, "raster/shadow", |e| {
                self.shadow_pass.record(gpu, e, scene, batch, &shadowed.atlas)
            })?;
            let factor = match (batch.shade, &leaves, &volumes) {
                (Shade::Leaves(light), Some(leaves), _) => leaves.factor(light),
                (Shade::Volumes(light), _, Some(volumes)) => volumes.factor(light),
                (shade, ..) => objects.as_ref().and_then(|o| o.factor(shade)),
            };
            timer.stage(gpu, "raster/direct", |e| {
                self.direct_pass.record(gpu, e, shadowed, (batch, factor), camera, &mut self.spare_radiance)
            })?;
        }
        Ok(())
    }

    /// Between updates: pixels go on towards the light of the last, and surfaces that are new, of triangles or of the camera's view,
    /// look around and take the rest from their neighbors.
    fn record_between(&mut self, timer: &mut StageTimer) -> Result<(), RendererError> {
        // Views that keep nothing would leave what the camera sees alone.
        let looks = self.views_fill_volume() && self.settings.voxels != VoxelSource::SingleFrame;
        let Self { gpu, volume, voxelizer, indirect, camera, standing, .. } = self;
        let gpu = &*gpu;
        if looks {
            let light = &mut self.direct_light;
            timer.stage(gpu, "progressive/cleanup", |e| {
                voxelizer.record_begin(gpu, e, &camera.input, Target { volume, light })?;
                indirect.record_cleanup(gpu, e, &camera.input, volume, true)
            })?;
            timer.stage(gpu, "progressive/injection", |e| {
                voxelizer.record_camera(gpu, e, &camera.input, Target { volume, light })?;
                indirect.record_injection(gpu, e, &camera.input, volume)?;
                standing.as_ref().map_or(Ok(()), |s| s.record(gpu, e, volume, indirect))
            })?;
        }
        if std::mem::take(&mut self.surfels_are_stale) || looks {
            let lit = (&*volume, &self.direct_light);
            timer.stage(gpu, "gather/surfels", |e| indirect.record_surfels(gpu, e, volume))?;
            timer.stage(gpu, "gather/trace", |e| indirect.record_seed(gpu, e, lit, &camera.input))?;
            timer.stage(gpu, "gather/bounce", |e| indirect.record_steps(gpu, e, volume, 1))?;
            return Ok(());
        }
        timer.stage(gpu, "gather/fade", |e| indirect.record_fade(gpu, e))?;
        Ok(())
    }

    /// Fills the volume and its light.
    fn record_volume(&mut self, timer: &mut StageTimer) -> Result<(), RendererError> {
        let views_fill = self.views_fill_volume();
        let Self { gpu, settings, scene, camera, injected, volume, voxelizer, indirect, standing, .. } = self;
        let (gpu, surfels_are_stale) = (&*gpu, &mut self.surfels_are_stale);
        // Views to volume, light by light, the camera last.
        let light = &mut self.direct_light;
        let keeps = settings.voxels != VoxelSource::SingleFrame;
        let gathers = matches!(indirect, Indirect::Gathered(_));
        if matches!(indirect, Indirect::Lpv(_)) {
            timer.stage(gpu, "lpv/injection", |e| indirect.record_dark(gpu, e))?;
        }
        if gathers {
            timer.stage(gpu, "gather/surfels", |e| {
                indirect.record_dark(gpu, e)?;
                // Of triangles that moved; those that views bring come below.
                if std::mem::take(surfels_are_stale) {
                    indirect.record_surfels(gpu, e, volume)
                } else {
                    Ok(())
                }
            })?;
        }
        if views_fill {
            timer.stage(gpu, "progressive/cleanup", |e| {
                voxelizer.record_begin(gpu, e, &camera.input, Target { volume, light })?;
                indirect.record_cleanup(gpu, e, &camera.input, volume, keeps)
            })?;
        }
        for source in &mut injected.sources {
            timer.stage(gpu, "raster/rsm", |e| {
                let mut views = source.views.iter_mut();
                views.try_for_each(|v| self.rsm_pass.record(gpu, e, scene, Some(&source.uniform), v))
            })?;
            if let Some(stage) = indirect.light_stage() {
                timer.stage(gpu, stage, |e| indirect.record_light(gpu, e, source, volume))?;
            }
            if views_fill {
                timer.stage(gpu, "progressive/cleanup", |e| {
                    voxelizer.record_cleanup(gpu, e, source, volume)
                })?;
                timer.stage(gpu, "progressive/injection", |e| {
                    voxelizer.record_light(gpu, e, source, Target { volume, light })?;
                    indirect.record_surfaces(gpu, e, source, volume, keeps)
                })?;
            }
        }
        if views_fill {
            timer.stage(gpu, "progressive/injection", |e| {
                voxelizer.record_camera(gpu, e, &camera.input, Target { volume, light })?;
                indirect.record_injection(gpu, e, &camera.input, volume)?;
                standing.as_ref().map_or(Ok(()), |s| s.record(gpu, e, volume, indirect))
            })?;
        }
        if views_fill && gathers {
            timer.stage(gpu, "gather/surfels", |e| indirect.record_surfels(gpu, e, volume))?;
        }

        // Volume to light.
        let [first, stage] = indirect.stages();
        let steps = steps(settings);
        if settings.flow && settings.gi == GiMethod::Propagation {
            let lit = (&*volume, &self.direct_light);
            timer.stage(gpu, stage, |e| indirect.record_flow(gpu, e, lit, steps))?;
        } else {
            timer.stage(gpu, first, |e| {
                indirect.record_seed(gpu, e, (volume, &self.direct_light), &camera.input)
            })?;
            timer.stage(gpu, stage, |e| indirect.record_steps(gpu, e, volume, steps))?;
        }
        Ok(())
    }

    /// Goes on with the light of the last frame, `iterations` steps or bounces more, and makes the picture anew.
    pub fn settle(
        &mut self,
        iterations: u32,
        clock: Option<fn() -> f64>,
    ) -> Result<FrameStats, RendererError> {
        let Self { gpu, volume, indirect, .. } = self;
        let mut timer = StageTimer::new(gpu, clock);
        let [_, stage] = indirect.stages();
        timer.stage(gpu, stage, |e| indirect.record_steps(gpu, e, volume, iterations))?;
        let mut stats = FrameStats { stages: timer.finish(gpu)? };
        stats.stages.extend(self.compose(clock)?.stages);
        Ok(stats)
    }

    /// Fills the volume from triangles that have moved, if that is where it comes from.
    pub(super) fn voxelize_triangles(&mut self, timer: &mut StageTimer) -> Result<(), GpuError> {
        if let Some(standing) = &mut self.standing {
            return standing.voxelize(&self.gpu, timer);
        }
        let Self { gpu, triangles: Some(triangles), volume, indirect, .. } = self else { return Ok(()) };
        if !triangles.is_stale() {
            return Ok(());
        }
        self.surfels_are_stale = true;
        triangles.make_layers(gpu)?;
        timer.stage(gpu, "voxelize/triangles", |e| triangles.record(gpu, e, volume, indirect.gathered_mut()))
    }
}

fn steps(settings: &Settings) -> u32 {
    match settings.gi {
        GiMethod::Off => 0,
        GiMethod::Lpv | GiMethod::Propagation => settings.iterations,
        GiMethod::Gather => settings.bounces,
    }
}
