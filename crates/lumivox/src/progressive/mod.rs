//! Progressive screen-space voxelization: a volume made and kept up from rendered views.
//!
//! Source: *Progressive Screen-Space Multichannel Surface Voxelization* (2013), 6.2 and 6.3; dissertation chapter 7, where
//! it is called incremental voxelization.
//!
//! Each frame has two phases. *Cleanup* asks each view about each occupied cell: one that lies before everything that the
//! view's depth image shows there is proven empty and cleared, by one of two rules ([`CleanupRule`]). It runs once per view,
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
//! **Lighting rule** (6.3, two traps closed). Attributes persist, light does not. Each frame the direct light of a
//! cell is, per light, the *mean* exitant radiance of the samples of that light's map that fall in it, summed over the lights;
//! where camera samples fall in, their mean *replaces* that sum, since the camera's picture holds all lights at once. A
//! mean does not grow with the number of points, and what is made afresh each frame cannot outlive its lamp. The
//! paper adds samples up, and keeps light of cells that no view sees until one does.
//!
//! **Limits.** Extents stay fixed while a volume lives. Stale cells that no view sees stay (6.6).

mod attribute_view;
mod bricks;
mod cascade;
mod channel;
mod cleanup;
mod dense;
mod injection;
mod light_injection;
mod light_resolve;
mod nearest;
mod points;
mod resolve;
mod single_pass;
mod static_cells;
mod view;

use glam::Vec4;

use crate::gpu::{Buffer, GeneratedText, Gpu, GpuError, Shader};
use crate::volume::{ALBEDO, EMISSION, NORMAL, VolumeBuffer, check_grid, half4};

pub use attribute_view::AttributeView;
pub use bricks::{
    BRICK_SIDE, BrickCell, BrickUniform, FrameDiagnostics, ProgressiveVoxelizer, StaticUniform,
    VoxelizerSettings,
};
pub use cascade::{
    BLEND_CELLS, CASCADE_QUERIES, Cascade, CascadeCells, CascadeSample, LumivoxCascade, MAX_LEVELS,
    cascade_wgsl,
};
pub use channel::{AttributeChannel, AttributeKind};
pub use cleanup::CleanupRule;
pub use dense::{DenseVoxelizer, Storage};
pub use injection::SURFACE_SHIFT;
pub use light_injection::LIGHT_SUM_WORDS;
pub use points::{InjectionGrid, InjectionPattern};
pub use single_pass::SinglePass;
pub use static_cells::StaticCells;
pub use view::{InjectionScale, LightView, ViewInput, ViewTextures};

use cleanup::Cleanup;
use injection::{ATTRIBUTE_SUM_WORDS, Injection};
use light_injection::LightInjection;
use light_resolve::{LightResolve, Replace};
use resolve::Resolve;

/// The channels that progressive voxelization keeps up.
pub const CHANNELS: [&str; 3] = [NORMAL, ALBEDO, EMISSION];

/// Direct light leaving each cell: three colour bands of four spherical harmonics coefficients in half floats, 24 bytes a
/// cell, in W/(m2 sr) times the clamped-cosine lobe about the surface normal, so that the integral over the sphere is
/// the cell's radiosity in W/m2. Entry `3 * cell + band`.
#[derive(Debug)]
pub struct DirectLight {
    pub(crate) sh: Buffer,
}

impl DirectLight {
    /// Bytes of one cell.
    pub const CELL_BYTES: u64 = 24;

    /// The coefficients, for shaders: `array<vec2u>` of packed half floats.
    pub fn coefficients(&self) -> &Buffer {
        &self.sh
    }

    /// Reads the coefficients back, three bands per cell. Waits; not for use inside a frame.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Vec<[Vec4; 3]>, GpuError> {
        let packed: Vec<[[half::f16; 4]; 3]> = crate::gpu::read_buffer(gpu, &self.sh)?;
        Ok(packed.iter().map(|cell| cell.map(|band| Vec4::from(band.map(half::f16::to_f32)))).collect())
    }

    /// Replaces the coefficients with values from memory, one entry per cell. Not for use inside a frame.
    pub fn upload(&mut self, gpu: &Gpu, values: &[[Vec4; 3]]) {
        let packed: Vec<_> = values.iter().map(|c| c.map(|band| half4(&band))).collect();
        gpu.queue.write_buffer(&self.sh.raw, 0, bytemuck::cast_slice(&packed));
    }
}

