//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, Result, bail};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::Vec3;
use lumivox::gather::Quality;
use lumivox::light::Reflection;
use lumivox::lpv::Blocking;
use lumivox_render::voxel_view::{Slice, VoxelChannel};
use lumivox_render::{GiMethod, Layer, VoxelSource};
use lumivox_scene::Camera;

/// Lights scenes with voxel volumes: progressive voxelization and indirect light on any GPU.
#[derive(Debug, Parser)]
#[command(version, about)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Walk through the built-in atrium: single-frame against progressive voxelization, pictures, an animation, timings.
    Demo(DemoArgs),
    /// Render one picture of a scene, or a series.
    Render(RenderArgs),
    /// Turn meshes into voxel volumes: occupancy, colours, normals, in the format of your tool.
    Voxelize(crate::voxelize::VoxelizeArgs),
    /// Bake the visibility field of a rigid object, or look at one: maps, sizes, errors against true rays.
    Field(crate::field::FieldArgs),
    /// Hold our light against a path tracer's, or another renderer's: errors, pictures, differences.
    Compare(crate::compare::CompareArgs),
    /// Make the papers' tables and figures on this machine: times, counts and pictures beside the papers' own.
    Bench(crate::bench::BenchArgs),
    /// Show the adapters, their tier and limits, and the largest grids that fit.
    Info(InfoArgs),
}

#[derive(Debug, Args)]
pub(crate) struct GpuArgs {
    /// Take the adapter with this in its name.
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
    /// What to ask of the device: what every WebGPU device has, or all that this one has.
    #[arg(long, value_enum, default_value = "native")]
    pub(crate) tier: TierArg,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum TierArg {
    Core,
    Native,
}

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for everything the demo writes.
    #[arg(long, default_value = "out/demo")]
    pub(crate) out: PathBuf,
    /// Frames of the walk.
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u32).range(2..=2000))]
    pub(crate) frames: u32,
    /// Picture size.
    #[arg(long, default_value = "400x225")]
    pub(crate) size: Size,
    /// Cells along the longest side of the scene.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(8..=2048))]
    pub(crate) grid: u32,
    /// Propagation steps per frame.
    #[arg(long, default_value_t = 40, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub(crate) iterations: u32,
    #[command(flatten)]
    pub(crate) gpu: GpuArgs,
}

