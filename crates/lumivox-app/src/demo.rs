//! `lumivox demo`: a walk through the built-in atrium, twice: once with the voxels of each frame alone, once with those that
//! progressive voxelization keeps. Writes both series, one animation, one contact sheet and the timings.

use anyhow::Result;
use glam::UVec2;
use image::RgbImage;
use lumivox_render::{Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::builtin;
use serde::Serialize;

use crate::args::DemoArgs;
use crate::output::{self, Picture};
use crate::stats::{self, AdapterStats, StageStats};
use crate::{clock, info, render, sheet};

/// A little brighter than neutral: the arcades are what there is to see.
const EXPOSURE_EV: f32 = 0.5;
const FRAME_MILLIS: u32 = 120;

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
    /// Voxels, indirect light, final picture of the last frame.
    last: Vec<RgbImage>,
}

/// Runs the command.
pub(crate) fn run(args: &DemoArgs) -> Result<()> {
    let start = clock::millis();
    let gpu = info::open_gpu(&args.gpu)?;
    let scene = builtin::atrium(2);
    let settings = Settings {
        size: UVec2::new(args.size.0, args.size.1),
        grid: args.grid,
        iterations: args.iterations,
        rsm_size: 1024,
        points: 400,
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
    output::write_gif(&args.out.join("walk.gif"), &frames, FRAME_MILLIS)?;
    let rows: Vec<_> = walks.iter().map(|w| (w.stats.voxelizer, w.last.clone())).collect();
    let sheet = sheet::contact_sheet(&rows, &["voxels", "indirect light", "final"]);
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
        bar.inc(1);
    }
    let mut last = Vec::new();
    for layer in [Layer::Voxels, Layer::Indirect, Layer::Final] {
        renderer.set_layer(layer);
        renderer.settle(0, None)?;
        last.push(picture(renderer, args)?.srgb(layer, EXPOSURE_EV));
    }
    Ok(Walk { stats: WalkStats { voxelizer: name, occupied_cells, stages_last_frame }, frames, last })
}

fn picture(renderer: &Renderer, args: &DemoArgs) -> Result<Picture> {
    Ok(Picture { width: args.size.0, height: args.size.1, pixels: renderer.read_picture()? })
}

fn occupied(renderer: &Renderer, gpu: &lumivox::gpu::Gpu) -> Result<u32> {
    let volume = renderer.volume().read_back(gpu)?;
    let normals = volume.channel(lumivox::volume::NORMAL).unwrap_or_default();
    Ok(normals.iter().filter(|n| n.w > 0.0).count() as u32)
}
