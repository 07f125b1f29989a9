//! `lumivox voxelize`: meshes to volume files.

mod args;
mod channel;
mod device;
mod gpu;
mod model;
mod outputs;
mod report;
mod slabs;
mod stages;
mod texture;
mod upload;

use anyhow::{Context, Result, bail};
use glam::{UVec3, Vec3};
use lumivox_core::{Bounds, Grid};
use lumivox_scene::Scene;
use lumivox_voxels::GridSpec;
use serde::Serialize;

use args::RESOLUTION;
pub(crate) use args::VoxelizeArgs;
use device::{Device, Work};
use model::Surfaces;
use outputs::Task;
use report::VolumeStats;
use stages::Stages;

use crate::stats;
use crate::{clock, motion};

/// What was made of several meshes.
#[derive(Debug, Serialize)]
struct BatchStats {
    volumes: Vec<VolumeStats>,
    failed: Vec<Failure>,
    total_ms: f64,
    peak_memory_bytes: Option<u64>,
}

#[derive(Debug, Serialize)]
struct Failure {
    input: String,
    error: String,
}

/// Runs the command.
pub(crate) fn run(args: &VoxelizeArgs) -> Result<()> {
    check(args)?;
    let tasks = outputs::tasks(args)?;
    let device = Device::choose(args)?;
    outputs::prepare(args, &tasks)?;
    let start = clock::millis();
    if let [task] = tasks.as_slice() {
        let done = voxelize(args, task, &device)?;
        return args.stats.as_deref().map_or(Ok(()), |path| stats::write(path, &done));
    }
    let (mut volumes, mut failed) = (Vec::new(), Vec::new());
    for task in &tasks {
        match voxelize(args, task, &device) {
            Ok(done) => volumes.push(done),
            Err(error) => {
                eprintln!("lumivox: {error:#}");
                failed.push(Failure { input: task.input.to_owned(), error: format!("{error:#}") });
            }
        }
    }
    let names: Vec<String> = failed.iter().map(|failure| failure.input.clone()).collect();
    if let Some(path) = &args.stats {
        let (total_ms, peak_memory_bytes) = (clock::millis() - start, report::peak_memory_bytes());
        stats::write(path, &BatchStats { volumes, failed, total_ms, peak_memory_bytes })?;
    }
    if !names.is_empty() {
        bail!("{} of {} meshes could not be voxelized: {}", names.len(), tasks.len(), names.join(", "));
    }
    Ok(())
}

/// Refuses arguments that no mesh can be voxelized with.
fn check(args: &VoxelizeArgs) -> Result<()> {
    if !args.time.is_finite() {
        bail!("--time must be a finite number of seconds");
    }
    if !(0.0..=0.5).contains(&args.snap) {
        bail!("--snap must be 0 to 0.5 cells");
    }
    let names: Vec<&str> = args.channels.iter().map(|channel| channel.name()).collect();
    if let Some(n) = (1..names.len()).find(|&n| names[..n].contains(&names[n])) {
        bail!("--channels names {} twice", names[n]);
    }
    Ok(())
}

/// From a mesh to its files, with a line that says what came of it.
fn voxelize(args: &VoxelizeArgs, task: &Task<'_>, device: &Device) -> Result<VolumeStats> {
    let start = clock::millis();
    let input = task.input;
    let stages = Stages::start("load");
    let scene = load(args, input)?;
    let (channels, left_out) = args.channels_for(task.format);
    let own_bounds = Surfaces::new(&scene, false).model(&scene).bounds();
    let grid =
        grid(args, &args.bounds.map_or(own_bounds, |bounds| bounds.0)).with_context(|| input.to_owned())?;
    task.format.check(&task.path, &grid)?;
    let work = Work { args, scene: &scene, grid, channels: &channels, stages: &stages };
    let made = device.voxelize(&work).with_context(|| input.to_owned())?;
    let volume = &made.volume;
    if volume.is_empty() {
        explain_emptiness(args, input, &own_bounds)?;
    }
    let mut done = VolumeStats::new(input, &scene, &made);
    stages.enter("write");
    done.add_files(outputs::write(task, volume)?);
    done.stages = stages.finish();
    done.total_ms = clock::millis() - start;
    done.peak_memory_bytes = report::peak_memory_bytes();
    done.coverage = format!("{:?}", args.coverage()).to_lowercase();
    for channel in &left_out {
        eprintln!(
            "lumivox: {}: the format has no place for {channel}, which is left out",
            task.path.display()
        );
    }
    done.left_out_channels = left_out;
    if let Some(words) = volume.report().solid.as_ref().and_then(report::solid_words) {
        eprintln!("lumivox: {input}: {words}");
    }
    eprintln!(
        "lumivox: {}: {} in {} cells of {} m, on {}",
        task.path.display(),
        report::count(volume.len(), "voxel"),
        report::sides(grid.dims),
        grid.cell_size,
        made.device.name()
    );
    Ok(done)
}

/// The scene at the moment asked for.
fn load(args: &VoxelizeArgs, input: &str) -> Result<Scene> {
    let mut scene = lumivox_scene::load(input)?;
    stats::warn_of_import(&scene);
    if scene.triangle_count() == 0 {
        bail!("{input}: there are no triangles to voxelize");
    }
    let clip = motion::chosen_clip(&scene, input, args.clip.as_ref())?;
    let pose = scene.pose(clip.unwrap_or(usize::MAX), args.time);
    scene.apply(&pose);
    Ok(scene)
}

/// The grid of a box as the arguments want it.
fn grid(args: &VoxelizeArgs, bounds: &Bounds) -> Result<Grid> {
    let margin = UVec3::splat(2 * args.pad);
    let spec = match (args.resolution, args.voxel_size, args.dims) {
        (_, _, Some(dims)) if dims.0.cmple(margin).any() => {
            bail!("--pad {} leaves nothing of --dims {}", args.pad, report::sides(dims.0))
        }
        (_, _, Some(dims)) => GridSpec::Dims(dims.0 - margin),
        (_, Some(cell_size), _) => GridSpec::CellSize(cell_size),
        (resolution, _, _) => GridSpec::Resolution(resolution.unwrap_or(RESOLUTION)),
    };
    let inner = spec.fit(bounds)?;
    let dims = inner.dims + margin;
    if dims.max_element() > Grid::MAX_SIDE {
        bail!(
            "--pad {} makes it a grid of {} cells, and one has at most {} along each axis",
            args.pad,
            report::sides(dims),
            Grid::MAX_SIDE
        );
    }
    let origin = inner.origin - inner.cell_size * Vec3::splat(args.pad as f32);
    Ok(Grid { origin, dims, ..inner })
}

/// Nothing in a box that was asked for is a mistake; else it may be the coverage or a mask, and is told.
fn explain_emptiness(args: &VoxelizeArgs, input: &str, own: &Bounds) -> Result<()> {
    if args.bounds.is_some() {
        let corners = [own.min, own.max].map(|p| format!("{},{},{}", p.x, p.y, p.z)).join(":");
        bail!("{input}: nothing of it lies in the --bounds; the box around it is {corners}");
    }
    tracing::warn!("{input}: no cell is marked");
    Ok(())
}
