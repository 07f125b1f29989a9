//! Single-pass voxelization (6.2.3; dissertation 7.4.3): cleanup and injection in one, without points, sums and atomics.
//!
//! Every cell asks a view once. Its centre is projected into the view as in [`cleanup`](super::cleanup); let `p` be the
//! centre's distance along the view direction, `z` that of what the depth image shows at its texel, and `b` half the
//! cell's extent along the view's depth axis.
//!
//! | condition | the cell is |
//! | --- | --- |
//! | `p < z - b` | cleared, its light too |
//! | `z - b <= p <= z + b`, and the texel shows a surface | written with the attributes and the light of the texel |
//! | else | kept |
//!
//! By the rules [`Footprint`](CleanupRule::Footprint) and [`Rays`](CleanupRule::Rays) the first line asks for the whole cell, as in
//! cleanup, and what lies before the surface at its centre alone is kept. The papers have the first line as it is here.
//!
//! The surface is moved [`SURFACE_SHIFT`] of a cell against its normal first, so that one on a cell boundary belongs to the cell
//! behind its visible side here too. Centres outside the view's frustum are kept, texels on which nothing was drawn show
//! the far plane. Views run one after another, so where two see a cell the later one has the last word. A cell reads and writes
//! itself alone, in place.
//!
//! Light is of this frame, or stored until a view writes the cell again, as the [`LightRule`] says. With one sample per cell, its
//! radiance is the light by either.
//!
//! **One sample per cell and view**, its centre, as in the papers: the cost is one read of each picture per cell, whatever
//! the size of the pictures, and what a cell holds is what one texel shows. What that costs is told at [`SinglePass`].

use crate::gpu::{Bindings, Buffer, ComputePass, Gpu, GpuError, Shader};
use crate::volume::{VolumeBuffer, check_grid};
use crate::wgsl::{GRID, PACK, SH, VIEW, VISIBILITY, linear_groups};

use super::cleanup::{FOOTPRINT, by_rays};
use super::light_resolve::Replace;
use super::nearest::NearestDepth;
use super::{CleanupRule, DirectLight, LightRule, Rules, SURFACE_SHIFT, ViewInput};

const PASS: &str = include_str!("single_pass.wgsl");
/// The rules' texts: `is_cleared`, of a cell whose centre lies so far behind the surface, and of so much reach.
const IF_CENTER: &str = "override SURFACE_SHIFT: f32;
fn is_cleared(cell: vec3u, behind: f32, reach: f32) -> bool { return behind < -reach; }";
const IF_WHOLE: &str =
    "fn is_cleared(cell: vec3u, behind: f32, reach: f32) -> bool { return proven_empty(cell); }";

pub(super) const BY_CENTER: Shader = Shader {
    name: "progressive/single_pass by center",
    parts: &[GRID, VIEW, VISIBILITY, PACK, SH, IF_CENTER, LightRule::PULLED, PASS],
};
pub(super) const BY_FOOTPRINT: Shader = Shader {
    name: "progressive/single_pass by footprint",
    parts: &[GRID, VIEW, VISIBILITY, PACK, SH, FOOTPRINT, IF_WHOLE, LightRule::PULLED, PASS],
};
pub(super) const BY_CENTER_STORED: Shader = Shader {
    name: "progressive/single_pass by center, light stored",
    parts: &[GRID, VIEW, VISIBILITY, PACK, SH, IF_CENTER, LightRule::STORED, PASS],
};
pub(super) const BY_FOOTPRINT_STORED: Shader = Shader {
    name: "progressive/single_pass by footprint, light stored",
    parts: &[GRID, VIEW, VISIBILITY, PACK, SH, FOOTPRINT, IF_WHOLE, LightRule::STORED, PASS],
};

/// The single-pass form of progressive voxelization (6.2.3), for volumes of one grid: used in place of
/// [`Progressive`](super::Progressive), on the same volume, views and light.
///
/// A frame is [`record_begin`](Self::record_begin), [`record_light`](Self::record_light) for each light, then
/// [`record_camera`](Self::record_camera). Each view clears what it proves empty, writes what it shows and keeps the rest.
///
/// What differs from cleanup and injection: a cell takes what *one* texel shows, not the mean of all points in it;
/// attributes are those of the last view that shows the cell, not the mean over views; a later view can clear what an
/// earlier one of the same frame has written, with its light. It needs 4 bytes a cell in place of 92, and its cost depends
/// on the number of cells and not on the number of points: with 61,000 cells and 512 x 512 points in each of three views it
/// took a quarter of the time of cleanup and injection on a software driver.
///
/// The rule of cleanup decides how much stays: of a bunny at 64 cells that a camera goes round, 0.68 of the thin cells that views have seen are
/// occupied by `center`, as the papers have it, and 0.996 by `footprint`.
///
/// **Limits.** The surface is looked for along the ray through a cell's centre alone.
///
/// - Things narrower than a cell slip through between the rays.
/// - A wall across the axis `x`, seen along the direction `d`, comes out `|dx| * (|dx| + |dy| + |dz|)` layers of cells thick
///   on average over its positions within a cell: 1 for `d` along the axis, at 45 degrees from it towards another axis, or
///   along a diagonal; 1.2 at 20 degrees; 0.68 at 60 and 0.32 at 75 degrees. Below 1 it is missed at some positions,
///   and its cells are cleared or kept; above 1 it is two layers thick at some.
/// - In a scene of a floor, a ball and a box, of the 490 to 570 cells that injection fills from one dense view, the single pass
///   fills 52 to 76 % from the same view; of the 760 from three views, 78 %. Of what it fills itself, 12 to 46 % from one
///   view and 24 % from three are cells beside the surface that injection leaves empty.
#[derive(Debug)]
pub struct SinglePass {
    add: ComputePass,
    replace: ComputePass,
    nearest: Option<NearestDepth>,
    decided: Buffer,
    /// Not zero in cells that this frame has lit; none where light is of one frame.
    reached: Option<Buffer>,
}

