//! What is rendered, and how well.

use glam::UVec2;
use lumivox::gather::{GatherSettings, Quality};
use lumivox::light::{LightSettings, Reflection};
use lumivox::lpv::Blocking;
use lumivox::progressive::{CleanupRule, LightRule, Rules};
use lumivox::visibility::{OcclusionSettings, ReflectionSettings, ShadowSettings};

use super::{GlassSettings, LeafShadowSettings};
use crate::composite::Layer;
use crate::voxel_view::{Slice, VoxelChannel};

/// Where the volume comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoxelSource {
    /// All triangles of the scene, once; then views add what they see.
    Triangles,
    /// Views alone, kept from frame to frame.
    Progressive,
    /// As [`Self::Progressive`], in the single-pass form: a cell asks each view once.
    SinglePass,
    /// Views alone, from nothing in every frame.
    SingleFrame,
    /// As [`Self::Progressive`], but what stands still comes from its triangles, once, and no view clears it.
    Hybrid,
}

impl VoxelSource {
    /// Whether cleanup and injection keep cells from frame to frame.
    pub(super) fn keeps_cells(self) -> bool {
        matches!(self, Self::Progressive | Self::Hybrid)
    }
}

/// How indirect light is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GiMethod {
    /// Not at all.
    Off,
    /// Light propagation volumes, the baseline: no surfaces but those that blocking asks for.
    Lpv,
    /// Iterative propagation through the volume.
    Propagation,
    /// Rays through the volume.
    Gather,
}

/// A coat of polish on every surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polish {
    /// How rough it is, and what reflections are made of.
    pub reflections: ReflectionSettings,
    /// The part of light that it mirrors head on, 0 to 1; the rest goes to the surface below. By Schlick's formula more at grazing
    /// angles.
    pub reflectance: f32,
}

/// What is rendered, and how well.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Width and height of the picture.
    pub size: UVec2,
    /// The clip that the scene will move by, so that the volume holds all of its motion; none for a scene that stands still.
    pub clip: Option<usize>,
    /// Cells along the longest side of the scene. More resolve finer shadows of indirect light; memory grows with the cube,
    /// and light needs more iterations to cross a room.
    pub grid: u32,
    /// Where the volume comes from.
    pub voxels: VoxelSource,
    /// When a view proves a cell empty, with the sources that keep cells from frame to frame.
    pub cleanup: CleanupRule,
    /// How long direct light stays in the cells that iterative propagation starts from, which [`Layer::Voxels`] shows too. Gathered light
    /// and light propagation volumes ask lights anew in each frame, whatever this says.
    pub light_rule: LightRule,
    /// How indirect light is found.
    pub gi: GiMethod,
    /// Propagation steps in every frame, of propagation and of light propagation volumes.
    pub iterations: u32,
    /// How light is gathered; its sky is the scene's.
    pub gather: GatherSettings,
    /// Bounces of gathered light in every frame.
    pub bounces: u32,
    /// Frames from one update of the volume and its light to the next, 1 for every frame. In the frames between, the picture of
    /// gathered light goes in even steps from one to the next, so that it is late by as many frames; other light changes in jumps.
    pub light_every: u32,
    /// Milliseconds that gathered light may take of a frame, whatever `gather.frames` says; a frame has to be measured for it.
    pub light_budget: Option<f64>,
    /// How light propagates; its sky is the scene's.
    pub light: LightSettings,
    /// Whether propagated light goes on flowing from frame to frame, by as many steps as `iterations` says, in place of beginning
    /// anew. At rest a few come to the light of all bounces.
    pub flow: bool,
    /// How the surfaces of propagation reflect.
    pub reflection: Reflection,
    /// What holds the light of light propagation volumes back.
    pub lpv_blocking: Blocking,
    /// Texels a side of the atlas of shadow maps: the map of a directional or spot light has all of them, a view of a point
    /// light half, a sample of the sky a quarter, of a rect light an eighth. More give sharper shadows. A power of two.
    pub shadow_size: u32,
    /// Samples that the sky is cut into for the picture, each with its own shadow map; a rect light has a quarter as many, with
    /// five maps each. More give smoother shadows, at the price of so many small lights. With 0, rect lights are dark
    /// and the sky comes in by propagation.
    pub area_samples: u32,
    /// Samples that they are cut into for the volume, which is coarser.
    pub area_maps: u32,
    /// Texels a side of a directional or spot light's reflective shadow map; the views of point and area lights have half as
    /// many.
    pub rsm_size: u32,
    /// Injection points a side of a light's view. The camera injects every pixel up to this many a side.
    pub points: u32,
    /// Whether textures are filtered over the area of a pixel (mip levels, anisotropic), as pictures need it; without, they are
    /// looked up at a point and decoded exactly, as a path tracer does, to compare with one.
    pub filtered_textures: bool,
    /// Whether objects with visibility fields take light of the sky by look-ups in these, in place of shadow maps, and how.
    pub occlusion: Option<OcclusionSettings>,
    /// The same for the shadows that they throw in the light of lamps.
    pub soft_shadows: Option<ShadowSettings>,
    /// Radius of point and spot lights in such shadows, metres.
    pub light_radius: f32,
    /// Whether all surfaces are polished: what they mirror of objects with visibility fields is looked up in these.
    pub polish: Option<Polish>,
    /// Whether masked surfaces let a part of the light of suns, spots and points through, and how much.
    pub leaf_shadows: Option<LeafShadowSettings>,
    /// Whether opaque surfaces throw the shadows of suns, spots and points by shadow volumes in place of maps: sharp at any distance.
    pub volume_shadows: bool,
    /// Whether slicemaps tell which of them no visible surface needs, and these are left out. The picture is the same. Pays where filling
    /// pixels is dear; a software driver takes longer to find out than to draw.
    pub culls_volumes: bool,
    /// Whether materials of glass are seen through, and how; else they are surfaces like any other. Takes the place of the picture's last
    /// stage in [`Layer::Final`].
    pub glass: Option<GlassSettings>,
    /// What the picture shows.
    pub layer: Layer,
    /// Roughness of the surfaces in [`Layer::Glossy`], 0.3 to 1: less is a sharper mirror.
    pub roughness: f32,
    /// What [`Layer::Voxels`] shows of cells.
    pub voxel_channel: VoxelChannel,
    /// The layer of cells that it shows, or all.
    pub voxel_slice: Option<Slice>,
}

