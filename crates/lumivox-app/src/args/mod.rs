//! The command line.

mod choices;
mod idle;
mod see_through;
mod values;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use choices::{
    BlockingArg, CleanupArg, GiArg, LayerArg, LightRuleArg, MirrorArg, QualityArg, VoxelizerArg, VoxelsArg,
};
pub(crate) use idle::idle_options;
pub(crate) use see_through::SeeThroughArgs;
pub(crate) use values::{CameraArg, ClipArg, ExposureArg, Size, SliceArg, SunArg, triple};

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
    /// A scene's cells in the columns of a camera, one bit each: as a sheet of slices, or as points.
    Slices(crate::slices::SlicesArgs),
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
    /// When a view proves a voxel empty, with --voxelizer progressive, single-pass or hybrid; the others keep none from frame to frame.
    #[arg(long, value_enum, default_value = "footprint")]
    pub(crate) cleanup: CleanupArg,
    /// How long voxels keep the direct light that falls on them, with --gi propagation and --layer voxels.
    #[arg(long, value_enum, default_value = "pulled")]
    pub(crate) light_rule: LightRuleArg,
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
    /// Albedo of all surfaces after the first bounce with --gi propagation, 0 to 1, in place of their own; the dissertation takes 0.5.
    #[arg(long, value_name = "0..1")]
    pub(crate) bounce_albedo: Option<f32>,
    #[command(flatten)]
    pub(crate) gpu: GpuArgs,
}

/// How visibility fields of rigid objects are used.
#[derive(Debug, Args)]
pub(crate) struct ObjectArgs {
    /// How objects take light of the sky: as in shadow maps, or by their visibility fields.
    #[arg(long, value_enum, default_value = "maps")]
    pub(crate) ao: AoArg,
    /// How objects throw shadows in the light of lamps: as in shadow maps, softly by their visibility fields, masked surfaces such as
    /// leaves by the part that they take, or sharply by shadow volumes.
    #[arg(long, value_enum, default_value = "maps")]
    pub(crate) shadows: ByArg,
    /// The part of the light that a leaf takes with --shadows transmittance, 0 to 1.
    #[arg(long, value_name = "0..1", default_value_t = lumivox_render::LeafShadowSettings::default().sigma)]
    pub(crate) sigma: f32,
    /// Meshes that have visibility fields, by the beginnings of their names. What moves rigidly, unless said otherwise.
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    pub(crate) casters: Vec<String>,
    /// A coat of polish on all surfaces, which mirrors objects by their visibility fields, and around them the sky, or with --gi gather
    /// the light that is gathered.
    #[arg(long, value_enum, default_value = "none")]
    pub(crate) reflections: ReflectionsArg,
    /// Roughness of the polish, 0 for a mirror to 1 [default: 0.15]
    #[arg(long, value_name = "0..1")]
    pub(crate) polish: Option<f32>,
    /// The part of light that the polish mirrors head on, 0 to 1; more at grazing angles [default: 0.1]
    #[arg(long, value_name = "0..1")]
    pub(crate) reflectance: Option<f32>,
    /// Rays per pixel into visibility fields, for occlusion, for each light and, 64 at most, for reflections. Stills take 64, series 16
    /// unless said otherwise.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(crate) field_rays: Option<u32>,
    /// Sample points of each field: 82, 290, 1090, 4226 or 16642 [default: 4226]
    #[arg(long, value_name = "N")]
    pub(crate) field_points: Option<u32>,
    /// Directions along a side of each of its maps: 32, 64, 128 or 256 [default: 64]
    #[arg(long, value_name = "N")]
    pub(crate) field_directions: Option<u32>,
    /// Which maps of a field answer for a ray from outside [default: three]
    #[arg(long, value_enum)]
    pub(crate) field_maps: Option<FieldMapsArg>,
    /// How far away objects take light of the sky with --ao, metres; less the farther they are. From any distance unless given.
    #[arg(long, value_name = "METRES")]
    pub(crate) ao_reach: Option<f32>,
    /// Exponent of that falloff, 1 - (1 - distance / reach)^exponent: above 1 what is near counts more.
    #[arg(long, value_name = "EXPONENT", requires = "ao_reach")]
    pub(crate) ao_exponent: Option<f32>,
    /// Radius of point and spot lights in soft shadows, metres [default: 0.1]
    #[arg(long, value_name = "METRES")]
    pub(crate) light_radius: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FieldMapsArg {
    /// That of the sample point nearest to where the ray enters.
    Nearest,
    /// Those of the three sample points around: less grain for three times the look-ups.
    Three,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReflectionsArg {
    /// Surfaces are matt.
    None,
    /// Visibility fields.
    Field,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AoArg {
    /// Shadow maps.
    Maps,
    /// Visibility fields: the nearest hit of each ray over all objects.
    Field,
    /// Visibility fields, each object subtracted by itself as the papers do: too dark where they stand behind each other.
    Subtract,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ByArg {
    /// Shadow maps.
    Maps,
    /// Visibility fields.
    Field,
    /// In the light of suns, spots and points masked surfaces, such as leaves, let a part through; counted in slicemaps.
    Transmittance,
    /// Stencil shadow volumes of opaque surfaces in the light of suns, spots and points: sharp at any distance.
    Volumes,
}

#[derive(Debug, Args)]
pub(crate) struct RenderArgs {
    #[command(flatten)]
    pub(crate) shot: ShotArgs,
    #[command(flatten)]
    pub(crate) see_through: SeeThroughArgs,
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
    /// In a series, frames from one update of the volume and its light to the next; between them gathered light changes in
    /// even steps.
    #[arg(long, requires = "frames", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=60))]
    pub(crate) light_every: u32,
    /// In a series with --gi gather, milliseconds that gathering (its stages surfels, direct, trace and bounce) may take of a frame: as
    /// many surfaces have their turn as fit in. Shadow views, injection and the rest of the picture come on top.
    #[arg(
        long,
        requires = "frames",
        conflicts_with = "light_every",
        allow_hyphen_values = true,
        value_name = "MS"
    )]
    pub(crate) light_budget: Option<f64>,
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

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Arguments::command().debug_assert();
    }
}
