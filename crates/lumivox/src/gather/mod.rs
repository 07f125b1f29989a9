//! Indirect light by gathering: rays from the surfaces in a volume's cells through its empty space.
//!
//! Propagation ([`crate::light`]) hands light from cell to cell and blurs it on the way. Here each side of the surface in
//! each cell, a *surfel*, traces rays over its hemisphere once, keeps what they met, and from then on a bounce of light
//! is a sum over these. Same volume in, irradiance at the pixels of a G-buffer out.
//!
//! | stage | does |
//! | --- | --- |
//! | `mask` | which of the 4 x 4 x 4 sub-cells of each cell are filled, and which cells of a block |
//! | `surfels` | for each cell and each of six directions, whether there is a surface that faces it |
//! | `inherit` | light that new ones begin with, from those around them |
//! | `due` | which are served in this frame |
//! | `direct` | light of a view (a reflective shadow map) at points of each surfel |
//! | `trace` | rays through the sub-cells; empty cells and blocks are crossed in one step |
//! | `sky_light` | what the sky sends along the rays that leave the grid |
//! | `own_light` | direct and emitted light, which surfels send out by themselves |
//! | `bounce` | radiance of what the rays met becomes irradiance, and irradiance radiance |
//! | `fade` | what pixels see follows in even steps |
//! | `reconstruction` | irradiance at a pixel from the surfels around it that face its way |
//! | `lattice` | light in free space, for an [`IrradianceVolume`] |
//! | `glossy` | what a glossy surface mirrors |
//!
//! **Sub-cells.** Visibility is decided in a grid four times as fine as the volume, a bit for each sub-cell, 8 bytes for each
//! cell; colours stay in the volume. A wall a quarter of a cell thick holds light back, and has a surfel on
//! either side. Where nothing is known of the sub-cells, all of an occupied cell are filled.
//!
//! What is seen through, masks and veils, fills a part of them ([`SeeThrough::Dithered`](crate::voxelize::SeeThrough)), by chance but in each
//! frame the same: a screen that is half open lets half of the rays through.
//!
//! **Light is pulled, not stored.** A surfel asks each view at some of its points what the view sees there: if that is the surfel's
//! own surface, its radiance counts, else the point is in shadow. So a cell half in shadow has half the light, no light
//! outlives its lamp, and no two cells mix.
//!
//! **Energy.** A surfel sends out its albedo's part of the mean of what its rays meet, and its rays stand for equal parts of
//! its irradiance. So no bounce makes energy, whatever the settings, and each that is recorded adds one to the light's path. A ray that
//! meets the inside of something is left out: what it would see is taken to be like the rest.
//!
//! **Order.** [`record_dark`](GatheredLight::record_dark) and [`record_light`](GatheredLight::record_light) for each view in each
//! frame; `mask` and `surfels` after the volume changed; then `trace`, bounces, `reconstruction`. Surfels that are new in a
//! frame receive indirect light at once and direct light in the next.
//! Surfels keep their place and their light from frame to frame, so that one or two bounces a frame are all bounces in time.
//!
//! **Motion.** A surfel that is new begins with the mean light of those around it that it can see, and goes from there to its own by three tenths
//! a frame, and so does one whose sub-cells have nothing in common with those that its place held before, as where a block uncovers the ground; one whose sub-cells or normal have changed likewise, until eight turns after. So what moves through the grid does not boil with the grain
//! of each cell that it comes into, and is late by a few frames with the light that falls on it.
//!
//! **Turns.** Not all surfels need new light in each frame: with [`GatherSettings::frames`] above 1 they take turns, new ones at
//! once, and [`LightBudget`] finds how many can have theirs in the time that a frame has for it. Or the whole waits and is updated
//! every n-th frame ([`begin_nth_frame`](GatheredLight::begin_nth_frame)). Either way what pixels see changes in even steps.

mod bounce;
mod budget;
mod dark;
mod direct;
mod dispatch;
mod due;
mod fade;
mod given_subcells;
mod glossy;
mod inherit;
mod lattice;
mod mask;
mod own_light;
mod passes;
mod readback;
mod reconstruction;
mod settings;
mod sky_light;
mod smooth;
mod store;
mod surfels;
mod trace;
mod turns;
mod view_subcells;

