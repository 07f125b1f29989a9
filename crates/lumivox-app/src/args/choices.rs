//! One of a few words.

use clap::ValueEnum;
use lumivox::gather::Quality;
use lumivox::light::Reflection;
use lumivox::lpv::Blocking;
use lumivox::progressive::{CleanupRule, LightRule};
use lumivox_render::voxel_view::VoxelChannel;
use lumivox_render::{GiMethod, Layer, VoxelSource};

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum VoxelizerArg {
    /// All triangles of the scene.
    Triangles,
    /// What views have shown so far.
    Progressive,
    /// The same, each cell asking each view once.
    SinglePass,
    /// What views show in this frame.
    SingleFrame,
    /// What stands still from its triangles, once; what moves as progressive.
    Hybrid,
}

impl From<VoxelizerArg> for VoxelSource {
    fn from(arg: VoxelizerArg) -> Self {
        match arg {
            VoxelizerArg::Triangles => Self::Triangles,
            VoxelizerArg::Progressive => Self::Progressive,
            VoxelizerArg::SinglePass => Self::SinglePass,
            VoxelizerArg::SingleFrame => Self::SingleFrame,
            VoxelizerArg::Hybrid => Self::Hybrid,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum CleanupArg {
    /// What stands behind its centre lies farther: the papers'. Loses good cells at silhouettes.
    Center,
    /// What stands behind all of it lies farther.
    Footprint,
    /// Everywhere what stands behind it lies farther: clears more beside floors and walls.
    Rays,
}

impl From<CleanupArg> for CleanupRule {
    fn from(arg: CleanupArg) -> Self {
        match arg {
            CleanupArg::Center => Self::Center,
            CleanupArg::Footprint => Self::Footprint,
            CleanupArg::Rays => Self::Rays,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum LightRuleArg {
    /// In the frame in which a view samples them.
    Pulled,
    /// Until a view samples them again, though their lamp goes out: the papers'.
    Stored,
}

impl From<LightRuleArg> for LightRule {
    fn from(arg: LightRuleArg) -> Self {
        match arg {
            LightRuleArg::Pulled => Self::Pulled,
            LightRuleArg::Stored => Self::Stored,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum GiArg {
    /// Direct light only.
    Off,
    /// Light propagation volumes: from cell to cell through everything. The baseline.
    Lpv,
    /// From cell to cell, step by step: soft, and blurred.
    Propagation,
    /// Along rays through the volume: sharper, and nearer to the truth.
    Gather,
}

impl From<GiArg> for GiMethod {
    fn from(arg: GiArg) -> Self {
        match arg {
            GiArg::Off => Self::Off,
            GiArg::Lpv => Self::Lpv,
            GiArg::Propagation => Self::Propagation,
            GiArg::Gather => Self::Gather,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum MirrorArg {
    /// They scatter it.
    None,
    /// Back through the face that it came by: the dissertation's.
    Axis,
    /// About their mean normal.
    Normal,
}

impl From<MirrorArg> for Reflection {
    fn from(arg: MirrorArg) -> Self {
        match arg {
            MirrorArg::None => Self::Lambertian,
            MirrorArg::Axis => Self::AxisMirror,
            MirrorArg::Normal => Self::NormalMirror,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum BlockingArg {
    /// Nothing.
    None,
    /// Surfaces that views show.
    Fuzzy,
    /// These, and they reflect.
    Reflecting,
}

impl From<BlockingArg> for Blocking {
    fn from(arg: BlockingArg) -> Self {
        match arg {
            BlockingArg::None => Self::None,
            BlockingArg::Fuzzy => Self::Fuzzy,
            BlockingArg::Reflecting => Self::Reflecting,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum QualityArg {
    /// 32 cells, 32 rays a surfel, half of the surfels in each frame of a series.
    Low,
    /// 64 cells, 64 rays a surfel, half of the surfels in each frame of a series.
    Medium,
    /// 64 cells, 256 rays.
    High,
    /// 96 cells, 192 rays: slow, to see what is left of the error.
    Reference,
}

impl From<QualityArg> for Quality {
    fn from(arg: QualityArg) -> Self {
        match arg {
            QualityArg::Low => Self::Low,
            QualityArg::Medium => Self::Medium,
            QualityArg::High => Self::High,
            QualityArg::Reference => Self::Reference,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum LayerArg {
    Final,
    Direct,
    Indirect,
    Albedo,
    Normal,
    Depth,
    /// Cells; --voxels and --slice say what of them.
    Voxels,
    /// Light in free space, as balls that show what arrives from each side.
    Lobes,
    /// What all surfaces would mirror if they were glossy (roughness 0.4).
    Glossy,
    /// Where gathered light may leak: the part of it that comes from what a pixel cannot see; blue for none, red for all.
    Leaks,
    /// What objects with visibility fields let through of the sky's light; with --ao field.
    Occlusion,
    /// What surfaces mirror, with --reflections field.
    Reflections,
    /// What leaves leave of the first light, with --shadows transmittance.
    Transmittance,
    /// Metres of glass that a pixel's ray crosses, brightest for the most.
    Thickness,
}

impl From<LayerArg> for Layer {
    fn from(arg: LayerArg) -> Self {
        match arg {
            LayerArg::Final => Self::Final,
            LayerArg::Direct => Self::Direct,
            LayerArg::Indirect => Self::Indirect,
            LayerArg::Albedo => Self::Albedo,
            LayerArg::Normal => Self::Normal,
            LayerArg::Depth => Self::Depth,
            LayerArg::Voxels => Self::Voxels,
            LayerArg::Lobes => Self::Lobes,
            LayerArg::Leaks => Self::Leaks,
            LayerArg::Glossy => Self::Glossy,
            LayerArg::Occlusion => Self::Occlusion,
            LayerArg::Reflections => Self::Reflections,
            LayerArg::Transmittance => Self::Transmittance,
            LayerArg::Thickness => Self::Thickness,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum VoxelsArg {
    /// Albedo under a headlight, the light that leaves them, and emission.
    Lit,
    Albedo,
    Normal,
    Emission,
    /// The direct light that leaves them.
    Light,
    /// Red where a view shows them in this frame, yellow to blue where none has for up to 64 frames, grey where none has for longer;
    /// with --voxelizer progressive or hybrid.
    Age,
    /// As lit, and pink where triangles have a surface that no view has brought into the volume; with a --voxelizer that takes views.
    Unseen,
}

impl From<VoxelsArg> for VoxelChannel {
    fn from(arg: VoxelsArg) -> Self {
        match arg {
            VoxelsArg::Lit => Self::Lit,
            VoxelsArg::Albedo => Self::Albedo,
            VoxelsArg::Normal => Self::Normal,
            VoxelsArg::Emission => Self::Emission,
            VoxelsArg::Light => Self::Light,
            VoxelsArg::Unseen => Self::Unseen,
            VoxelsArg::Age => Self::Age,
        }
    }
}
