//! `lumivox bench`: the papers' tables and figures, on this machine and beside the papers' numbers.

mod light;
mod models;
mod plot;
mod progressive;
mod report;
mod slicemap;
mod timing;
mod visibility;
mod voxel_picture;
mod voxelizers;

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

use crate::args::GpuArgs;
use crate::info::open_gpu;
use report::Report;
use timing::Timer;

#[derive(Debug, Args)]
pub(crate) struct BenchArgs {
    /// What to measure.
    #[arg(value_enum, required = true)]
    names: Vec<BenchName>,
    /// Folder for NAME.md, NAME.json and the plots and pictures.
    #[arg(long, default_value = "out/bench")]
    out: PathBuf,
    /// Small grids and few triangles: under a minute on two cores.
    #[arg(long)]
    quick: bool,
    /// Of light or progressive, these sections alone; a wrong one lists them.
    #[arg(long, value_delimiter = ',', value_name = "SECTION")]
    sections: Vec<String>,
    #[command(flatten)]
    gpu: GpuArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BenchName {
    /// The ways to turn triangles into voxels.
    Voxelizers,
    /// Indirect light against path-traced references.
    Light,
    /// Volumes kept up from views: their cells against the truth, and what they cost.
    Progressive,
    /// Visibility fields: errors, rays per second, occlusion and soft shadows.
    Visibility,
    /// Slicemaps: bits of columns in one pass, and what is made with them.
    Slicemap,
}

/// Runs the command.
pub(crate) fn run(args: &BenchArgs) -> Result<()> {
    let sectioned = matches!(args.names[..], [BenchName::Light | BenchName::Progressive]);
    if !args.sections.is_empty() && !sectioned {
        bail!("--sections are those of light or of progressive, one of them alone");
    }
    let gpu = open_gpu(&args.gpu)?;
    for name in &args.names {
        match name {
            BenchName::Voxelizers => {
                let mut report = Report::new(&args.out, "voxelizers", "Voxelizers of triangles")?;
                report.say(&timing::words(&gpu, args.quick));
                voxelizers::run(&Timer::new(&gpu, args.quick), args.quick, &mut report)?;
                report.write()?;
            }
            BenchName::Light => {
                let mut report = Report::new(&args.out, "light", "Indirect light")?;
                report.say(&timing::words(&gpu, args.quick));
                light::run(&gpu, args.quick, &parsed(&args.sections)?, &mut report)?;
                report.write()?;
            }
            BenchName::Progressive => {
                let mut report = Report::new(&args.out, "progressive", "Progressive voxelization")?;
                report.say(&timing::words(&gpu, args.quick));
                let sections = parsed(&args.sections)?;
                progressive::run(&Timer::new(&gpu, args.quick), args.quick, &sections, &mut report)?;
                report.write()?;
            }
            BenchName::Visibility => {
                let mut report = Report::new(&args.out, "visibility", "Visibility fields")?;
                report.say(&timing::words(&gpu, args.quick));
                visibility::run(&Timer::new(&gpu, args.quick), args.quick, &mut report)?;
                report.write()?;
            }
            BenchName::Slicemap => {
                let mut report = Report::new(&args.out, "slicemap", "Slicemaps")?;
                report.say(&timing::words(&gpu, args.quick));
                slicemap::run(&Timer::new(&gpu, args.quick), args.quick, &mut report)?;
                report.write()?;
            }
        }
    }
    Ok(())
}

/// Sections by their names.
fn parsed<S: ValueEnum>(names: &[String]) -> Result<Vec<S>> {
    let parse = |name: &String| {
        S::from_str(name, true).map_err(|_| {
            let known: Vec<_> = S::value_variants().iter().filter_map(S::to_possible_value).collect();
            let known: Vec<&str> = known.iter().map(clap::builder::PossibleValue::get_name).collect();
            anyhow::anyhow!("there is no section {name}: sections are {}", known.join(", "))
        })
    };
    names.iter().map(parse).collect()
}
