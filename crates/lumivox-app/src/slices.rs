//! `lumivox slices`: a scene's cells in the columns of a camera, as a sheet of its slices or as points.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use glam::UVec2;
use image::{Rgb, RgbImage};
use lumivox::core::Projection;
use lumivox::slicemap::{HostSlicemap, SlicemapSettings, Slicing};
use lumivox_render::camera_slicemap;
use lumivox_scene::Camera;

use crate::args::{CameraArg, ClipArg, GpuArgs, Size};
use crate::motion::chosen_clip;
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
    /// Whether columns meet in the eye or are parallel.
    #[arg(long, value_enum, default_value = "perspective")]
    projection: ProjectionArg,
    /// Which faces fill cells.
    #[arg(long, value_enum, default_value = "all")]
    faces: FacesArg,
    /// The moment, in seconds, of a scene that moves.
    #[arg(long, allow_hyphen_values = true, default_value_t = 0.0)]
    time: f32,
    /// The motion that it is a moment of, by name or number; none for the pose that the scene is stored in. The first unless given.
    #[arg(long, value_name = "NAME|N|none")]
    clip: Option<ClipArg>,
    #[command(flatten)]
    gpu: GpuArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProjectionArg {
    Perspective,
    /// As wide at the camera's target as the perspective view is there.
    Parallel,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FacesArg {
    /// All, in white.
    All,
    /// Those that face the camera.
    Front,
    /// Those that face away.
    Back,
    /// Both apart: blue for what faces the camera, orange for what faces away, white for cells with both.
    Split,
}

impl FacesArg {
    /// Whether cells of a set count: fronts are in the first, backs in the second.
    fn wants(self, set: u32) -> bool {
        match self {
            Self::All | Self::Split => true,
            Self::Front => set == 0,
            Self::Back => set == 1,
        }
    }
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
/// Pixels a side of the largest sheet, of 450 MB.
const MOST_SIDE: u64 = 12_288;

/// Runs the command.
pub(crate) fn run(args: &SlicesArgs) -> Result<()> {
    let extension = args.output.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["png", "ply"].contains(&extension.as_str()) {
        bail!("{}: slices are written as .png or .ply", args.output.display());
    }
    if !args.time.is_finite() {
        bail!("--time must be a finite number of seconds");
    }
    let size = UVec2::new(args.size.0, args.size.1);
    if extension == "png" {
        check_sheet(size, args.slices)?;
    }
    output::prepare(&args.output)?;
    output::check_apart(&[&args.scene], &[&args.output])?;
    let mut scene = lumivox_scene::load(&args.scene)?;
    stats::warn_of_import(&scene);
    if scene.triangle_count() == 0 {
        bail!("{}: there are no triangles to cut", args.scene);
    }
    let clip = chosen_clip(&scene, &args.scene, args.clip.as_ref())?;
    let pose = scene.pose(clip.unwrap_or(usize::MAX), args.time);
    scene.apply(&pose);
    let camera = match (&args.camera, pose.cameras.first()) {
        (Some(camera), _) => Camera::from(*camera),
        (None, Some(camera)) => camera.clone(),
        (None, None) => framing::best_camera(&scene, &scene.bounds()).with_context(|| args.scene.clone())?,
    };
    let settings = SlicemapSettings {
        size,
        slices: args.slices,
        slicing: if args.slicing == SlicingArg::Local { Slicing::Local } else { Slicing::Uniform },
        conservative: args.conservative,
        splits_faces: args.faces != FacesArg::All,
        ..SlicemapSettings::default()
    };
    let projection = match args.projection {
        ProjectionArg::Perspective => Projection::Perspective,
        ProjectionArg::Parallel => Projection::Orthographic,
    };
    let gpu = info::open_gpu(&args.gpu)?;
    let map =
        camera_slicemap(&gpu, &scene, (&camera, projection), settings).with_context(|| args.scene.clone())?;
    let filled = map.filled().filter(|(_, set, _)| args.faces.wants(*set)).count();
    if extension == "png" {
        output::write_png(&args.output, &sheet(&map, args.faces))?;
    } else {
        if filled > MOST_POINTS {
            bail!(
                "{filled} cells are more than {MOST_POINTS} points: try a smaller --size or fewer --slices"
            );
        }
        output::write_text(&args.output, &points(&map, args.faces))?;
    }
    if filled == 0 {
        tracing::warn!(
            "no cell is filled: the camera sees nothing, its triangles lie between the columns (try --conservative), or the scene is so far \
             from the origin that its triangles fall together"
        );
    }
    eprintln!("lumivox: {filled} filled cells in {}", args.output.display());
    Ok(())
}

/// Slices in a row of a sheet that is about as wide as high.
fn across(size: UVec2, slices: u32) -> u32 {
    ((f64::from(slices) * f64::from(size.y) / f64::from(size.x)).sqrt().ceil() as u32).clamp(1, slices)
}

/// Refuses a sheet that no picture holds.
fn check_sheet(size: UVec2, slices: u32) -> Result<()> {
    let across = across(size, slices);
    let width = u64::from(size.x) * u64::from(across);
    let height = u64::from(size.y) * u64::from(slices.div_ceil(across));
    if width.max(height) > MOST_SIDE {
        bail!(
            "{slices} slices of {} x {} columns make a sheet of {width} x {height} pixels, more than {MOST_SIDE} a side: try a smaller \
             --size, fewer --slices or points (.ply)",
            size.x,
            size.y
        );
    }
    Ok(())
}

/// About as wide as high, in grey lines.
fn sheet(map: &HostSlicemap, faces: FacesArg) -> RgbImage {
    let SlicemapSettings { size, slices, .. } = *map.settings();
    let across = across(size, slices);
    let whole = size * UVec2::new(across, slices.div_ceil(across));
    let mut sheet = RgbImage::from_fn(whole.x, whole.y, |x, y| {
        let border = x % size.x == 0 || y % size.y == 0;
        Rgb(if border { [70, 74, 80] } else { [18; 3] })
    });
    for (column, set, slice) in map.filled().filter(|(_, set, _)| faces.wants(*set)) {
        let at = column + size * UVec2::new(slice % across, slice / across);
        let has_both = || map.is_filled(column, 1 - set.min(1), slice);
        let color = match (faces, set) {
            (FacesArg::Split, 0) if !has_both() => [90, 160, 255],
            (FacesArg::Split, 1) if !has_both() => [255, 160, 70],
            _ => [255; 3],
        };
        sheet.put_pixel(at.x, at.y, Rgb(color));
    }
    sheet
}

/// The middles of filled cells, coloured from the nearest slice to the farthest.
fn points(map: &HostSlicemap, faces: FacesArg) -> String {
    let slices = map.settings().slices;
    let mut lines = String::new();
    let mut count = 0;
    for (column, _, slice) in map.filled().filter(|(_, set, _)| faces.wants(*set)) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_too_large_are_refused_with_their_size() {
        let told = check_sheet(UVec2::splat(1024), 1024).unwrap_err().to_string();
        assert!(told.contains("32768 x 32768"), "{told}");
        for (size, slices) in [(UVec2::splat(512), 512), (UVec2::new(8192, 1), 1024), (UVec2::splat(8192), 1)]
        {
            assert!(check_sheet(size, slices).is_ok(), "{size}, {slices}");
        }
    }
}
