//! `lumivox render`: one settled picture, or a series.

use std::path::Path;

use anyhow::{Context, Result, bail};
use glam::UVec2;
use indicatif::{ProgressBar, ProgressStyle};
use lumivox::core::Grid;
use lumivox::gather::Quality;
use lumivox::light::LightSettings;
use lumivox_render::voxel_view::Slice;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource, tone};
use lumivox_scene::{Camera, Scene};

use crate::args::{ExposureArg, LayerArg, RenderArgs, ShotArgs, Size, SliceArg, idle_options};
use crate::field::lookups;
use crate::motion::Motion;
use crate::output::{self, Format, Picture};
use crate::stats::{self, AdapterStats, RenderStats, StageStats};
use crate::{clock, info, lighting};

/// Light has settled when this share of what was sent out is still under way.
const SETTLED: f64 = 0.01;
/// Bounces of gathered light that a still makes at a time, and when it gives up.
const BOUNCES: u32 = 8;
const MAX_BOUNCES: u32 = 256;
/// A still gives up settling after this many propagation steps.
const MAX_STEPS: u32 = 8192;
/// Steps of light propagation volumes in a still, for each cell of the longest side: as many as its authors take. Light that has
/// not left by then diffuses to and fro for thousands of steps more.
const LPV_STEPS: u32 = 2;
/// Bounces before the first picture of a series.
const FIRST_BOUNCES: u32 = 16;
/// Browsers play an animation with shorter delays than 20 ms at ten frames per second.
const GIF_MAX_FPS: f32 = 50.0;

/// Runs the command.
pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let format = output::format_of(&args.output)?;
    let first = match args.frames {
        Some(_) if format != Format::Gif => output::numbered(&args.output, 0)?,
        None if format == Format::Gif => {
            bail!("{}: a .gif holds a series: add --frames N", args.output.display())
        }
        None if output::numbered(&args.output, 0).is_ok() => {
            bail!("{}: a numbered name is for a series: add --frames N", args.output.display())
        }
        _ => args.output.clone(),
    };
    if !(0.1..=1000.0).contains(&args.fps) {
        bail!("--fps must be 0.1 to 1000");
    }
    if format == Format::Gif && args.fps > GIF_MAX_FPS {
        bail!("--fps {}: players show a .gif with at most {GIF_MAX_FPS} frames per second", args.fps);
    }
    if args.light_budget.is_some_and(|ms| !(0.01..=1e6).contains(&ms)) {
        bail!("--light-budget must be 0.01 to 1e6 milliseconds");
    }
    check(&args.shot)?;
    args.see_through.check()?;
    let outputs: Vec<&Path> = [Some(first.as_path()), args.stats.as_deref()].into_iter().flatten().collect();
    outputs.iter().try_for_each(|path| output::prepare(path))?;
    output::check_apart(&[&args.shot.scene], &outputs)?;
    for told in idle_options(args) {
        tracing::warn!("{told}");
    }
    let start = clock::millis();
    let mut scene = load(&args.shot)?;
    let load_ms = clock::millis() - start;
    let motion = Motion::new(&scene, &args.shot, args.frames.is_some())?;
    let (_, camera) = motion.pose(&mut scene, args.shot.time);
    lighting::light_scene(&mut scene, &args.shot, &camera);

    let fields = lookups::object_fields(&args.objects, &scene).with_context(|| args.shot.scene.clone())?;
    let gpu = info::open_gpu(&args.shot.gpu)?;
    let is_still = args.frames.is_none();
    let usual = settings(&args.shot, &scene, args.size, args.layer.into(), is_still);
    let settings = Settings {
        flow: args.flow,
        light_every: args.light_every,
        light_budget: args.light_budget,
        clip: motion.clip().filter(|_| !is_still),
        voxel_channel: args.voxels.into(),
        voxel_slice: args.slice.map(|slice| slice.0),
        ..usual
    };
    let settings = args.see_through.with(lookups::with_objects(settings, &args.objects, is_still));
    let mut renderer =
        Renderer::with_fields(&gpu, &scene, settings, &fields).with_context(|| args.shot.scene.clone())?;
    if let Some(SliceArg(slice)) = args.slice {
        check_slice(slice, renderer.volume().grid())?;
    }
    args.see_through.apply(&mut renderer, &scene);
    let mut work = Work::default();
    match args.frames {
        Some(count) => {
            let mut moving =
                |save: Save<'_>| series(&mut renderer, args, &mut scene, &motion, count, &mut work, save);
            let layer = args.layer.into();
            match format {
                Format::Gif => output::write_gif(&args.output, (1e3 / args.fps).round() as u32, |show| {
                    moving(&mut |_, picture, exposure| show(picture.srgb(layer, exposure)))
                })?,
                _ => moving(&mut |n, picture, exposure| {
                    output::write_picture(&output::numbered(&args.output, n)?, picture, layer, exposure)
                })?,
            }
        }
        None => {
            let clock = args.stats.is_some().then_some(clock::millis as fn() -> f64);
            still(&mut renderer, args.shot.iterations, &camera, clock, &mut work)?;
            let picture = read_frame(&renderer, args, &mut work)?;
            output::write_picture(
                &args.output,
                &picture,
                args.layer.into(),
                work.exposure_ev.unwrap_or(0.0),
            )?;
        }
    }
    let surfels = renderer.surfels()?;
    if let Some(refused) = surfels.map(|s| s.refused).filter(|n| *n > 0) {
        tracing::warn!(
            "{refused} surfaces in the volume found no room and send no light: try a smaller --grid"
        );
    }
    if let Some(path) = &args.stats {
        let grid = renderer.volume().grid();
        let stats = RenderStats {
            scene: args.shot.scene.clone(),
            adapter: AdapterStats::new(&gpu),
            size: [args.size.0, args.size.1],
            triangles: scene.triangle_count(),
            meshes: scene.meshes.len(),
            textures: scene.textures.len(),
            lights: scene.lights.len(),
            grid: grid.dims.to_array(),
            cell_size_m: grid.cell_size,
            surfels: surfels.map(|s| s.used),
            field_objects: fields.casters.len(),
            field_spheres: fields.fields.len(),
            frames: work.frames,
            iterations: work.iterations,
            settled: work.settled,
            exposure_ev: work.exposure_ev,
            load_ms,
            total_ms: clock::millis() - start,
            stages: work.stages,
            import: scene.report.clone(),
        };
        stats::write(path, &stats)?;
    }
    Ok(())
}