/// What is looked at, from where, and how it is lit: the same for every command that takes a picture of a scene.
#[derive(Debug, Args)]
pub(crate) struct ShotArgs {
    /// A scene file (.glb .gltf .obj .ply .stl .off .scene.json) or builtin:NAME, builtin:NAME:DETAIL.
    pub(crate) scene: String,
    /// x,y,z:x,y,z or x,y,z:x,y,z:degrees: eye, target and vertical field of view. Without it the scene's first camera, else one that
    /// shows the most.
    #[arg(long, allow_hyphen_values = true, value_name = "EYE:TARGET[:FOV]")]
    pub(crate) camera: Option<CameraArg>,
    /// x,y,z:r,g,b or x,y,z:w: a sun instead of the scene's lights: the way its light travels, and its irradiance in W/m2.
    #[arg(long, allow_hyphen_values = true, value_name = "DIRECTION:IRRADIANCE")]
    pub(crate) sun: Option<SunArg>,
    /// Time of the (first) picture in seconds, for scenes that move.
    #[arg(long, allow_hyphen_values = true, default_value_t = 0.0)]
    pub(crate) time: f32,
    /// The motion to play, by name or number, of a scene that moves; none for the pose it is stored in. The first unless said
    /// otherwise.
    #[arg(long, value_name = "NAME|N|none")]
    pub(crate) clip: Option<ClipArg>,
    /// How well indirect light is found: rays, points asked for light, bounces, and cells unless --grid says how many. Stills take high
    /// unless said otherwise, series medium.
    #[arg(long, value_enum)]
    pub(crate) quality: Option<QualityArg>,
    /// Cells along the longest side of the scene: 64 unless --quality says otherwise.
    #[arg(long)]
    pub(crate) grid: Option<u32>,
    /// Where voxels come from. Stills take triangles unless said otherwise, series progressive.
    #[arg(long, value_enum)]
    pub(crate) voxelizer: Option<VoxelizerArg>,
    /// Indirect light.
    #[arg(long, value_enum, default_value = "gather")]
    pub(crate) gi: GiArg,
    /// What surfaces do with light with --gi propagation: they scatter it, or mirror it on the faces of cells or about their normal.
    #[arg(long, value_enum, default_value = "none")]
    pub(crate) mirror: MirrorArg,
    /// What holds light back with --gi lpv.
    #[arg(long, value_enum, default_value = "none")]
    pub(crate) lpv_blocking: BlockingArg,
    /// Small lights that stand for the sky, each with a shadow map; a quarter as many stand for a rect light. More are smoother and
    /// slower. Stills take 1024, fewer down to 256 for many triangles, and series 64 unless said otherwise.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=65_536))]
    pub(crate) light_samples: Option<u32>,
    /// Texels a side of the atlas of shadow maps, 256 to 8192. The map of a sun or a spot has all of it, a sample of the sky a quarter.
    /// Stills take 4096, series 2048 unless said otherwise.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(256..=8192))]
    pub(crate) shadow_size: Option<u32>,
    /// Propagation steps per frame. A still goes on until its light has settled.
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub(crate) iterations: u32,
    /// How much of its direction light keeps per step through empty cells, 0 to 1.
    #[arg(long, default_value_t = lumivox::light::LightSettings::default().persistence)]
    pub(crate) persistence: f32,
    #[command(flatten)]
    pub(crate) gpu: GpuArgs,
}

/// How visibility fields of rigid objects are used.
#[derive(Debug, Args)]
pub(crate) struct ObjectArgs {
    /// How objects take light of the sky: as in shadow maps, or by their visibility fields.
    #[arg(long, value_enum, default_value = "maps")]
    pub(crate) ao: ByArg,
    /// How objects throw shadows in the light of lamps: as in shadow maps, or softly by their visibility fields.
    #[arg(long, value_enum, default_value = "maps")]
    pub(crate) shadows: ByArg,
    /// Meshes that have visibility fields, by the beginnings of their names. What moves rigidly, unless said otherwise.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    pub(crate) casters: Vec<String>,
    /// Rays per pixel into visibility fields, for occlusion and for each light. Stills take 64, series 16 unless said otherwise.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) field_rays: Option<u32>,
    /// Sample points of each field: 82, 290, 1090, 4226 or 16642.
    #[arg(long, value_name = "N", default_value_t = 4226)]
    pub(crate) field_points: u32,
    /// Directions along a side of each of its maps: 32, 64, 128 or 256.
    #[arg(long, value_name = "N", default_value_t = 64)]
    pub(crate) field_directions: u32,
    /// Radius of point and spot lights in soft shadows, metres.
    #[arg(long, value_name = "METRES", default_value_t = 0.1)]
    pub(crate) light_radius: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ByArg {
    /// Shadow maps.
    Maps,
    /// Visibility fields.
    Field,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) shot: ShotArgs,
    #[command(flatten)]
    pub(crate) objects: ObjectArgs,
    /// The picture: .png (tone-mapped sRGB) or .exr (linear). With --frames a name like name_%04d.png, or an animation, name.gif.
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Picture size.
    #[arg(long, default_value = "960x540")]
    pub(crate) size: Size,
    /// Render a series of frames instead of a settled still; scenes with a camera walk follow it.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) frames: Option<u32>,
    /// In a series with --gi propagation light goes on flowing from frame to frame, --iterations steps in each: a few are
    /// enough for all bounces, and what changes spreads by one cell a step.
    #[arg(long, requires = "frames")]
    pub(crate) flow: bool,
    /// Frames per second of a series.
    #[arg(long, default_value_t = 12.0)]
    pub(crate) fps: f32,
    /// Exposure in stops, for PNG; auto makes the (first) picture's lit parts middle grey on average.
    #[arg(long, allow_hyphen_values = true, default_value = "auto", value_name = "EV|auto")]
    pub(crate) exposure: ExposureArg,
    /// What the picture shows.
    #[arg(long, value_enum, default_value = "final")]
    pub(crate) layer: LayerArg,
    /// What --layer voxels shows of cells.
    #[arg(long, value_enum, default_value = "lit")]
    pub(crate) voxels: VoxelsArg,
    /// x:METRES, y:METRES or z:METRES: the one layer of cells that --layer voxels shows.
    #[arg(long, allow_hyphen_values = true, value_name = "AXIS:METRES")]
    pub(crate) slice: Option<SliceArg>,
    /// Write what was done as one JSON object.
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// Write the same as one JSON object.
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) gpu: GpuArgs,
}

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
}