impl SinglePass {
    /// Compiles the stage, with the default rule.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] when the light of the grid's cells does not fit the device: 177 cells a side on the core tier.
    pub fn new(gpu: &Gpu, volume: &VolumeBuffer) -> Result<Self, GpuError> {
        Self::with_rule(gpu, volume, CleanupRule::default())
    }

    /// As [`Self::new`], with a rule of cleanup.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_rule(gpu: &Gpu, volume: &VolumeBuffer, rule: CleanupRule) -> Result<Self, GpuError> {
        Self::with_rules(gpu, volume, rule.into())
    }

    /// As [`Self::new`], with rules of cleanup and light; light that is stored takes 8 bytes a cell in place of 4.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_rules(gpu: &Gpu, volume: &VolumeBuffer, rules: Rules) -> Result<Self, GpuError> {
        check_grid(gpu, "the direct light of a volume", volume.grid(), DirectLight::CELL_BYTES)?;
        let is_by_center = rules.cleanup == CleanupRule::Center;
        let is_stored = rules.light == LightRule::Stored;
        let shader = match (is_by_center, is_stored) {
            (true, false) => BY_CENTER,
            (true, true) => BY_CENTER_STORED,
            (false, false) => BY_FOOTPRINT,
            (false, true) => BY_FOOTPRINT_STORED,
        };
        let pass = |replace: Replace| {
            let constants =
                [("SURFACE_SHIFT", SURFACE_SHIFT), ("ADDS", replace.adds()), by_rays(rules.cleanup)];
            let taken = if is_by_center { 2 } else { 3 };
            ComputePass::new(gpu, &shader, &constants[..taken])
        };
        let bytes = volume.grid().cell_count() * size_of::<u32>() as u64;
        let marks = |label| Buffer::storage(gpu, label, bytes);
        Ok(Self {
            add: pass(Replace::No),
            replace: pass(Replace::Yes),
            nearest: (!is_by_center).then(|| NearestDepth::new(gpu)),
            decided: marks("single pass/decided")?,
            reached: is_stored.then(|| marks("single pass/reached")).transpose()?,
        })
    }

    /// Begins a frame: no light anywhere unless it is stored. Attributes stay.
    pub fn record_begin(&mut self, encoder: &mut wgpu::CommandEncoder, light: &mut DirectLight) {
        let cleared = self.reached.as_ref().unwrap_or(&light.sh);
        encoder.clear_buffer(&cleared.raw, 0, None);
    }

    /// The views of *one* light: one, or the six of a point light. Where a cell is written, what its texel reflects of the light
    /// is added to the cell's light. The first of the views that has the cell's centre in its picture decides, so a centre
    /// on a border that two views share is neither passed over nor counted twice.
    pub fn record_light<'v>(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        views: impl IntoIterator<Item = &'v ViewInput>,
        volume: &mut VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let Self { add, nearest, decided, reached, .. } = self;
        encoder.clear_buffer(&decided.raw, 0, None);
        let mut marks = (light, decided, reached.as_mut());
        let mut views = views.into_iter();
        views.try_for_each(|view| record((add, nearest), gpu, encoder, view, volume, &mut marks))
    }

    /// The camera, after all lights: where a cell is written, the texel's light takes the place of the lights' sum.
    pub fn record_camera(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &ViewInput,
        volume: &mut VolumeBuffer,
        light: &mut DirectLight,
    ) -> Result<(), GpuError> {
        let Self { replace, nearest, decided, reached, .. } = self;
        encoder.clear_buffer(&decided.raw, 0, None);
        record((replace, nearest), gpu, encoder, view, volume, &mut (light, decided, reached.as_mut()))
    }
}

fn record(
    (pass, nearest): (&ComputePass, &mut Option<NearestDepth>),
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    view: &ViewInput,
    volume: &mut VolumeBuffer,
    (light, decided, reached): &mut (&mut DirectLight, &mut Buffer, Option<&mut Buffer>),
) -> Result<(), GpuError> {
    let groups = linear_groups(volume.grid().cell_count() as u32);
    let (grid, mut channels) = volume.current_mut();
    let [normal, albedo, emission] = channels.as_mut_slice() else {
        return Err(super::resolve::wrong_channels(pass.name()));
    };
    let from = (&view.uniform, &view.textures.depth);
    let levels = nearest.as_mut().map(|n| n.record(gpu, encoder, from)).transpose()?;
    let mut bindings = Bindings::new()
        .read("grid", grid)
        .read("view", &view.uniform)
        .read("depth", &view.textures.depth)
        .read("normal", &view.textures.normal)
        .read("albedo", &view.textures.albedo)
        .read("emission", &view.textures.emission)
        .read("radiance", &view.textures.radiance)
        .write("cell_normal", normal)
        .write("cell_albedo", albedo)
        .write("cell_emission", emission)
        .write("light", &mut light.sh)
        .write("decided", decided);
    if let Some(reached) = reached {
        bindings = bindings.write("reached", reached);
    }
    if let Some(levels) = levels {
        bindings = bindings.read("levels", levels);
    }
    pass.record(gpu, encoder, &bindings, groups)
}