/// A layer of cells must be one of the grid's.
fn check_slice(slice: Slice, grid: &Grid) -> Result<()> {
    let low = grid.origin[slice.axis];
    let high = low + grid.dims[slice.axis] as f32 * grid.cell_size;
    let axis = ["x", "y", "z"][slice.axis];
    if !(low..=high).contains(&slice.at) {
        bail!("--slice {axis}:{}: there are cells from {low:.3} to {high:.3} m", slice.at);
    }
    Ok(())
}

/// What was done so far.
#[derive(Debug, Default)]
pub(crate) struct Work {
    pub(crate) frames: u32,
    pub(crate) iterations: u32,
    pub(crate) settled: bool,
    pub(crate) exposure_ev: Option<f32>,
    pub(crate) stages: Vec<StageStats>,
}

/// Refuses numbers that no scene can be rendered with.
pub(crate) fn check(shot: &ShotArgs) -> Result<()> {
    if !(0.0..=1.0).contains(&shot.persistence) {
        bail!("--persistence must be 0 to 1");
    }
    if shot.bounce_albedo.is_some_and(|albedo| !(0.0..=1.0).contains(&albedo)) {
        bail!("--bounce-albedo must be 0 to 1");
    }
    if !shot.time.is_finite() {
        bail!("--time must be a finite number of seconds");
    }
    Ok(())
}

/// The scene, and a word about what was left out of it.
pub(crate) fn load(shot: &ShotArgs) -> Result<Scene> {
    let scene = lumivox_scene::load(&shot.scene)?;
    stats::warn_of_import(&scene);
    if scene.triangle_count() == 0 {
        bail!("{}: there are no triangles to render", shot.scene);
    }
    Ok(scene)
}

pub(crate) fn settings(shot: &ShotArgs, scene: &Scene, size: Size, layer: Layer, still: bool) -> Settings {
    let source = match shot.voxelizer {
        Some(voxelizer) => voxelizer.into(),
        None if still => VoxelSource::Triangles,
        None => VoxelSource::Progressive,
    };
    let usual = if still { Quality::High } else { Quality::Medium };
    let mut preset = Settings::of(shot.quality.map_or(usual, Quality::from));
    if still {
        // There is no next frame for those that would have their turn later.
        preset.gather.frames = 1.0;
    }
    Settings {
        size: UVec2::new(size.0, size.1),
        grid: shot.grid.unwrap_or(preset.grid),
        voxels: source,
        cleanup: shot.cleanup.into(),
        light_rule: shot.light_rule.into(),
        gi: shot.gi.into(),
        // A still starts with none, to learn how much light there is to settle.
        iterations: if still { 0 } else { shot.iterations },
        light: LightSettings {
            persistence: shot.persistence,
            bounce_albedo: shot.bounce_albedo,
            ..LightSettings::default()
        },
        reflection: shot.mirror.into(),
        lpv_blocking: shot.lpv_blocking.into(),
        layer,
        shadow_size: shot.shadow_size.unwrap_or(if still { 4096 } else { 2048 }),
        area_samples: shot.light_samples.unwrap_or_else(|| light_samples(scene, still)),
        ..preset
    }
}

/// Samples of the sky. A still has time for so many that streaks of sky light through windows are gone, unless there are many
/// triangles: a sample draws them all.
fn light_samples(scene: &Scene, still: bool) -> u32 {
    const TRIANGLES_DRAWN: u64 = 60_000_000;
    if still { (TRIANGLES_DRAWN / scene.triangle_count().max(1)).clamp(256, 1024) as u32 } else { 64 }
}

