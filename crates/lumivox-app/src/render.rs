//! `lumivox render`: one settled picture, or a series.

use std::path::Path;

use anyhow::{Context, Result, bail};
use glam::{UVec2, Vec3};
use indicatif::{ProgressBar, ProgressStyle};
use lumivox::light::LightSettings;
use lumivox_render::{GiMethod, Layer, Renderer, Settings, VoxelSource, tone};
use lumivox_scene::{Camera, Light, Scene};

use crate::args::{ExposureArg, RenderArgs, ShotArgs, Size};
use crate::output::{self, Picture};
use crate::stats::{self, AdapterStats, RenderStats, StageStats};
use crate::{clock, framing, info};

/// Light has settled when this share of what was sent out is still under way.
const SETTLED: f64 = 0.01;
/// A still gives up settling after this many propagation steps.
const MAX_STEPS: u32 = 8192;
/// Seconds of a camera walk, and between two frames of a series.
const WALK_SECONDS: f32 = 8.0;
const FRAME_SECONDS: f32 = 1.0 / 12.0;

/// Runs the command.
pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    output::format_of(&args.output)?;
    if args.frames.is_some() {
        output::numbered(&args.output, 0)?;
    }
    check(&args.shot)?;
    if args.stats.as_ref() == Some(&args.output) {
        bail!("{}: the picture and its statistics cannot be one file", args.output.display());
    }
    output::prepare_folder(&args.output)?;
    args.stats.as_deref().map_or(Ok(()), output::prepare_folder)?;
    let start = clock::millis();
    let scene = load(&args.shot)?;
    let load_ms = clock::millis() - start;
    let cameras = Cameras::new(&scene, &args.shot, args.frames.is_some())?;

    let gpu = info::open_gpu(&args.shot.gpu)?;
    let settings = settings(&args.shot, args.size, args.layer.into(), args.frames.is_none());
    let mut renderer = Renderer::new(&gpu, &scene, settings)?;
    let mut work = Work::default();
    match args.frames {
        Some(count) => series(&mut renderer, args, &cameras, count, &mut work)?,
        None => {
            let clock = args.stats.is_some().then_some(clock::millis as fn() -> f64);
            still(&mut renderer, args.shot.iterations, &cameras.at(args.shot.time), clock, &mut work)?;
            write_frame(&renderer, args, &args.output, &mut work)?;
        }
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
    if !shot.time.is_finite() {
        bail!("--time must be a finite number of seconds");
    }
    Ok(())
}

/// The scene with its lights, and a word about what was left out of it.
pub(crate) fn load(shot: &ShotArgs) -> Result<Scene> {
    let mut scene = lumivox_scene::load(&shot.scene)?;
    stats::warn_of_import(&scene);
    if scene.triangle_count() == 0 {
        bail!("{}: there are no triangles to render", shot.scene);
    }
    light_scene(&mut scene, shot);
    Ok(scene)
}

pub(crate) fn settings(shot: &ShotArgs, size: Size, layer: Layer, still: bool) -> Settings {
    let source = match shot.voxelizer {
        Some(voxelizer) => voxelizer.into(),
        None if still => VoxelSource::Triangles,
        None => VoxelSource::Progressive,
    };
    Settings {
        size: UVec2::new(size.0, size.1),
        grid: shot.grid,
        voxels: source,
        gi: shot.gi.into(),
        // A still starts with none, to learn how much light there is to settle.
        iterations: if still { 0 } else { shot.iterations },
        light: LightSettings { persistence: shot.persistence, ..LightSettings::default() },
        layer,
        shadow_size: if still { 4096 } else { 2048 },
        area_samples: if still { 256 } else { 64 },
        area_maps: if still { 64 } else { 32 },
        ..Settings::default()
    }
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
    if gi != GiMethod::Off && layer != Layer::Voxels && iterations > 0 {
        let sent = renderer.flux_under_way()?;
        let mut left = sent;
        let bar = progress(100, "light settles");
        while left > SETTLED * sent && work.iterations < MAX_STEPS {
            frame = renderer.settle(iterations, clock)?;
            stats::add_stages(&mut work.stages, &frame.stages);
            work.frames += 1;
            work.iterations += iterations;
            left = renderer.flux_under_way()?;
            bar.set_position((100.0 * ((left / sent).ln() / SETTLED.ln()).clamp(0.0, 1.0)) as u64);
        }
        bar.finish_and_clear();
        work.settled = left <= SETTLED * sent;
    }
    Ok(())
}