/// The stages of progressive voxelization with the sums they work in, for volumes of one grid.
#[derive(Debug)]
pub struct Progressive {
    cleanup: Cleanup,
    injection: Injection,
    light_injection: LightInjection,
    resolve: Resolve,
    add_light: LightResolve,
    replace_light: LightResolve,
    attribute_sums: Buffer,
    /// None where light is not asked for.
    light_sums: Option<Buffer>,
}

impl Progressive {
    /// Compiles the stages and makes room for the sums of `volume`'s grid: 92 bytes a cell, which is the largest
    /// thing there is here and limits a cubic grid on the core tier to 137 cells a side.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        Self::with_rule(gpu, volume, CleanupRule::default())
    }

    /// As [`Self::new`], with a rule of cleanup.
    pub fn with_rule(gpu: &Gpu, volume: &VolumeBuffer, rule: CleanupRule) -> Result<Self, GpuError> {
        check_grid(gpu, "the sums of injected light", volume.grid(), LIGHT_SUM_WORDS * 4)?;
        let bytes = volume.grid().cell_count() * LIGHT_SUM_WORDS * 4;
        let light_sums = Buffer::storage(gpu, "injection/light sums", bytes)?;
        Ok(Self { light_sums: Some(light_sums), ..Self::of_surfaces(gpu, volume, rule)? })
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
            light_injection: LightInjection::new(gpu),
            resolve: Resolve::new(gpu),
            add_light: LightResolve::new(gpu, Replace::No),
            replace_light: LightResolve::new(gpu, Replace::Yes),
            attribute_sums: Buffer::storage(gpu, "injection/attribute sums", bytes)?,
            light_sums: None,
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

    /// Begins the frame's injection: no samples yet, no light anywhere.
    pub fn record_begin(&mut self, encoder: &mut wgpu::CommandEncoder, light: &mut DirectLight) {
        encoder.clear_buffer(&self.attribute_sums.raw, 0, None);
        encoder.clear_buffer(&light.sh.raw, 0, None);
    }

    /// Injects the maps of *one* light: one view, or the six of a point light. Adds the mean of their samples to the light
    /// of each cell they fall in, and collects the attributes they show.
    pub fn record_light<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: impl IntoIterator<Item = &'v ViewInput>,
        volume: &VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let Some(view) = self.record_points(gpu, encoder, views, volume)? else { return Ok(()) };
        self.add_light.record(gpu, encoder, (&view.uniform, volume), with_light(&self.light_sums)?, light)
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
        let sums = self.light_sums.as_mut().ok_or_else(no_light)?;
        encoder.clear_buffer(&sums.raw, 0, None);
        let mut last = None;
        for view in views {
            let view = view.into();
            self.light_injection.record(gpu, encoder, view, volume, sums)?;
            last = Some(view.uniform);
        }
        let Some(view) = last else { return Ok(()) };
        self.add_light.record(gpu, encoder, (view, volume), sums, light)
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
        self.record_points(gpu, encoder, [view], volume)?;
        let sums = with_light(&self.light_sums)?;
        self.replace_light.record(gpu, encoder, (&view.uniform, volume), sums, light)
    }

    /// Ends the frame's injection: cells with samples take the mean of their attributes over all views (6.2.2). `view` is
    /// any of the frame's views; all were updated with the same scale.
    pub fn record_end(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.resolve.record(gpu, encoder, view, &self.attribute_sums, volume)
    }

    /// Sums the points of the views, attributes and light; returns one of the views.
    fn record_points<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: impl IntoIterator<Item = &'v ViewInput>,
        volume: &VolumeBuffer,
    ) -> Result<Option<&'v ViewInput>, GpuError> {
        let sums = self.light_sums.as_mut().ok_or_else(no_light)?;
        encoder.clear_buffer(&sums.raw, 0, None);
        let mut last = None;
        for view in views {
            self.injection.record(gpu, encoder, view, volume, &mut self.attribute_sums)?;
            self.light_injection.record(gpu, encoder, view.into(), volume, sums)?;
            last = Some(view);
        }
        Ok(last)
    }
}

fn with_light(sums: &Option<Buffer>) -> Result<&Buffer, GpuError> {
    sums.as_ref().ok_or_else(no_light)
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
        light_resolve::SHADER,
        resolve::SHADER,
        single_pass::BY_CENTER,
        static_cells::SHADER,
        cascade::SHADER,
        single_pass::BY_FOOTPRINT,
    ];
    [others, of_bricks].concat()
}
