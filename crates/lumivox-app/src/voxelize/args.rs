//! The command line of `lumivox voxelize`.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, Result, bail};
use clap::{ArgGroup, Args, ValueEnum};
use glam::UVec3;
use lumivox_core::{Bounds, Grid};
use lumivox_voxels::Coverage;
use lumivox_voxels::files::FileFormat;

use super::channel::{ChannelArg, OCCUPANCY};
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
    #[arg(long, value_name = "CELLS", default_value_t = 0.0, allow_hyphen_values = true)]
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
        let default = [ChannelArg::plain(if is_bare { OCCUPANCY } else { "albedo" })];
        let (asked, left_out): (Vec<&ChannelArg>, Vec<&ChannelArg>) =
            if self.channels.is_empty() { &default[..] } else { &self.channels }
                .iter()
                .filter(|channel| channel.name() != OCCUPANCY)
                .partition(|channel| format.holds(channel.name()));
        let left_out = if self.channels.is_empty() { Vec::new() } else { left_out };
        (asked.into_iter().copied().collect(), left_out.into_iter().map(|channel| channel.name()).collect())
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

#[cfg(test)]
mod tests {
    use super::*;

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
