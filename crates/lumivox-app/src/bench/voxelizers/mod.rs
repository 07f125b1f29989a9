//! `lumivox bench voxelizers`: Tables 1 to 5 and Figures 1, 6 and 7 of *Two simple single-pass GPU methods for multi-channel surface
//! voxelization of dynamic scenes* (dissertation chapter 6: Tables 3 to 7, Figures 65 and 66), and what our other ways cost.

mod curves;
mod paper;
mod pictures;
mod tables;

use anyhow::Result;
use lumivox::core::Grid;
use lumivox::voxelize::{Channel, Coverage, Directions, Method, Options, Voxelizer};
use lumivox_voxels::{GridSpec, VoxelizeOptions};

use super::models::{Subject, subjects};
use super::report::Report;
use super::timing::{Time, Timer};

/// What a way took, and what it found.
#[derive(Clone, Copy, Debug)]
struct Measured {
    time: Time,
    cells: u64,
    /// Passes over the triangles: more than one where sums do not fit a binding.
    passes: usize,
}

/// A way with its name.
#[derive(Clone, Copy, Debug)]
struct Way {
    name: &'static str,
    options: Options,
}

fn way(name: &'static str, method: Method) -> Way {
    Way { name, options: Options { method, coverage: Coverage::Sampled, ..Options::default() } }
}

fn slicing(output_vertices: Option<u32>) -> Method {
    Method::Slicing { output_vertices }
}

fn clipping(output_vertices: Option<u32>) -> Method {
    Method::Clipping { output_vertices }
}

fn direct(name: &'static str, coverage: Coverage) -> Way {
    Way { name, options: Options { coverage, ..Options::default() } }
}

/// Every way to get occupancy but the slow one.
fn ways() -> [Way; 7] {
    [
        direct("direct, exact", Coverage::Exact),
        direct("direct, thin", Coverage::Thin),
        direct("direct, sampled", Coverage::Sampled),
        way("slicing", slicing(None)),
        way("clipping", clipping(None)),
        way("slicemap, three directions", Method::Slicemap(Directions::Three)),
        way("slicemap, one direction", Method::Slicemap(Directions::One(2))),
    ]
}

fn measure(
    timer: &Timer<'_>,
    subject: &Subject,
    grid: Grid,
    channels: &[Channel],
    options: &Options,
) -> Result<Measured> {
    let gpu = timer.gpu;
    let mut voxelizer = Voxelizer::new(gpu, grid, channels, options)?;
    let mut volume = voxelizer.volume(gpu)?;
    let meshes: Vec<_> = subject.meshes.iter().collect();
    let time = timer.median(|| timer.submit(|e| voxelizer.record(gpu, e, &meshes, &mut volume)))?;
    let cells = voxelizer.read_occupancy(gpu)?.into_iter().filter(|c| *c).count() as u64;
    Ok(Measured { time, cells, passes: voxelizer.triangle_passes() })
}

/// The CPU's voxelizer on all cores.
fn measure_cpu(
    timer: &Timer<'_>,
    subject: &Subject,
    grid: Grid,
    coverage: lumivox_voxels::Coverage,
) -> Result<Measured> {
    let model = subject.model();
    let options = VoxelizeOptions { grid: GridSpec::Grid(grid), coverage, ..VoxelizeOptions::default() };
    let mut cells = 0;
    let time = timer.median(|| {
        cells = lumivox_voxels::voxelize(&model, &options)?.len();
        Ok(())
    })?;
    Ok(Measured { time, cells, passes: 1 })
}

/// Runs all of it.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let subjects = subjects(timer.gpu, quick)?;
    report.say(
        "The papers' times are those of a GeForce GTX 285 from 2009; their numbers stand in parentheses.",
    );
    report.say(if subjects[0].name == "Bunny" {
        "Our bunny and dragon are the papers', on grids that stand on the ground, as the papers' grid sizes imply; Sponza is the older, smaller one."
    } else {
        "`LUMIVOX_ASSETS` names no folder with the papers' models: a bumpy ball of about as many triangles stands in for the bunny, and the built-in \
         atrium for Sponza. Counts of cells cannot be compared."
    });
    tables::limits(timer, &subjects, quick, report)?;
    tables::targets(timer, &subjects[0], quick, report)?;
    tables::approaches(timer, &subjects, quick, report)?;
    tables::devices(timer, &subjects[0], quick, report)?;
    tables::formats(timer, &subjects[0], quick, report)?;
    curves::triangles(timer, quick, report)?;
    curves::grids(timer, &subjects[0], quick, report)?;
    pictures::channels(timer, quick, report)?;
    pictures::difference(timer, &subjects[0], quick, report)?;
    pictures::holes(timer, &subjects[0], quick, report)
}
