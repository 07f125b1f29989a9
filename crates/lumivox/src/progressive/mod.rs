//! Progressive screen-space voxelization: a volume made and kept up from rendered views.
//!
//! Source: *Progressive Screen-Space Multichannel Surface Voxelization* (2013), 6.2 and 6.3; dissertation chapter 7, where
//! it is called incremental voxelization.
//!
//! Each frame has two phases. *Cleanup* asks each view about each occupied cell: one that lies before everything that the
//! view's depth image shows there is proven empty and cleared, by one of three rules ([`CleanupRule`]). It runs once per view,
//! each in its own ping-pong turn. *Injection* then turns the views' texels into surface points, and the cells they fall
//! in are written. Cells that no view sees keep what they held: that is what makes the volume grow over the frames.
//!
//! [`SinglePass`] does both in one stage (6.2.3): cheaper, and coarser. A host uses the one or the other.
//!
//! What stands still can be made of triangles instead, once: [`StaticCells`].
//!
//! What a view must bring is [`ViewTextures`]. The camera's G-buffer and the lights' reflective shadow maps have the
//! same pictures, and any other depth image with attributes will do.
//!
//! **Lighting rule** (6.3): attributes persist, and light does as [`LightRule`] says. By default it does not: what is made afresh
//! in each frame cannot outlive its lamp. By the papers' rule it stays in cells that no view samples until one does.
//!
//! **Limits.** Of [`Progressive`] and [`SinglePass`]: extents stay fixed while a volume lives, and stale cells that no view sees stay
//! (6.6). Volumes of bricks, [`ProgressiveVoxelizer`], may move and let cells die of age.

mod attribute_view;
mod bricks;
mod cascade;
mod cell_ages;
mod channel;
mod cleanup;
mod dense;
mod direct_light;
mod injection;
mod light_injection;
mod light_resolve;
mod light_rule;
mod light_stages;
mod light_store;
mod nearest;
mod points;
mod resolve;
mod single_pass;
mod static_cells;
mod view;

use crate::gpu::{Buffer, GeneratedText, Gpu, GpuError, Shader};
use crate::volume::{ALBEDO, EMISSION, NORMAL, VolumeBuffer, check_grid};

pub use attribute_view::AttributeView;
pub use bricks::{
    BRICK_SIDE, BrickCell, BrickUniform, FrameClock, FrameDiagnostics, ProgressiveVoxelizer, StaticUniform,
    VoxelizerSettings,
};
pub use cascade::{
    BLEND_CELLS, CASCADE_QUERIES, Cascade, CascadeCells, CascadeSample, LumivoxCascade, MAX_LEVELS,
    cascade_wgsl,
};
pub use cell_ages::CellAges;
pub use channel::{AttributeChannel, AttributeKind};
pub use cleanup::CleanupRule;
pub use dense::{DenseVoxelizer, Storage};
pub use direct_light::DirectLight;
pub use injection::SURFACE_SHIFT;
pub use light_injection::LIGHT_SUM_WORDS;
pub use light_rule::{LightRule, Rules};
pub use points::{InjectionGrid, InjectionPattern};
pub use single_pass::SinglePass;
pub use static_cells::StaticCells;
pub use view::{InjectionScale, LightView, ViewInput, ViewTextures};

use cleanup::Cleanup;
use injection::{ATTRIBUTE_SUM_WORDS, Injection};
use light_stages::{LightStages, Sampler};
use resolve::Resolve;

/// The channels that progressive voxelization keeps up.
pub const CHANNELS: [&str; 3] = [NORMAL, ALBEDO, EMISSION];

/// The stages of progressive voxelization with the sums they work in, for volumes of one grid.
#[derive(Debug)]
pub struct Progressive {
    cleanup: Cleanup,
    injection: Injection,
    resolve: Resolve,
    attribute_sums: Buffer,
    /// None where light is not asked for.
    light: Option<LightStages>,
}