impl From<VoxelizerArg> for VoxelSource {
    fn from(arg: VoxelizerArg) -> Self {
        match arg {
            VoxelizerArg::Triangles => Self::Triangles,
            VoxelizerArg::Progressive => Self::Progressive,
            VoxelizerArg::SinglePass => Self::SinglePass,
            VoxelizerArg::SingleFrame => Self::SingleFrame,
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
    /// 32 cells, 32 rays a surfel over four frames.
    Low,
    /// 64 cells, 64 rays over two frames.
    Medium,
    /// 64 cells, 256 rays.
    High,
    /// 128 cells, 512 rays: slow, to see what is left of the error.
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
    /// Gathered light in free space, as balls that show what arrives from each side.
    Lobes,
    /// What all surfaces would mirror if they were glossy (roughness 0.4).
    Glossy,
    /// Where gathered light would leak if pixels did not look: blue for nowhere, red for all of it.
    Leaks,
    /// What objects with visibility fields let through of the sky's light; with --ao field.
    Occlusion,
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
}

impl From<VoxelsArg> for VoxelChannel {
    fn from(arg: VoxelsArg) -> Self {
        match arg {
            VoxelsArg::Lit => Self::Lit,
            VoxelsArg::Albedo => Self::Albedo,
            VoxelsArg::Normal => Self::Normal,
            VoxelsArg::Emission => Self::Emission,
            VoxelsArg::Light => Self::Light,
        }
    }
}

/// A layer of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SliceArg(pub(crate) Slice);

impl FromStr for SliceArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (axis, at) = text.split_once(':').context("a slice is x:METRES, y:METRES or z:METRES")?;
        let axis = ["x", "y", "z"].iter().position(|name| *name == axis);
        let axis = axis.with_context(|| format!("{text:?}: the axis of a slice is x, y or z"))?;
        Ok(Self(Slice { axis, at: number(at)? }))
    }
}

/// Width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size(pub(crate) u32, pub(crate) u32);

impl FromStr for Size {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (width, height) =
            text.split_once(['x', 'X']).context("a size is WIDTHxHEIGHT, for example 960x540")?;
        let side = |s: &str| s.trim().parse::<u32>().with_context(|| format!("{s:?} is no number of pixels"));
        let size = Self(side(width)?, side(height)?);
        if [size.0, size.1].iter().any(|side| !(1..=8192).contains(side)) {
            bail!("a picture has 1 to 8192 pixels a side");
        }
        Ok(size)
    }
}

/// Eye, target and field of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraArg {
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    pub(crate) fov_y_deg: f32,
}

impl From<CameraArg> for Camera {
    fn from(arg: CameraArg) -> Self {
        Self {
            name: "command line".to_owned(),
            eye: arg.eye,
            target: arg.target,
            up: Vec3::Y,
            fov_y: arg.fov_y_deg.to_radians(),
        }
    }
}