fn series(
    renderer: &mut Renderer,
    args: &RenderArgs,
    cameras: &Cameras,
    count: u32,
    work: &mut Work,
) -> Result<()> {
    let clock = args.stats.is_some().then_some(clock::millis as fn() -> f64);
    let bar = progress(u64::from(count), "frames");
    for n in 0..count {
        renderer.set_camera(&cameras.at(args.shot.time + FRAME_SECONDS * n as f32));
        let frame = renderer.frame(clock)?;
        stats::add_stages(&mut work.stages, &frame.stages);
        work.frames += 1;
        work.iterations += args.shot.iterations;
        write_frame(renderer, args, &output::numbered(&args.output, n)?, work)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

/// Writes the picture. Automatic exposure is found once, so that a series does not flicker.
fn write_frame(renderer: &Renderer, args: &RenderArgs, path: &Path, work: &mut Work) -> Result<()> {
    let pixels = renderer.read_picture()?;
    let exposure = *work.exposure_ev.get_or_insert_with(|| match args.exposure {
        ExposureArg::Stops(ev) => ev,
        ExposureArg::Auto => tone::auto_exposure(&pixels),
    });
    let picture = Picture { width: args.size.0, height: args.size.1, pixels };
    output::write_picture(path, &picture, args.layer.into(), exposure)
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

/// The lights of the command line, else the scene's, else a sun and a grey sky.
fn light_scene(scene: &mut Scene, shot: &ShotArgs) {
    if let Some(sun) = shot.sun {
        scene.lights = vec![Light::Directional { direction: sun.direction, irradiance: sun.irradiance }];
        scene.sky = Vec3::ZERO;
        return;
    }
    let emits = scene.materials.iter().any(|m| m.emission.max_element() > 0.0);
    if scene.lights.is_empty() && !emits && scene.sky == Vec3::ZERO {
        eprintln!("lumivox: the scene has no light: a sun and a grey sky are added (--sun sets another)");
        let direction = Vec3::new(0.35, -1.0, -0.45).normalize_or_zero();
        scene.lights = vec![Light::Directional { direction, irradiance: Vec3::new(9.0, 8.4, 7.4) }];
        scene.sky = Vec3::splat(0.4);
    }
}

/// Where the camera is at a time.
pub(crate) struct Cameras {
    fixed: Option<Camera>,
}

impl Cameras {
    pub(crate) fn new(scene: &Scene, shot: &ShotArgs, series: bool) -> Result<Self> {
        let walks = shot.scene.starts_with("builtin:atrium") && (series || shot.time != 0.0);
        if let Some(c) = shot.camera {
            let camera = Camera {
                name: "command line".to_owned(),
                eye: c.eye,
                target: c.target,
                up: Vec3::Y,
                fov_y: c.fov_y_deg.to_radians(),
            };
            return Ok(Self { fixed: Some(camera) });
        }
        if walks {
            return Ok(Self { fixed: None });
        }
        let camera = scene.cameras.first().cloned().or_else(|| framing::best_camera(scene));
        Ok(Self { fixed: Some(camera.context("the scene has no triangles to frame")?) })
    }

    pub(crate) fn at(&self, seconds: f32) -> Camera {
        let walk = || lumivox_scene::builtin::atrium_camera_path((seconds / WALK_SECONDS).clamp(0.0, 1.0));
        self.fixed.clone().unwrap_or_else(walk)
    }
}
