//! The command line of `lumivox voxelize`.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, Result, bail};
use clap::{ArgGroup, Args, ValueEnum};
use glam::UVec3;
use lumivox::volume::Format as StoredFormat;
use lumivox::voxelize as gpu;
use lumivox_core::{Bounds, Grid};
use lumivox_voxels::files::FileFormat;
use lumivox_voxels::{Channel, Coverage, Format, Rule};

use crate::args::{ClipArg, triple};

/// Cells along the longest side when nothing is said.
pub(crate) const RESOLUTION: u32 = 128;

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("cells").args(["resolution", "voxel_size", "dims"]))]
pub(crate) struct VoxelizeArgs {
    /// Scene files (.glb .gltf .obj .ply .stl .off .scene.json) or builtin:NAME, builtin:NAME:DETAIL. Any triangles will do: open,
    /// overlapping, degenerate.
    #[arg(required = true, value_name = "MESH")]
    pub(crate) inputs: Vec<String>,
    /// The volume: .npz .vox .binvox .ply .vdb .nhdr or .ktx2. For several meshes a folder, with --format.
    #[arg(short, long, value_name = "FILE|FOLDER")]
    pub(crate) output: PathBuf,
    /// The format of the files in the output folder.
    #[arg(long, value_name = "npz|vox|binvox|ply|vdb|nhdr|ktx2")]
    pub(crate) format: Option<FormatArg>,
    /// Write the outer faces of the cells to .ply in place of a point per cell.
    #[arg(long)]
    pub(crate) cubes: bool,
    /// Cells along the longest side of the box; 128 unless said otherwise.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=Grid::MAX_SIDE as i64))]
    pub(crate) resolution: Option<u32>,
    /// Side of a cell in metres, or whatever the mesh is measured in.
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true)]
    pub(crate) voxel_size: Option<f32>,
    /// Cells along each axis, as small as they can be to hold the box.
    #[arg(long, value_name = "X,Y,Z")]
    pub(crate) dims: Option<DimsArg>,
    /// The box to voxelize, x,y,z:x,y,z: its lower and its upper corner. Without it the box around the mesh; what lies outside is cut
    /// off.
    #[arg(long, value_name = "MIN:MAX", allow_hyphen_values = true)]
    pub(crate) bounds: Option<BoundsArg>,
    /// Empty cells around the box on every side. They come on top of --resolution, and out of --dims.
    #[arg(long, value_name = "CELLS", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub(crate) pad: u32,
    /// Move corners onto cell boundaries that are this near, in cells: 0.001 heals faces that miss the grid by rounding.
    #[arg(long, value_name = "CELLS", default_value_t = 0.0)]
    pub(crate) snap: f64,
    /// Which cells a triangle marks: all that it touches, the fewest that let no path of face neighbours through, or one per column
    /// of the axis that it faces most. Exact unless said otherwise; sampled for the methods that rasterize.
    #[arg(long, value_enum)]
    pub(crate) coverage: Option<CoverageArg>,
    /// What is stored per cell: occupancy (always there), albedo, normal, emission, area; each with a format (u8, f16, f32) and a rule
    /// for several surfaces in a cell (average, nearest, max, sum), as in albedo:u8,normal:f32,emission:f16:max. Without it
    /// occupancy, and albedo where the format has a place for it.
    #[arg(long, value_name = "NAME[:FORMAT][:RULE],...", value_delimiter = ',')]
    pub(crate) channels: Vec<ChannelArg>,
    /// Colours of a cell: the average over all surface in it, or the colour of the point nearest to its middle.
    #[arg(long, value_enum, default_value = "average")]
    pub(crate) color: ColorArg,
    /// Fill what the outside cannot reach. Where the surface is open, the place is reported.
    #[arg(long)]
    pub(crate) solid: bool,
    /// Time in seconds, for meshes that move.
    #[arg(long, allow_hyphen_values = true, default_value_t = 0.0)]
    pub(crate) time: f32,
    /// The motion to play, by name or number, of a mesh that moves; none for the pose it is stored in. The first unless said
    /// otherwise.
    #[arg(long, value_name = "NAME|N|none")]
    pub(crate) clip: Option<ClipArg>,
    /// Where it is done. Auto takes a GPU where there is one that can do what is asked, and the CPU where there is only a software
    /// driver; a line at the end says which. Gpu takes a software driver too.
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) device: DeviceArg,
    /// How it is done. All but cpu mean --device gpu, and all but cpu and direct mean --coverage sampled: direct tests the cells of
    /// each triangle in compute shaders, the others rasterize. Slicemap knows occupancy alone.
    #[arg(long, value_enum)]
    pub(crate) method: Option<MethodArg>,
    /// Take the adapter with this in its name; means --device gpu.
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
    /// Most memory that a volume and the work on it may take, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = 8192, value_parser = clap::value_parser!(u64).range(1..=1 << 24))]
    pub(crate) memory: u64,
    /// Write what was done as one JSON object.
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
}