impl Settings {
    /// The defaults with what a preset says about indirect light.
    ///
    /// | preset | cells along the longest side | bounces per frame | maps of a large light |
    /// | --- | ---: | ---: | ---: |
    /// | low | 32 | 2 | 8 |
    /// | medium | 64 | 2 | 32 |
    /// | high | 64 | 2 | 64 |
    /// | reference | 96 | 4 | 256 |
    ///
    /// Rays and points are those of [`GatherSettings::of`], and what presets cost and err in all is told at [`Quality`]. Of the knobs here:
    ///
    /// | knob | more brings | more costs |
    /// | --- | --- | --- |
    /// | `grid` | finer shadows of indirect light, and with triangles a smaller error | twice the cells are eight times the memory of cells, and four times the surfels with their rays and bounces |
    /// | `bounces` | light that goes on sooner, so that all bounces of a lamp are there after fewer frames. Where light rests it makes no difference | a sum over the rays of all surfels in turn, each |
    /// | `area_maps` | light of the sky and of rect lights in the volume with smoother shadows | a view of the scene each, drawn and asked by all surfels in turn |
    ///
    /// With views alone a finer grid has more holes, where points lie farther apart than its cells or no view looks, and light leaves
    /// through them: in the Cornell box one frame of views comes to 0.91, 0.85 and 0.77 of the light at 32, 64 and 96 cells. Volumes from
    /// triangles do not lose it (1.00, 0.99 and 0.99), nor does [`VoxelSource::Hybrid`] with what stands still.
    pub fn of(quality: Quality) -> Self {
        let (grid, bounces, area_maps) = match quality {
            Quality::Low => (32, 2, 8),
            Quality::Medium => (64, 2, 32),
            Quality::High => (64, 2, 64),
            Quality::Reference => (96, 4, 256),
        };
        Self { grid, bounces, area_maps, gather: GatherSettings::of(quality), ..Self::default() }
    }

    /// What the volume is kept up by.
    pub(super) fn rules(&self) -> Rules {
        Rules { cleanup: self.cleanup, light: self.light_rule }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: UVec2::new(960, 540),
            clip: None,
            grid: 64,
            voxels: VoxelSource::Progressive,
            cleanup: CleanupRule::default(),
            light_rule: LightRule::default(),
            gi: GiMethod::Gather,
            iterations: 64,
            gather: GatherSettings::default(),
            bounces: 2,
            light_every: 1,
            light_budget: None,
            light: LightSettings::default(),
            flow: false,
            reflection: Reflection::default(),
            lpv_blocking: Blocking::None,
            shadow_size: 2048,
            area_samples: 64,
            area_maps: 32,
            rsm_size: 512,
            points: 1024,
            filtered_textures: true,
            occlusion: None,
            soft_shadows: None,
            light_radius: 0.1,
            polish: None,
            leaf_shadows: None,
            volume_shadows: false,
            culls_volumes: false,
            glass: None,
            layer: Layer::Final,
            roughness: 0.4,
            voxel_channel: VoxelChannel::Lit,
            voxel_slice: None,
        }
    }
}
