//! The command line of `lumivox field`, and what fields other commands bake.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lumivox_field::{Mapping, Settings, Storage};

use super::casters::MOST_PARTS;

#[derive(Debug, Args)]
pub(crate) struct FieldArgs {
    /// A mesh or scene file, builtin:NAME, or a field, NAME.lvf. All instances of a scene are one rigid object, as it stands when
    /// its first motion begins.
    pub(crate) input: String,
    /// The field.
    #[arg(short, long, value_name = "FILE.lvf")]
    pub(crate) output: Option<PathBuf>,
    /// Sample points on the bounding sphere: 82, 290, 1090, 4226 or 16642 [default: 4226]
    #[arg(long, value_name = "N")]
    points: Option<u32>,
    /// Directions along a side of each map: 32, 64, 128 or 256 [default: 64]
    #[arg(long, value_name = "N")]
    directions: Option<u32>,
    /// Bits per direction: 1, 8 or 32 [default: 8]
    #[arg(long, value_name = "N")]
    bits: Option<u32>,
    /// How directions are spread over a map [default: concentric]
    #[arg(long, value_enum)]
    mapping: Option<MappingArg>,
    /// Keep the surface normal of each direction too, for reflections: two bytes more.
    #[arg(long)]
    normals: bool,
    /// The most spheres of the object. One that is elongated or branches leaves most of a single sphere empty; it is cut into as many
    /// pieces as are worth a sphere and a field each, and FILE.lvf becomes FILE.1.lvf, FILE.2.lvf and so on [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    spheres: Option<u32>,
    /// Draw some of the maps: from above, below and four sides, near is bright.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) maps: Option<PathBuf>,
    /// Random lines to hold against true rays; 0 for none. A field that is read has no triangles to hold it against [default: 100000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=100_000_000))]
    check: Option<u32>,
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
        let usual = Settings::default();
        let settings = Settings {
            points: self.points.unwrap_or(usual.points),
            directions: self.directions.unwrap_or(usual.directions),
            mapping: self.mapping.map_or(usual.mapping, |mapping| match mapping {
                MappingArg::Uniform => Mapping::Uniform,
                MappingArg::Rejection => Mapping::Rejection,
                MappingArg::Concentric => Mapping::Concentric,
            }),
            storage: self.bits.map_or(Ok(usual.storage), Storage::from_bits)?,
            normals: self.normals,
        };
        settings.check()?;
        Ok(settings)
    }

    /// The most spheres of the object.
    pub(crate) fn spheres(&self) -> usize {
        self.spheres.map_or(MOST_PARTS, |n| n as usize)
    }

    /// Lines to hold against true rays.
    pub(crate) fn check(&self) -> u32 {
        self.check.unwrap_or(100_000)
    }

    /// Options that were given, of those that say how a field is baked.
    pub(crate) fn of_baking(&self) -> Vec<&'static str> {
        let given = [
            (self.output.is_some(), "--output"),
            (self.points.is_some(), "--points"),
            (self.directions.is_some(), "--directions"),
            (self.bits.is_some(), "--bits"),
            (self.mapping.is_some(), "--mapping"),
            (self.normals, "--normals"),
            (self.spheres.is_some(), "--spheres"),
            (self.check.is_some_and(|lines| lines > 0), "--check"),
        ];
        given.into_iter().filter_map(|(is_given, name)| is_given.then_some(name)).collect()
    }
}
