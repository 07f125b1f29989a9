//! `lumivox compare`: ours against the path tracer, or against another renderer's pictures: numbers, pictures, differences.

mod args;
pub(crate) mod measure;
pub(crate) mod oracle_scene;
pub(crate) mod ours;
pub(crate) mod pictures;
pub(crate) mod reference;
mod report;
mod voxels;

use anyhow::{Context, Result, bail};
use lumivox::gpu::Gpu;
use lumivox_oracle::tracer::PixelFilter;
use lumivox_render::{GiMethod, Layer};

pub(crate) use args::CompareArgs;
use measure::{Comparison, MIN_ALBEDO, Masks, Pair};
use ours::Ours;
use reference::{Budget, Files};
use report::{ForegroundStats, ReferenceStats, Report};
use voxels::VoxelComparison;

use crate::args::{GiArg, Size};
use crate::motion::Motion;
use crate::stats::{self, AdapterStats};
use crate::{clock, info, lighting, output, render};

/// Pictures are this large when neither the command line nor the reference says otherwise.
const SIZE: Size = Size(480, 270);

/// Runs the command.
pub(crate) fn run(args: &CompareArgs) -> Result<()> {
    render::check(&args.shot)?;
    let json = args.out.join("compare.json");
    output::prepare(&json)?;
    if let Some(stats) = &args.stats {
        output::prepare(stats)?;
        output::check_apart(&[&args.shot.scene], &[stats])?;
    }
    let start = clock::millis();
    let files = args.reference.as_deref().map(Files::read).transpose()?;
    let size = picture_size(args, files.as_ref())?;
    let mut scene = render::load(&args.shot)?;
    let load_ms = clock::millis() - start;
    let (_, camera) = Motion::new(&scene, &args.shot, false)?.pose(&mut scene, args.shot.time);
    lighting::light_scene(&mut scene, &args.shot, &camera);
    let oracle_scene = oracle_scene::oracle_scene(&scene);
    let oracle_camera = oracle_scene::oracle_camera(&camera);

    let glows = scene.materials.iter().any(|m| m.emission.max_element() > 0.0);
    if glows {
        eprintln!(
            "lumivox: surfaces glow: the renderer counts all of their light as indirect, so compare the total, not the layers"
        );
    }
    let gpu = info::open_gpu(&args.shot.gpu)?;
    let settings = render::settings(&args.shot, &scene, size, Layer::Direct, true);
    let ours = ours::render(
        &gpu,
        &scene,
        settings,
        (ours::Pixels::Mean(args.points_a_side()), args.shot.iterations),
        &camera,
    )
    .with_context(|| args.shot.scene.clone())?;
    let (pairs, masks, mut reference) = match files {
        Some(files) => {
            let (albedo, seen) = reference::albedo_and_foreground(&oracle_scene, &oracle_camera, args, size)?;
            let masks = Masks::new(&ours.drawn, &seen, &[&ours.albedo, &albedo]);
            let stats = ReferenceStats::Files {
                folder: args.reference.as_ref().map(|f| f.display().to_string()).unwrap_or_default(),
                irradiance: "its radiance over the path tracer's albedo",
            };
            let pairs = measure::file_pairs(&ours, &files, &albedo, &masks);
            (measure::with_totals(pairs, glows), masks, stats)
        }
        None => against_tracer(args, size, (&ours, glows), (&oracle_scene, &oracle_camera))?,
    };
    let comparisons: Vec<Comparison> = pairs.iter().map(Pair::compare).collect();
    if let ReferenceStats::PathTracer { noise_is_low, .. } = &mut reference {
        *noise_is_low = comparisons.iter().all(|c| c.noise_is_low != Some(false));
    }
    pictures::write(&args.out, &pairs, &comparisons, &reference.name())?;

    let voxels_start = clock::millis();
    let voxels = compare_voxels(&ours, &gpu, &oracle_scene)?;
    let settings = *ours.renderer.settings();
    let grid = *ours.renderer.volume().grid();
    let report = Report {
        scene: args.shot.scene.clone(),
        adapter: AdapterStats::new(&gpu),
        size: [size.0, size.1],
        antialias: args.points_a_side(),
        camera: (&camera).into(),
        time_s: args.shot.time,
        triangles: scene.triangle_count(),
        lights: scene.lights.len(),
        sky: scene.sky.into(),
        grid: grid.dims.to_array(),
        cell_size_m: grid.cell_size,
        voxelizer: format!("{:?}", settings.voxels),
        gi: format!("{:?}", settings.gi),
        persistence: args.shot.persistence,
        shadow_size: settings.shadow_size,
        area_samples: settings.area_samples,
        frames: ours.work.frames,
        iterations: ours.work.iterations,
        settled: ours.work.settled,
        reference,
        foreground: ForegroundStats {
            both: masks.foreground.iter().filter(|&&kept| kept).count(),
            only_ours: masks.only_ours,
            only_reference: masks.only_reference,
            min_albedo: MIN_ALBEDO,
        },
        comparisons,
        voxels_note: voxels.as_ref().err().cloned(),
        voxels: voxels.ok(),
        load_ms,
        render_ms: ours.millis,
        voxels_ms: clock::millis() - voxels_start,
        total_ms: clock::millis() - start,
        stages: ours.work.stages,
        import: scene.report.clone(),
    };
    report.print(&mut std::io::stdout().lock())?;
    stats::write(&json, &report)?;
    args.stats.as_deref().map_or(Ok(()), |path| stats::write(path, &report))?;
    eprintln!("lumivox: pictures, differences, sheet.png and compare.json are in {}", args.out.display());
    Ok(())
}