/// One frame, then propagation, `iterations` steps at a time, until its light has settled.
pub(crate) fn still(
    renderer: &mut Renderer,
    iterations: u32,
    camera: &Camera,
    clock: Option<fn() -> f64>,
    work: &mut Work,
) -> Result<()> {
    renderer.set_camera(camera);
    let mut frame = renderer.frame(clock)?;
    stats::add_stages(&mut work.stages, &frame.stages);
    work.frames = 1;
    work.settled = true;
    let Settings { gi, layer, .. } = *renderer.settings();
    if layer == Layer::Voxels {
        return Ok(());
    }
    match gi {
        GiMethod::Off => {}
        GiMethod::Lpv | GiMethod::Propagation if iterations == 0 => {}
        GiMethod::Lpv | GiMethod::Propagation => {
            let sent = renderer.light_in_volume()?;
            let mut left = sent;
            let most = if gi == GiMethod::Lpv {
                renderer.volume().grid().dims.max_element() * LPV_STEPS
            } else {
                MAX_STEPS
            };
            let bar = progress(100, "light settles");
            while left > SETTLED * sent && work.iterations < most {
                frame = renderer.settle(iterations, clock)?;
                stats::add_stages(&mut work.stages, &frame.stages);
                work.frames += 1;
                work.iterations += iterations;
                left = renderer.light_in_volume()?;
                bar.set_position((100.0 * ((left / sent).ln() / SETTLED.ln()).clamp(0.0, 1.0)) as u64);
            }
            bar.finish_and_clear();
            work.settled = left <= SETTLED * sent || gi == GiMethod::Lpv;
        }
        GiMethod::Gather => {
            work.settled = false;
            let mut before = renderer.light_in_volume()?;
            while !work.settled && work.iterations < MAX_BOUNCES {
                frame = renderer.settle(BOUNCES, clock)?;
                stats::add_stages(&mut work.stages, &frame.stages);
                work.frames += 1;
                work.iterations += BOUNCES;
                let after = renderer.light_in_volume()?;
                work.settled = after - before <= SETTLED * 0.1 * after;
                before = after;
            }
        }
    }
    Ok(())
}

/// Takes a frame's number, its picture and the exposure in stops.
type Save<'a> = &'a mut dyn FnMut(u32, &Picture, f32) -> Result<()>;

/// Frame by frame, each saved before the next is begun.
fn series(
    renderer: &mut Renderer,
    args: &RenderArgs,
    scene: &mut Scene,
    motion: &Motion,
    count: u32,
    work: &mut Work,
    save: Save<'_>,
) -> Result<()> {
    let measured = args.stats.is_some() || args.light_budget.is_some();
    let clock = measured.then_some(clock::millis as fn() -> f64);
    let bar = progress(u64::from(count), "frames");
    for n in 0..count {
        let (pose, camera) = motion.pose(scene, args.shot.time + n as f32 / args.fps);
        if motion.clip().is_some() {
            renderer.set_pose(&pose);
        }
        renderer.set_camera(&camera);
        let frame = renderer.frame(clock)?;
        stats::add_stages(&mut work.stages, &frame.stages);
        work.frames += 1;
        let Settings { gi, iterations, bounces, .. } = *renderer.settings();
        work.iterations += if gi == GiMethod::Gather { bounces } else { iterations };
        if n == 0 && gi == GiMethod::Gather && args.layer != LayerArg::Voxels {
            // A series begins with its light settled, which its exposure is for, too.
            let frame = renderer.settle(FIRST_BOUNCES, clock)?;
            stats::add_stages(&mut work.stages, &frame.stages);
            work.iterations += FIRST_BOUNCES;
        }
        let picture = read_frame(renderer, args, work)?;
        save(n, &picture, work.exposure_ev.unwrap_or(0.0))?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    if let (Some(budget), Some(taken)) = (args.light_budget, renderer.light_over_budget()) {
        tracing::warn!(
            "--light-budget {budget}: light took {taken:.1} ms of the last frame, with the fewest surfaces at a time; what \
             is left does not depend on their number: fewer cells or lights take less"
        );
    }
    Ok(())
}

/// Reads the picture. Automatic exposure is found once, so that a series does not flicker.
fn read_frame(renderer: &Renderer, args: &RenderArgs, work: &mut Work) -> Result<Picture> {
    let pixels = renderer.read_picture()?;
    work.exposure_ev.get_or_insert_with(|| match args.exposure {
        ExposureArg::Stops(ev) => ev,
        ExposureArg::Auto => tone::auto_exposure(&pixels),
    });
    Ok(Picture { width: args.size.0, height: args.size.1, pixels })
}

/// A bar on a terminal, nothing elsewhere.
pub(crate) fn progress(length: u64, what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}");
    let bar = ProgressBar::new(length).with_message(what);
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