pub use budget::LightBudget;
pub use glossy::{GlossyUniform, MIN_ROUGHNESS};
pub use readback::SurfelCount;
pub use settings::{GatherSettings, GatherUniform, Quality};
pub(crate) use sky_light::CONSTANTS;

use glam::Vec3;

use crate::gpu::{Gpu, GpuError, Shader, Texture, Uniform};
use crate::irradiance::{IrradianceSource, IrradianceVolume};
use crate::progressive::{LightView, ViewInput};
use crate::volume::VolumeBuffer;
use passes::Passes;
use store::Store;
use turns::{FrameTurns, Turns};

/// The shared shader part of surfels.
const SURFEL: &str = include_str!("surfel.wgsl");
/// The shared shader part of rays; after [`SURFEL`].
const MARCH: &str = include_str!("march.wgsl");
/// Where a pixel looks from; after [`MARCH`].
const FREE_POINT: &str = include_str!("free_point.wgsl");
/// Which surfels lie beside each other; after [`MARCH`].
const BESIDE: &str = include_str!("beside.wgsl");
/// Whose turn it is; after [`SURFEL`], with `settings` bound.
const TURN: &str = include_str!("turn.wgsl");
/// Which surfel a ray met; after [`MARCH`].
const MET: &str = include_str!("met.wgsl");
/// What a ray sees; after [`MET`].
const SEEN: &str = include_str!("seen.wgsl");

/// Places of a cell in the table of surfels: two for each face.
const SIDES: usize = 12;
/// No surfel, in tables; the same bits mark a place without one.
const NO_SURFEL: u32 = u32::MAX;
/// A ray not traced yet.
const UNTRACED: u32 = u32::MAX - 2;

/// What is known of the sub-cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subcells {
    /// Nothing: occupied cells are filled.
    Unknown = 0,
    /// What views have shown: here and there thicker than the surface.
    FromViews = 1,
    /// All of them, as thin as they get.
    Given = 2,
}

/// The gathered light of one volume: its stages and what they keep.
#[derive(Debug)]
pub struct GatheredLight {
    passes: Passes,
    settings: GatherSettings,
    uniform: Uniform<GatherUniform>,
    capacity: u32,
    turns: Turns,
    /// Whether the list of surfels that are due is that of another frame, or of other surfels.
    due_is_stale: bool,
    subcells: Subcells,
    store: Store,
}