/// What the command line says; it must be the reference's, if there is one.
fn picture_size(args: &CompareArgs, files: Option<&Files>) -> Result<Size> {
    match (args.size, files.map(Files::size)) {
        (Some(asked), Some(found)) if asked != found => bail!(
            "--size {}x{} is not the reference's {}x{}; without --size the reference's is taken",
            asked.0,
            asked.1,
            found.0,
            found.1
        ),
        (asked, found) => Ok(found.or(asked).unwrap_or(SIZE)),
    }
}

type OracleView<'a> = (&'a lumivox_oracle::scene::Scene, &'a lumivox_oracle::scene::Camera);

fn against_tracer(
    args: &CompareArgs,
    size: Size,
    (ours, glows): (&Ours, bool),
    (scene, camera): OracleView<'_>,
) -> Result<(Vec<Pair>, Masks, ReferenceStats)> {
    let masks = |rendering: &lumivox_oracle::tracer::Rendering| {
        Masks::new(&ours.drawn, &rendering.foreground(), &[&ours.albedo])
    };
    let budget = Budget {
        size,
        seed: args.seed,
        filter: if args.points_a_side() > 1 { PixelFilter::Box } else { PixelFilter::Center },
        // Without indirect light of ours there is nothing to hold bounces against.
        bounces: matches!(args.shot.gi, GiArg::Off).then_some(0),
        max_samples: args.max_samples,
        max_seconds: args.max_seconds,
    };
    let traced = reference::trace(scene, camera, &budget, |rendering| {
        let pairs = measure::with_totals(measure::traced_pairs(ours, rendering, &masks(rendering)), glows);
        // Where surfaces glow, the layers apart are not what is asked.
        pairs.iter().filter(|p| !glows || p.layer == "total").all(Pair::is_quiet)
    })?;
    let masks = masks(&traced.rendering);
    let stats = ReferenceStats::PathTracer {
        samples: traced.samples,
        seconds: traced.seconds,
        seed: args.seed,
        max_samples: args.max_samples,
        max_seconds: args.max_seconds,
        noise_is_low: false,
    };
    let pairs = measure::traced_pairs(ours, &traced.rendering, &masks);
    Ok((measure::with_totals(pairs, glows), masks, stats))
}

/// The difference of the voxels, or why there is none.
fn compare_voxels(
    ours: &Ours,
    gpu: &Gpu,
    scene: &lumivox_oracle::scene::Scene,
) -> Result<Result<VoxelComparison, String>> {
    let side = ours.renderer.volume().grid().dims.max_element();
    if ours.renderer.settings().gi == GiMethod::Off {
        return Ok(Err("without indirect light there is no volume".to_owned()));
    }
    if side > voxels::MAX_SIDE {
        return Ok(Err(format!(
            "the exact voxelizer is too slow for more than {} cells a side",
            voxels::MAX_SIDE
        )));
    }
    Ok(Ok(voxels::compare(&ours.renderer, gpu, scene)?))
}