/// Name or number of a clip.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ClipArg(pub(crate) String);

impl FromStr for ClipArg {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(text.to_owned()))
    }
}

impl FromStr for CameraArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<&str> = text.split(':').collect();
        let (eye, target, fov) = match parts.as_slice() {
            [eye, target] => (eye, target, "60"),
            [eye, target, fov] => (eye, target, *fov),
            _ => bail!("a camera is x,y,z:x,y,z or x,y,z:x,y,z:degrees"),
        };
        let camera = Self { eye: triple(eye)?, target: triple(target)?, fov_y_deg: number(fov)? };
        if camera.eye == camera.target {
            bail!("a camera must look somewhere: its eye and target are the same point");
        }
        if !(1.0..=170.0).contains(&camera.fov_y_deg) {
            bail!("the field of view must be 1 to 170 degrees");
        }
        Ok(camera)
    }
}

/// Stops, or what suits the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ExposureArg {
    Auto,
    Stops(f32),
}

impl FromStr for ExposureArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            stops => Ok(Self::Stops(number(stops)?)),
        }
    }
}

/// Direction and irradiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SunArg {
    pub(crate) direction: Vec3,
    pub(crate) irradiance: Vec3,
}

impl FromStr for SunArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (direction, irradiance) =
            text.split_once(':').context("a sun is x,y,z:r,g,b or x,y,z:w (direction and irradiance)")?;
        let irradiance =
            if irradiance.contains(',') { triple(irradiance)? } else { Vec3::splat(number(irradiance)?) };
        if irradiance.min_element() < 0.0 {
            bail!("irradiance cannot be negative");
        }
        let direction =
            triple(direction)?.try_normalize().context("the sun needs a direction that is not zero")?;
        Ok(Self { direction, irradiance })
    }
}

pub(crate) fn triple(text: &str) -> Result<Vec3> {
    let values = text.split(',').map(number).collect::<Result<Vec<_>>>()?;
    match values.as_slice() {
        &[x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => bail!("{text:?} is not three numbers x,y,z"),
    }
}

fn number(text: &str) -> Result<f32> {
    let value: f32 = text.trim().parse().ok().with_context(|| format!("{text:?} is not a number"))?;
    if !value.is_finite() {
        bail!("{text:?} is not a finite number");
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn cameras_suns_and_sizes_are_read() {
        let camera: CameraArg = "-1,2,3:0,1,0:45".parse().unwrap();
        assert_eq!((camera.eye, camera.fov_y_deg), (Vec3::new(-1.0, 2.0, 3.0), 45.0));
        let sun: SunArg = "0,-2,0:3,2,1".parse().unwrap();
        assert_eq!((sun.direction, sun.irradiance), (Vec3::NEG_Y, Vec3::new(3.0, 2.0, 1.0)));
        assert_eq!("320x180".parse::<Size>().unwrap(), Size(320, 180));
    }

    #[test]
    fn nonsense_is_refused_in_words() {
        for bad in ["", "1,2:3", "1,2,3:1,2,3", "1,2,3:0,0,0:400", "1,2,nan:0,0,0"] {
            assert!(bad.parse::<CameraArg>().is_err(), "{bad}");
        }
        for bad in ["1,2,3", "0,0,0:1", "0,-1,0:-1", "0,-1,0:x"] {
            assert!(bad.parse::<SunArg>().is_err(), "{bad}");
        }
        assert_eq!("z:-1.5".parse::<SliceArg>().unwrap(), SliceArg(Slice { axis: 2, at: -1.5 }));
        for bad in ["", "1", "w:1", "y:", "y:nan"] {
            assert!(bad.parse::<SliceArg>().is_err(), "{bad}");
        }
        for bad in ["", "0x5", "5", "5x", "99999x5", "-1x5"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }
}