impl Progressive {
    /// Compiles the stages and makes room for the sums of `volume`'s grid: 92 bytes a cell, which is the largest
    /// thing there is here and limits a cubic grid on the core tier to 137 cells a side.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        Self::with_rule(gpu, volume, CleanupRule::default())
    }

    /// As [`Self::new`], with a rule of cleanup.
    pub fn with_rule(gpu: &Gpu, volume: &VolumeBuffer, rule: CleanupRule) -> Result<Self, GpuError> {
        Self::with_rules(gpu, volume, rule.into())
    }

    /// As [`Self::new`], with rules of cleanup and light; light that is stored takes 96 bytes a cell in place of 92.
    pub fn with_rules(gpu: &Gpu, volume: &VolumeBuffer, rules: Rules) -> Result<Self, GpuError> {
        let light = LightStages::new(gpu, volume, rules.light)?;
        Ok(Self { light: Some(light), ..Self::of_surfaces(gpu, volume, rules.cleanup)? })
    }

    /// Without the sums of light, 40 bytes a cell, for hosts that light surfaces by themselves: [`Self::record_surfaces`] takes the
    /// place of [`Self::record_light`] and [`Self::record_camera`], which are errors then.
    pub fn of_surfaces(gpu: &Gpu, volume: &VolumeBuffer, rule: CleanupRule) -> Result<Self, GpuError> {
        let cell_bytes = ATTRIBUTE_SUM_WORDS * 4;
        check_grid(gpu, "the sums of injected attributes", volume.grid(), cell_bytes)?;
        let bytes = volume.grid().cell_count() * cell_bytes;
        Ok(Self {
            cleanup: Cleanup::new(gpu, rule),
            injection: Injection::new(gpu),
            resolve: Resolve::new(gpu),
            attribute_sums: Buffer::storage(gpu, "injection/attribute sums", bytes)?,
            light: None,
        })
    }

    /// Room for the direct light of `volume`'s cells.
    pub fn direct_light(gpu: &Gpu, volume: &VolumeBuffer) -> Result<DirectLight, GpuError> {
        check_grid(gpu, "the direct light of a volume", volume.grid(), DirectLight::CELL_BYTES)?;
        let bytes = volume.grid().cell_count() * DirectLight::CELL_BYTES;
        Ok(DirectLight { sh: Buffer::storage(gpu, "light/direct", bytes)? })
    }

    /// Clears the cells that `view` proves empty (6.2.1). The first view of each size makes room for the levels of its depth.
    pub fn record_cleanup(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.cleanup.record(gpu, encoder, view, volume)
    }

    /// Begins the frame's injection of views that bring no light.
    pub fn record_begin_surfaces(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.attribute_sums.raw, 0, None);
    }

    /// Injects the attributes that views show, without their light.
    pub fn record_surfaces<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: impl IntoIterator<Item = &'v ViewInput>,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Self { injection, attribute_sums, .. } = self;
        views.into_iter().try_for_each(|view| injection.record(gpu, encoder, view, volume, attribute_sums))
    }

    /// Begins the frame's injection: no samples yet, and no light anywhere unless it is stored.
    pub fn record_begin(&mut self, encoder: &mut wgpu::CommandEncoder, light: &mut DirectLight) {
        encoder.clear_buffer(&self.attribute_sums.raw, 0, None);
        if let Some(stages) = &mut self.light {
            stages.record_begin(encoder, light);
        }
    }

    /// Injects the maps of *one* light: one view, or the six of a point light. Adds the mean of their samples, or by the rule
    /// [`LightRule::Stored`] their sum, to the light of each cell they fall in, and collects the attributes they show.
    pub fn record_light<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: impl IntoIterator<Item = &'v ViewInput>,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        self.record_samples(gpu, encoder, Sampler::Light, views, volume, light)
    }

    /// As [`Self::record_light`], for views that add light alone: the same light is added, and no attributes are collected.
    /// For lights that take many views to sample, of which few show anything new; each sample that lights by itself is a
    /// light of its own here.
    pub fn record_light_only<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: impl IntoIterator<Item = impl Into<LightView<'v>>>,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let stages = self.light.as_mut().ok_or_else(no_light)?;
        stages.record_clear(encoder);
        let mut last = None;
        for view in views {
            let view = view.into();
            stages.record_points(gpu, encoder, Sampler::Light, view, volume)?;
            last = Some(view.uniform);
        }
        let Some(view) = last else { return Ok(()) };
        stages.record_resolve(gpu, encoder, Sampler::Light, (view, volume), light)
    }

    /// Injects the camera, after all lights: where its samples fall, their mean replaces the sum of the lights.
    pub fn record_camera(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        self.record_samples(gpu, encoder, Sampler::Camera, [view], volume, light)
    }

    /// Ends the frame's injection: cells with samples take the mean of their attributes over all views (6.2.2), and stored light
    /// of cells that are gone goes. `view` is any of the frame's views; all were updated with the same scale.
    pub fn record_end(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let stages = self.light.as_ref().ok_or_else(no_light)?;
        stages.record_end(gpu, encoder, volume, light)?;
        self.record_end_surfaces(gpu, encoder, view, volume)
    }

    /// As [`Self::record_end`], for frames of views that bring no light.
    pub fn record_end_surfaces(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.resolve.record(gpu, encoder, view, &self.attribute_sums, volume)
    }

    /// Sums the points of the views, attributes and light, and makes light of these sums.
    fn record_samples<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sampler: Sampler,
        views: impl IntoIterator<Item = &'v ViewInput>,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let stages = self.light.as_mut().ok_or_else(no_light)?;
        stages.record_clear(encoder);
        let mut last = None;
        for view in views {
            self.injection.record(gpu, encoder, view, volume, &mut self.attribute_sums)?;
            stages.record_points(gpu, encoder, sampler, view.into(), volume)?;
            last = Some(view);
        }
        let Some(view) = last else { return Ok(()) };
        stages.record_resolve(gpu, encoder, sampler, (&view.uniform, volume), light)
    }
}

fn no_light() -> GpuError {
    let reason = "this was made for surfaces, without room for light".to_owned();
    GpuError::Binding { pass: light_injection::SHADER.name, reason }
}

/// Numbers that look-ups of bricks spell out too.
pub(crate) const CONSTANTS: [(&str, f32); 5] = [
    ("BRICK_SIDE", BRICK_SIDE as f32),
    ("HEADER", bricks::HEADER as f32),
    ("LUMIVOX_BRICK_SIDE", BRICK_SIDE as f32),
    ("LUMIVOX_BRICK_HEADER", bricks::HEADER as f32),
    ("LUMIVOX_CASCADE_BLEND", BLEND_CELLS),
];

/// The texts that volumes make of some sets of channels.
pub(crate) fn texts() -> Vec<GeneratedText> {
    [bricks::texts(), dense::texts()].concat()
}

pub(crate) fn shaders() -> Vec<Shader> {
    let of_bricks = bricks::shaders();
    let others = vec![
        cleanup::BY_CENTER,
        cleanup::BY_FOOTPRINT,
        nearest::SHADER,
        injection::SHADER,
        light_injection::SHADER,
        light_resolve::PULLED,
        light_resolve::STORED,
        light_store::SHADER,
        resolve::SHADER,
        single_pass::BY_CENTER,
        single_pass::BY_CENTER_STORED,
        static_cells::SHADER,
        cascade::SHADER,
        cell_ages::SHADER,
        single_pass::BY_FOOTPRINT,
        single_pass::BY_FOOTPRINT_STORED,
    ];
    [others, of_bricks].concat()
}
