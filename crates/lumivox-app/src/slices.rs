//! `lumivox slices`: a scene's cells in the columns of a camera, as a sheet of its slices or as points.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use glam::UVec2;
use image::{Rgb, RgbImage};
use lumivox::slicemap::{HostSlicemap, SlicemapSettings, Slicing};
use lumivox_render::camera_slicemap;

use crate::args::{CameraArg, GpuArgs, Size};
use crate::{framing, info, output, stats};

#[derive(Debug, Args)]
pub(crate) struct SlicesArgs {
    /// The scene: .glb .gltf .obj .ply .stl .off .scene.json or builtin:NAME.
    scene: String,
    /// A sheet of all slices, the nearest first (.png), or the filled cells as points of the world (.ply).
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Columns.
    #[arg(long, default_value = "128x128")]
    size: Size,
    /// Cells of a column.
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=1024))]
    slices: u32,
    /// Where cells begin and end.
    #[arg(long, value_enum, default_value = "local")]
    slicing: SlicingArg,
    /// Fill all cells that triangles touch, not only those at the middle of columns.
    #[arg(long)]
    conservative: bool,
    /// EYE:TARGET[:FOV]; the scene's first camera, or one that sees all, unless it is given.
    #[arg(long, allow_hyphen_values = true, value_name = "X,Y,Z:X,Y,Z[:DEGREES]")]
    camera: Option<CameraArg>,
    #[command(flatten)]
    gpu: GpuArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SlicingArg {
    /// The same planes for all columns.
    Uniform,
    /// From the nearest to the farthest surface of each column.
    Local,
}

/// More points than that are no file that anybody opens.
const MOST_POINTS: usize = 20_000_000;

/// Runs the command.
pub(crate) fn run(args: &SlicesArgs) -> Result<()> {
    let extension = args.output.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["png", "ply"].contains(&extension.as_str()) {
        bail!("{}: slices are written as .png or .ply", args.output.display());
    }
    output::prepare(&args.output)?;
    output::check_apart(&[&args.scene], &[&args.output])?;
    let scene = lumivox_scene::load(&args.scene)?;
    stats::warn_of_import(&scene);
    let camera = match &args.camera {
        Some(camera) => lumivox_scene::Camera::from(*camera),
        None => match scene.cameras.first() {
            Some(camera) => camera.clone(),
            None => framing::best_camera(&scene, &scene.bounds())?,
        },
    };
    let settings = SlicemapSettings {
        size: UVec2::new(args.size.0, args.size.1),
        slices: args.slices,
        slicing: if args.slicing == SlicingArg::Local { Slicing::Local } else { Slicing::Uniform },
        conservative: args.conservative,
        ..SlicemapSettings::default()
    };
    let gpu = info::open_gpu(&args.gpu)?;
    let map = camera_slicemap(&gpu, &scene, &camera, settings).with_context(|| args.scene.clone())?;
    let filled = map.filled().count();
    if extension == "png" {
        output::write_png(&args.output, &sheet(&map, &gpu)?)?;
    } else {
        if filled > MOST_POINTS {
            bail!(
                "{filled} cells are more than {MOST_POINTS} points: try a smaller --size or fewer --slices"
            );
        }
        output::write_text(&args.output, &points(&map))?;
    }
    eprintln!("lumivox: {filled} filled cells in {}", args.output.display());
    Ok(())
}

/// About as wide as high, in grey lines.
fn sheet(map: &HostSlicemap, gpu: &lumivox::gpu::Gpu) -> Result<RgbImage> {
    let SlicemapSettings { size, slices, .. } = *map.settings();
    let across =
        ((f64::from(slices) * f64::from(size.y) / f64::from(size.x)).sqrt().ceil() as u32).clamp(1, slices);
    let most = gpu.device.limits().max_texture_dimension_2d;
    let whole = size * UVec2::new(across, slices.div_ceil(across));
    if whole.max_element() > 4 * most {
        bail!("a sheet of {whole} pixels is too large: try a smaller --size or fewer --slices");
    }
    let (whole, pixels) = map.sheet(across);
    Ok(RgbImage::from_fn(whole.x, whole.y, |x, y| {
        let border = x % size.x == 0 || y % size.y == 0;
        let filled = pixels[(y * whole.x + x) as usize] != 0;
        Rgb(if filled {
            [255; 3]
        } else if border {
            [70, 74, 80]
        } else {
            [18; 3]
        })
    }))
}

/// The middles of filled cells, coloured from the nearest slice to the farthest.
fn points(map: &HostSlicemap) -> String {
    let slices = map.settings().slices;
    let mut lines = String::new();
    let mut count = 0;
    for (column, _, slice) in map.filled() {
        let Some(p) = map.center(column, slice) else { continue };
        let part = 255 * slice / slices.max(2).saturating_sub(1).max(1);
        let _ = writeln!(lines, "{} {} {} {} 120 {}", p.x, p.y, p.z, 255 - part.min(255), part.min(255));
        count += 1;
    }
    format!(
        "ply\nformat ascii 1.0\ncomment cells of a slicemap\nelement vertex {count}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n{lines}"
    )
}