impl VoxelizeArgs {
    /// The channels for a format, in the order asked for, and those asked for that it has no place for.
    pub(crate) fn channels_for(&self, format: FileFormat) -> (Vec<ChannelArg>, Vec<&'static str>) {
        let is_bare = self.method == Some(MethodArg::Slicemap);
        let default =
            [ChannelArg { name: if is_bare { OCCUPANCY } else { "albedo" }, format: None, rule: None }];
        let (asked, left_out): (Vec<&ChannelArg>, Vec<&ChannelArg>) =
            if self.channels.is_empty() { &default[..] } else { &self.channels }
                .iter()
                .filter(|channel| channel.name != OCCUPANCY)
                .partition(|channel| format.holds(channel.name));
        let left_out = if self.channels.is_empty() { Vec::new() } else { left_out };
        (asked.into_iter().copied().collect(), left_out.into_iter().map(|channel| channel.name).collect())
    }

    /// The coverage that was asked for, or that of the method.
    pub(crate) fn coverage(&self) -> CoverageArg {
        self.coverage.unwrap_or(match self.method {
            Some(method) if method.is_sampled() => CoverageArg::Sampled,
            _ => CoverageArg::Exact,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum DeviceArg {
    Auto,
    Gpu,
    Cpu,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum MethodArg {
    Direct,
    Slicing,
    Clipping,
    SlicePerPass,
    Slicemap,
    Cpu,
}

impl MethodArg {
    /// As on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Slicing => "slicing",
            Self::Clipping => "clipping",
            Self::SlicePerPass => "slice-per-pass",
            Self::Slicemap => "slicemap",
            Self::Cpu => "cpu",
        }
    }

    /// Whether it knows sampled coverage alone.
    pub(crate) fn is_sampled(self) -> bool {
        !matches!(self, Self::Direct | Self::Cpu)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum CoverageArg {
    Exact,
    Thin,
    Sampled,
}

impl From<CoverageArg> for Coverage {
    fn from(arg: CoverageArg) -> Self {
        match arg {
            CoverageArg::Exact => Self::Exact,
            CoverageArg::Thin => Self::Thin,
            CoverageArg::Sampled => Self::Sampled,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum ColorArg {
    Average,
    Nearest,
}

/// A file format by the end of its files' names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FormatArg(pub(crate) FileFormat);

impl FromStr for FormatArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let format = FileFormat::of_extension(text.trim_start_matches('.'));
        Ok(Self(format.with_context(|| format!("formats are {}", FileFormat::EXTENSIONS.join(", ")))?))
    }
}

/// Cells along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DimsArg(pub(crate) UVec3);

impl FromStr for DimsArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let side = |t: &str| t.trim().parse::<u32>().with_context(|| format!("{t:?} is no number of cells"));
        let sides = text.split(',').map(side).collect::<Result<Vec<_>>>()?;
        let &[x, y, z] = sides.as_slice() else { bail!("{text:?} is not three numbers x,y,z") };
        let dims = UVec3::new(x, y, z);
        if dims.min_element() == 0 || dims.max_element() > Grid::MAX_SIDE {
            bail!("a grid has 1 to {} cells along each axis", Grid::MAX_SIDE);
        }
        Ok(Self(dims))
    }
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundsArg(pub(crate) Bounds);

impl FromStr for BoundsArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (low, high) =
            text.split_once(':').context("a box is x,y,z:x,y,z, its lower and its upper corner")?;
        let bounds = Bounds::new(triple(low)?, triple(high)?);
        if bounds.is_empty() || bounds.min == bounds.max {
            bail!("the first corner of a box must lie below the second");
        }
        Ok(Self(bounds))
    }
}

const OCCUPANCY: &str = "occupancy";

/// A channel with its format and its rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChannelArg {
    name: &'static str,
    format: Option<Format>,
    rule: Option<Rule>,
}

const NAMES: [&str; 5] = [OCCUPANCY, "albedo", "normal", "emission", "area"];
pub(crate) const FORMATS: [(&str, Format); 3] =
    [("u8", Format::U8), ("f16", Format::F16), ("f32", Format::F32)];
pub(crate) const RULES: [(&str, Rule); 4] =
    [("average", Rule::Average), ("nearest", Rule::Nearest), ("max", Rule::Maximum), ("sum", Rule::Sum)];

impl ChannelArg {
    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    /// As the CPU's voxelizer has it.
    pub(crate) fn channel(&self, color: ColorArg) -> Channel {
        let rule_of_colors = match color {
            ColorArg::Average => Rule::Average,
            ColorArg::Nearest => Rule::Nearest,
        };
        let mut channel = match self.name {
            "normal" => Channel::normal(),
            "emission" => Channel::emission().rule(rule_of_colors),
            "area" => Channel::area(),
            _ => Channel::albedo().rule(rule_of_colors),
        };
        if let Some(format) = self.format {
            channel = channel.format(format);
        }
        if let Some(rule) = self.rule {
            channel = channel.rule(rule);
        }
        channel
    }

    /// As the GPU's voxelizer has it, for surfaces that emit at most `brightest`.
    pub(crate) fn gpu_channel(&self, color: ColorArg, brightest: f32) -> gpu::Channel {
        let rule_of_colors = match color {
            ColorArg::Average => gpu::Rule::Average,
            ColorArg::Nearest => gpu::Rule::Nearest,
        };
        // What bytes stand for differs for emission and area, and normals are of any length here: these become bytes on the way to
        // the file.
        let (mut channel, default, smallest) = match self.name {
            "normal" => (gpu::Channel::normal(), Format::F16, Format::F16),
            "emission" => {
                let channel = gpu::Channel::emission().range(0.0, brightest).rule(rule_of_colors);
                (channel, Format::F16, Format::F16)
            }
            "area" => (gpu::Channel::area(), Format::F32, Format::F32),
            _ => (gpu::Channel::albedo().rule(rule_of_colors), Format::U8, Format::U8),
        };
        channel = channel.format(match (self.format.unwrap_or(default), smallest) {
            (Format::U8, Format::U8) => StoredFormat::U8,
            (Format::U8 | Format::F16, Format::U8 | Format::F16) => StoredFormat::F16,
            _ => StoredFormat::F32,
        });
        match self.rule {
            Some(Rule::Average) => channel.rule(gpu::Rule::Average),
            Some(Rule::Nearest) => channel.rule(gpu::Rule::Nearest),
            Some(Rule::Maximum) => channel.rule(gpu::Rule::Maximum),
            Some(Rule::Sum) => channel.rule(gpu::Rule::Sum),
            None => channel,
        }
    }
}

impl FromStr for ChannelArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut words = text.split(':');
        let name = words.next().unwrap_or_default();
        let name = NAMES
            .into_iter()
            .find(|known| *known == name)
            .with_context(|| format!("there is no channel {name:?}; known are {}", NAMES.join(", ")))?;
        let mut channel = Self { name, format: None, rule: None };
        for word in words {
            let format = FORMATS.iter().find(|(name, _)| *name == word).map(|f| f.1);
            let rule = RULES.iter().find(|(name, _)| *name == word).map(|r| r.1);
            match (format, rule) {
                _ if name == OCCUPANCY => bail!("occupancy has no format and no rule"),
                (Some(_), _) if channel.format.is_some() => bail!("{text:?} has two formats"),
                (_, Some(_)) if channel.rule.is_some() => bail!("{text:?} has two rules"),
                (None, None) => {
                    let known = FORMATS.iter().map(|f| f.0).chain(RULES.iter().map(|r| r.0));
                    let known: Vec<&str> = known.collect();
                    bail!("there is no format or rule {word:?}; known are {}", known.join(", "))
                }
                (Some(format), _) => channel.format = Some(format),
                (None, Some(rule)) => channel.rule = Some(rule),
            }
        }
        Ok(channel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_have_formats_and_rules_in_any_order() {
        let read = |text: &str| text.parse::<ChannelArg>().unwrap();
        let expected = ChannelArg { name: "albedo", format: Some(Format::F32), rule: Some(Rule::Maximum) };
        assert_eq!((read("albedo:f32:max"), read("albedo:max:f32")), (expected, expected));
        assert_eq!(read("occupancy"), ChannelArg { name: OCCUPANCY, format: None, rule: None });
        for bad in ["", "colour", "albedo:u9", "albedo:u8:f16", "albedo:max:sum", "occupancy:u8", "albedo:"] {
            assert!(bad.parse::<ChannelArg>().is_err(), "{bad}");
        }
    }

    #[test]
    fn boxes_and_dims_are_read() {
        let BoundsArg(bounds) = "-1,0,2:3,0.5,2".parse().unwrap();
        assert_eq!(bounds.size().to_array(), [4.0, 0.5, 0.0]);
        for bad in ["", "1,2,3", "0,0,0:0,0,0", "0,0,0:1,-1,1", "0,0,0:1,1,inf", "0,0:1,1"] {
            assert!(bad.parse::<BoundsArg>().is_err(), "{bad}");
        }
        assert_eq!("4,5,6".parse::<DimsArg>().unwrap().0, UVec3::new(4, 5, 6));
        for bad in ["4,5", "0,1,1", "1,1,2049", "a,b,c", "1,1,-1"] {
            assert!(bad.parse::<DimsArg>().is_err(), "{bad}");
        }
    }
}
