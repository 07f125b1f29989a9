//! The command line of `lumivox field`, and what fields other commands bake.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lumivox_field::{Mapping, Settings, Storage};

#[derive(Debug, Args)]
pub(crate) struct FieldArgs {
    /// A mesh or scene file, builtin:NAME, or a field, NAME.lvf. All instances of a scene are one rigid object, as it stands when
    /// its first motion begins.
    pub(crate) input: String,
    /// The field.
    #[arg(short, long, value_name = "FILE.lvf")]
    pub(crate) output: Option<PathBuf>,
    /// Sample points on the bounding sphere: 82, 290, 1090, 4226 or 16642.
    #[arg(long, default_value_t = 4226)]
    points: u32,
    /// Directions along a side of each map: 32, 64, 128 or 256.
    #[arg(long, default_value_t = 64)]
    directions: u32,
    /// Bits per direction: 1, 8 or 32.
    #[arg(long, default_value_t = 8)]
    bits: u32,
    /// How directions are spread over a map.
    #[arg(long, value_enum, default_value = "concentric")]
    mapping: MappingArg,
    /// Keep the surface normal of each direction too, for reflections: two bytes more.
    #[arg(long)]
    normals: bool,
    /// The most spheres of the object. One that is elongated or branches leaves most of a single sphere empty; it is cut into as many
    /// pieces as are worth a sphere and a field each, and FILE.lvf becomes FILE.1.lvf, FILE.2.lvf and so on.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) spheres: u32,
    /// Draw some of the maps: from above, below and four sides, near is bright.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) maps: Option<PathBuf>,
    /// Random lines to hold against true rays; 0 for none. A field that is read has no triangles to hold it against.
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u32).range(0..=100_000_000))]
    pub(crate) check: u32,
    /// Write what was done as one JSON object.
    #[arg(long, value_name = "FILE")]
    pub(crate) stats: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MappingArg {
    Uniform,
    Rejection,
    Concentric,
}

impl FieldArgs {
    /// What the field is to be made of.
    pub(crate) fn settings(&self) -> anyhow::Result<Settings> {
        let mapping = match self.mapping {
            MappingArg::Uniform => Mapping::Uniform,
            MappingArg::Rejection => Mapping::Rejection,
            MappingArg::Concentric => Mapping::Concentric,
        };
        let settings = Settings {
            points: self.points,
            directions: self.directions,
            mapping,
            storage: Storage::from_bits(self.bits)?,
            normals: self.normals,
        };
        settings.check()?;
        Ok(settings)
    }
}