impl GatheredLight {
    /// Compiles the stages and makes room: 64 bytes for each cell, and for each surfel 108 and 4 for each ray.
    ///
    /// # Errors
    /// A grid or a number of rays that does not fit the device.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer, settings: GatherSettings) -> Result<Self, GpuError> {
        let settings = GatherSettings {
            rays: settings.rays.clamp(1, 1024),
            frames: settings.frames.max(1.0),
            light_points: settings.light_points.clamp(1, 64),
            ..settings
        };
        let (store, capacity) = Store::new(gpu, volume, &settings)?;
        let mut light = Self {
            passes: Passes::new(gpu),
            uniform: Uniform::new(gpu, "gather/settings", &bytemuck::Zeroable::zeroed()),
            settings,
            capacity,
            turns: Turns::default(),
            due_is_stale: true,
            subcells: Subcells::Unknown,
            store,
        };
        light.begin_frame(gpu);
        light.forget_hits(gpu);
        light.set_sky(gpu, |_| settings.sky);
        Ok(light)
    }

    /// Begins a frame, in which some surfels have their turn, or all if [`GatherSettings::frames`] is 1. Once before recording.
    pub fn begin_frame(&mut self, gpu: &Gpu) {
        let turns = self.turns.next(self.settings.frames);
        self.write_turns(gpu, turns);
    }

    /// Begins a frame in which all surfels have their turn, and are shown as they are then.
    pub fn begin_whole_frame(&mut self, gpu: &Gpu) {
        self.begin_nth_frame(gpu, 0, 1);
    }

    /// Begins frame `n` of light that is updated every `every`-th frame: in the first of them all surfels have their turn, and in the
    /// others nothing but [`record_fade`](Self::record_fade) is needed.
    pub fn begin_nth_frame(&mut self, gpu: &Gpu, n: u32, every: u32) {
        self.write_turns(gpu, Turns::nth(n, every));
    }

    /// Changes [`GatherSettings::frames`], from the next frame on.
    pub fn set_frames(&mut self, frames: f32) {
        self.settings.frames = frames.max(1.0);
    }

    fn write_turns(&mut self, gpu: &Gpu, turns: FrameTurns) {
        let GatherSettings { rays, light_points, sky_apart, .. } = self.settings;
        let FrameTurns { share, phase, frames_left } = turns;
        self.due_is_stale = true;
        let sky_apart = u32::from(sky_apart);
        let capacity = self.capacity;
        let uniform =
            GatherUniform { rays, capacity, light_points, sky_apart, share, phase, frames_left, reserved: 0 };
        self.uniform.write(gpu, &uniform);
    }

    /// Changes the sky: radiance from each unit direction, W/(m2 sr), of which 256 means are kept. From the next submission on.
    pub fn set_sky(&self, gpu: &Gpu, radiance: impl Fn(Vec3) -> Vec3) {
        sky_light::SkyLight::write(gpu, &self.store.sky, radiance);
    }

    /// Forgets what all rays met. Not for use inside a frame.
    fn forget_hits(&mut self, gpu: &Gpu) {
        let values = vec![UNTRACED; self.capacity as usize * self.settings.rays as usize];
        gpu.queue.write_buffer(&self.store.hits.raw, 0, bytemuck::cast_slice(&values));
    }

    /// Says which sub-cells of each cell are filled: bit `x + 4 * (y + 4 * z)` of each cell's 64. From then on
    /// these decide what is filled of the volume's occupied cells. Not for use inside a frame.
    ///
    /// # Errors
    /// When there is not one value for each cell.
    pub fn upload_subcells(&mut self, gpu: &Gpu, bits: &[u64]) -> Result<(), GpuError> {
        if std::mem::size_of_val(bits) as u64 != self.store.subcells.size() {
            return Err(GpuError::Validation(format!(
                "{} cells of sub-cells do not fit the volume",
                bits.len()
            )));
        }
        gpu.queue.write_buffer(&self.store.subcells.raw, 0, bytemuck::cast_slice(bits));
        self.subcells = Subcells::Given;
        Ok(())
    }

    /// Clears the sub-cells that `view` proves empty.
    pub fn record_cleanup(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.passes.view_subcells.record_cleanup(gpu, encoder, view, volume, &mut self.store)
    }

    /// Fills the sub-cells that the surfaces in `view` go through: of the views that bring the volume attributes. From then on
    /// these decide what is filled.
    pub fn record_injection(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.subcells = Subcells::FromViews;
        self.passes.view_subcells.record_injection(gpu, encoder, view, volume, &mut self.store)
    }

    /// Empties all sub-cells.
    pub fn record_clear_subcells(&mut self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.store.subcells.raw, 0, None);
    }

    /// Reads from the volume what is filled, and which surfels there are. After every change of the volume.
    pub fn record_surfels(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        let Passes { whole_cells, known_subcells, .. } = &self.passes;
        let mask = if self.subcells == Subcells::Unknown { whole_cells } else { known_subcells };
        mask.record(gpu, encoder, volume, &mut self.store)?;
        // The count of those that find no room.
        encoder.clear_buffer(&self.store.counts.raw, 4, Some(4));
        let inputs = (volume, &self.uniform);
        self.passes.give.record(gpu, encoder, inputs, &mut self.store)?;
        let Store { counts, dispatch, .. } = &mut self.store;
        self.passes.over_surfels.record(gpu, encoder, &self.uniform, counts, dispatch)?;
        self.passes.inherit.record(gpu, encoder, inputs, &mut self.store)?;
        self.due_is_stale = true;
        self.passes.free.record(gpu, encoder, inputs, &mut self.store)
    }

    /// Takes away the direct light of the surfels whose turn it is; each frame, before that of its views.
    pub fn record_dark(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.passes.dark.record(gpu, encoder, &self.uniform, &mut self.store)
    }

    /// Lists the surfels that are served in this frame, if that is not known yet.
    fn record_due(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), GpuError> {
        if !std::mem::take(&mut self.due_is_stale) {
            return Ok(());
        }
        self.passes.due.record(gpu, encoder, &self.uniform, &mut self.store)?;
        let Store { due, dispatch, .. } = &mut self.store;
        self.passes.over_due.record(gpu, encoder, &self.uniform, due, dispatch)
    }

    /// Adds the light of one view: the reflective shadow map of a light, one of the six of a point light, or of one sample
    /// of a large light. Views of one light must not overlap.
    pub fn record_light<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: impl Into<LightView<'v>>,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.record_due(gpu, encoder)?;
        let Self { passes, uniform, store, .. } = self;
        passes.direct.record(gpu, encoder, view.into(), (volume, uniform), store)
    }

    /// Traces this frame's rays, and finds what the sky sends along them.
    pub fn record_trace(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
    ) -> Result<(), GpuError> {
        self.record_due(gpu, encoder)?;
        self.passes.trace.record(gpu, encoder, (volume, &self.uniform), &mut self.store)?;
        self.passes.sky_light.record(gpu, encoder, &self.uniform, &mut self.store)
    }

    /// Takes up the light of this frame's views and of the volume's emission, and adds `count` bounces to what the frames before
    /// left. May be called again to go on, in frames in which all have their turn.
    pub fn record_bounces(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        count: u32,
    ) -> Result<(), GpuError> {
        self.record_due(gpu, encoder)?;
        let Self { passes, uniform, store, .. } = self;
        passes.own_light.record(gpu, encoder, (volume, uniform), store)?;
        for _ in 0..count {
            passes.bounce.record(gpu, encoder, (volume, uniform), store)?;
            std::mem::swap(&mut store.shine, &mut store.next_shine);
        }
        passes.smooth.record(gpu, encoder, (volume, uniform), store)?;
        self.record_fade(gpu, encoder)
    }

    /// What pixels see goes a step towards the light that surfels have. Bounces do it by themselves; frames in which nothing
    /// else is recorded need it.
    pub fn record_fade(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), GpuError> {
        self.passes.fade.record(gpu, encoder, &self.uniform, &mut self.store)
    }

    /// Irradiance in W/m2 at every pixel of a G-buffer, into a target of [`crate::light::IRRADIANCE_FORMAT`]. Black where
    /// nothing was drawn, and where no surfel is near.
    pub fn record_reconstruction(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let pass = &self.passes.reconstruction[self.subcells as usize];
        pass.record(gpu, encoder, volume, &self.store, view, target)
    }

    /// Radiance that a glossy surface of one roughness would mirror at every pixel of a G-buffer, W/(m2 sr), into a target of
    /// [`crate::light::IRRADIANCE_FORMAT`]: the mean over `rays` rays, 1 to 64, about the mirrored view. A host multiplies it by its
    /// surfaces' specular reflectance (the split sum of image-based lighting).
    ///
    /// Roughness is that of glTF, its square the GGX width, and at least [`MIN_ROUGHNESS`]: what is met has one radiance for each side
    /// of a cell, which a sharper mirror would show. Fewer rays are faster and grainier; the pattern stands still at rest. Once in
    /// a frame.
    pub fn record_glossy(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
        (roughness, rays): (f32, u32),
    ) -> Result<(), GpuError> {
        self.passes.glossy.record(gpu, encoder, (volume, &self.store), view, target, (roughness, rays))
    }

    /// For debugging: the share of each pixel's irradiance that comes from surfels which it cannot see, 0 to 1 in red. Where that is
    /// large, light leaks if what stands between parts light from dark: at pixels that see no surfel at all, and wherever nothing is
    /// known of sub-cells.
    pub fn record_leaks(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        self.passes.leaks[self.subcells as usize].record(gpu, encoder, volume, &self.store, view, target)
    }
}

impl IrradianceSource for GatheredLight {
    /// More rays mean less grain; 64 leave a few percent. A host that has no frame to spare asks for one slice a frame, in turn; once
    /// for each volume in a frame.
    fn record_irradiance_volume(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        target: &mut IrradianceVolume,
        (rays, slice, slices): (u32, u32, u32),
    ) -> Result<(), GpuError> {
        let part = (rays.clamp(1, 1024), slice, slices);
        self.passes.lattice.record(gpu, encoder, volume, &self.store, target, part)
    }
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![
        mask::SHADER,
        surfels::SHADER,
        dark::SHADER,
        direct::SHADER,
        given_subcells::SHADER,
        view_subcells::CLEANUP,
        view_subcells::INJECTION,
        inherit::SHADER,
        dispatch::SHADER,
        due::SHADER,
        trace::SHADER,
        sky_light::SHADER,
        lattice::SHADER,
        glossy::SHADER,
        own_light::SHADER,
        bounce::SHADER,
        smooth::SHADER,
        fade::SHADER,
        reconstruction::SHADER,
    ]
}
