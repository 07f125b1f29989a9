//! `lumivox demo`: a walk through the built-in atrium, twice: once with the voxels of each frame alone, once with those that
//! progressive voxelization keeps. Writes both series, one animation, one contact sheet and the timings.

use anyhow::Result;
use glam::{UVec2, Vec3};
use image::RgbImage;
use lumivox::gather::{GatherSettings, Quality};
use lumivox_render::{Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, builtin};
use serde::Serialize;

use crate::args::DemoArgs;
use crate::output::{self, Picture};
use crate::stats::{self, AdapterStats, StageStats};
use crate::{clock, info, render, sheet};

/// A little brighter than neutral: the arcades are what there is to see.
const EXPOSURE_EV: f32 = 0.5;
const FRAME_MILLIS: u32 = 120;
/// Where on the walk the contact sheet is taken: just out of the arcade, in the court.
const MOMENT: f32 = 0.6;
/// Just under the ceiling of the ground floor.
const CUT_HEIGHT: f32 = 4.0;

#[derive(Debug, Serialize)]
struct DemoStats {
    adapter: AdapterStats,
    triangles: u64,
    grid: [u32; 3],
    frames: u32,
    iterations_per_frame: u32,
    size: [u32; 2],
    total_ms: f64,
    walks: Vec<WalkStats>,
}

#[derive(Debug, Serialize)]
struct WalkStats {
    voxelizer: &'static str,
    occupied_cells: Vec<u32>,
    stages_last_frame: Vec<StageStats>,
}

struct Walk {
    stats: WalkStats,
    frames: Vec<RgbImage>,
    /// Voxels from above, indirect light and final picture at one moment.
    moment: Vec<RgbImage>,
}

/// Runs the command.
pub(crate) fn run(args: &DemoArgs) -> Result<()> {
    output::prepare(&args.out.join("sheet.png"))?;
    let start = clock::millis();
    let gpu = info::open_gpu(&args.gpu)?;
    let scene = builtin::atrium(2);
    let settings = Settings {
        size: UVec2::new(args.size.0, args.size.1),
        grid: args.grid,
        iterations: args.iterations,
        gather: GatherSettings::of(Quality::Medium),
        rsm_size: 512,
        points: 400,
        area_samples: 32,
        area_maps: 16,
        ..Settings::default()
    };
    let bar = render::progress(2 * u64::from(args.frames), "walking");
    let mut walks = Vec::new();
    let mut grid = [0; 3];
    for (name, voxels) in
        [("single-frame", VoxelSource::SingleFrame), ("progressive", VoxelSource::Progressive)]
    {
        let mut renderer = Renderer::new(&gpu, &scene, Settings { voxels, ..settings })?;
        grid = renderer.volume().grid().dims.to_array();
        walks.push(walk(&mut renderer, &gpu, name, args, &bar)?);
    }
    bar.finish_and_clear();

    let frames: Vec<RgbImage> = walks[0]
        .frames
        .iter()
        .zip(&walks[1].frames)
        .map(|(single, kept)| {
            sheet::side_by_side(("single-frame voxels", single), ("progressive voxels", kept))
        })
        .collect();
    output::write_gif(&args.out.join("walk.gif"), FRAME_MILLIS, |show| {
        frames.into_iter().try_for_each(show)
    })?;
    let rows: Vec<_> = walks.iter().map(|w| (w.stats.voxelizer, w.moment.clone())).collect();
    let sheet = sheet::contact_sheet(&rows, &["ground floor voxels from above", "indirect light", "final"]);
    output::write_png(&args.out.join("sheet.png"), &sheet)?;
    let stats = DemoStats {
        adapter: AdapterStats::new(&gpu),
        triangles: scene.triangle_count(),
        grid,
        frames: args.frames,
        iterations_per_frame: args.iterations,
        size: [args.size.0, args.size.1],
        total_ms: clock::millis() - start,
        walks: walks.into_iter().map(|w| w.stats).collect(),
    };
    stats::write(&args.out.join("timings.json"), &stats)?;
    eprintln!(
        "lumivox: {} frames, walk.gif, sheet.png and timings.json are in {} ({:.0} s)",
        2 * args.frames,
        args.out.display(),
        stats.total_ms / 1e3
    );
    Ok(())
}

fn walk(
    renderer: &mut Renderer,
    gpu: &lumivox::gpu::Gpu,
    name: &'static str,
    args: &DemoArgs,
    bar: &indicatif::ProgressBar,
) -> Result<Walk> {
    let mut frames = Vec::new();
    let mut occupied_cells = Vec::new();
    let mut stages_last_frame = Vec::new();
    let mut moment = Vec::new();
    for n in 0..args.frames {
        let last = n + 1 == args.frames;
        renderer.set_camera(&builtin::atrium_camera_path(n as f32 / (args.frames - 1) as f32));
        // Only the last frame is cut into stages: timing them one by one costs the overlap between them.
        let stats = renderer.frame(last.then_some(clock::millis as fn() -> f64))?;
        if last {
            stats::add_stages(&mut stages_last_frame, &stats.stages);
        }
        let picture = picture(renderer, args)?.srgb(Layer::Final, EXPOSURE_EV);
        output::write_png(&args.out.join(name).join(format!("frame_{n:04}.png")), &picture)?;
        frames.push(picture);
        occupied_cells.push(occupied(renderer, gpu)?);
        if n == (MOMENT * args.frames as f32) as u32 {
            moment = sheet_row(renderer, args)?;
        }
        bar.inc(1);
    }
    Ok(Walk { stats: WalkStats { voxelizer: name, occupied_cells, stages_last_frame }, frames, moment })
}

/// What the contact sheet shows of the frame just rendered.
fn sheet_row(renderer: &mut Renderer, args: &DemoArgs) -> Result<Vec<RgbImage>> {
    let mut row = Vec::new();
    for layer in [Layer::Indirect, Layer::Final] {
        renderer.set_layer(layer);
        renderer.settle(0, None)?;
        row.push(picture(renderer, args)?.srgb(layer, EXPOSURE_EV));
    }
    let above = Camera {
        name: "above".to_owned(),
        eye: Vec3::new(8.0, 22.0, 15.0),
        target: Vec3::new(0.0, 0.0, 0.8),
        up: Vec3::Y,
        fov_y: 0.75,
    };
    renderer.show_voxels(&above, CUT_HEIGHT)?;
    row.insert(0, picture(renderer, args)?.srgb(Layer::Voxels, EXPOSURE_EV));
    Ok(row)
}

fn picture(renderer: &Renderer, args: &DemoArgs) -> Result<Picture> {
    Ok(Picture { width: args.size.0, height: args.size.1, pixels: renderer.read_picture()? })
}

fn occupied(renderer: &Renderer, gpu: &lumivox::gpu::Gpu) -> Result<u32> {
    let volume = renderer.volume().read_back(gpu)?;
    let normals = volume.channel(lumivox::volume::NORMAL).unwrap_or_default();
    Ok(normals.iter().filter(|n| n.w > 0.0).count() as u32)
}
