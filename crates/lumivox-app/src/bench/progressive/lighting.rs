//! Light of single frames beside that of a volume that is kept, and beside that of all triangles: Figures 6.6, 71 and 79.

use anyhow::Result;
use glam::{UVec2, Vec3};
use lumivox::gather::Quality;
use lumivox::gpu::Gpu;
use lumivox_render::{Layer, Renderer, Settings, VoxelSource};
use lumivox_scene::{Camera, Scene, builtin};

use crate::bench::report::{Report, Row};
use crate::bench::timing::Timer;
use crate::output::Picture;
use crate::sheet;

/// Pictures in a row.
const SHOWN: usize = 4;
/// Frames before the first that counts.
pub(super) const WARM_UP: usize = 4;
pub(super) const SOURCES: [(&str, VoxelSource); 3] = [
    ("single frames", VoxelSource::SingleFrame),
    ("progressive", VoxelSource::Progressive),
    ("triangles", VoxelSource::Triangles),
];

/// What is seen in one frame, and when.
struct Moment {
    name: String,
    camera: Camera,
    /// Of the scene's clip.
    seconds: f32,
}

/// The pictures of a run, and how they differ from those of triangles.
pub(super) struct Run {
    pub(super) name: &'static str,
    pub(super) pictures: Vec<Vec<Vec3>>,
    /// The mean difference at the pixels, in parts of the mean of triangles.
    pub(super) off: Vec<f64>,
    /// The mean, in the same parts.
    pub(super) level: Vec<f64>,
}

/// A walk through the atrium, and the sun over its curtains.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let scene = builtin::atrium(if quick { 0 } else { 1 });
    report.head("Figures 6.6, 71 and 79: light from frame to frame");
    report.say(
        "Gathered light in the built-in atrium, all surfels in each frame, and the voxels of each frame alone, those that are kept, and those of all \
         triangles, which the others are held against: *off* is the mean difference of indirect light at the pixels, in parts of its mean. A volume \
         that knows less than there is lets light in or loses it, and how much changes when the camera turns: *jumps* is the largest change of the mean of \
         indirect light, in parts of that of triangles, from a frame to the next, *steps* the mean of these changes. The walk is there and back, each \
         way looking ahead, and only the way back counts, when what is kept has seen both.",
    );
    let frames = if quick { 6 } else { 12 };
    let there = (0..frames).rev().map(|n| ("there", n));
    let walk: Vec<Moment> = there
        .chain((0..frames).map(|n| ("back", n)))
        .map(|(way, n)| {
            let along = 0.3 + 0.5 * n as f32 / (frames - 1) as f32;
            let camera = builtin::atrium_camera_path(along);
            let camera = if way == "there" { looking_back(camera) } else { camera };
            Moment { name: format!("{way}, frame {}", n + 1), camera, seconds: 0.0 }
        })
        .collect();
    let runs = measure(timer.gpu, &scene, &walk, quick)?;
    // Where the light of single frames changes most.
    let change = |n: usize| (runs[0].level[n + 1] - runs[0].level[n]).abs();
    let most = (frames..2 * frames - 1).max_by(|a, b| change(*a).total_cmp(&change(*b))).unwrap_or(frames);
    let first = (most - 1).clamp(frames, 2 * frames - SHOWN);
    let shown: Vec<usize> = (first..first + SHOWN).collect();
    show(&runs, &walk, (frames, &shown, quick), ("jumps", "walk"), report)?;

    // By the curtains first, so that what is kept knows them; then from where they cannot be seen.
    let (before, days) = if quick { (4, 4) } else { (12, 6) };
    let past = (0..before).map(|n| {
        let way = 2.0 * n as f32 / before as f32;
        let out = builtin::atrium_camera_path(0.8 * way.min(2.0 - way));
        let camera = if way < 1.0 { out } else { looking_back(out) };
        Moment { name: "on the way".to_owned(), camera, seconds: 0.0 }
    });
    // In the arcade on the shaded side, for an afternoon.
    let hidden = scene.cameras.iter().find(|c| c.name == "shaded arcade").unwrap_or(&walk[0].camera);
    let day = (0..days).map(|n| {
        let seconds = 7.0 * n as f32 / days as f32;
        Moment { name: format!("{seconds:.1} s"), camera: hidden.clone(), seconds }
    });
    let all: Vec<Moment> = past.chain(day).collect();
    let runs = measure(timer.gpu, &scene, &all, quick)?;
    let shown: Vec<usize> = (0..SHOWN).map(|n| before + n * days / SHOWN).collect();
    show(&runs, &all, (before, &shown, quick), ("curtains", "sun"), report)
}

/// The other way on a path: who walks looks ahead.
fn looking_back(camera: Camera) -> Camera {
    Camera { target: 2.0 * camera.eye - camera.target, ..camera }
}

pub(super) fn size(quick: bool) -> UVec2 {
    if quick { UVec2::new(160, 90) } else { UVec2::new(320, 180) }
}

/// Indirect light, without the turns of surfels.
pub(super) fn settings(quick: bool) -> Settings {
    let mut settings = Settings {
        size: size(quick),
        grid: if quick { 32 } else { 64 },
        clip: Some(0),
        rsm_size: 256,
        points: 320,
        area_samples: 16,
        area_maps: 16,
        layer: Layer::Indirect,
        ..Settings::of(Quality::Medium)
    };
    settings.gather.frames = 1.0;
    settings
}

fn measure(gpu: &Gpu, scene: &Scene, moments: &[Moment], quick: bool) -> Result<Vec<Run>> {
    let settings = settings(quick);
    let mut runs = Vec::new();
    for (name, voxels) in SOURCES {
        let mut renderer = Renderer::new(gpu, scene, Settings { voxels, ..settings })?;
        let mut pictures = Vec::new();
        // So many bounces first that the first picture is not darker than the others.
        for moment in std::iter::repeat_n(&moments[0], WARM_UP).chain(moments) {
            renderer.set_pose(&scene.pose(0, moment.seconds));
            renderer.set_camera(&moment.camera);
            renderer.frame(None)?;
            pictures.push(renderer.read_picture()?);
        }
        pictures.drain(..WARM_UP);
        runs.push(Run { name, pictures, off: Vec::new(), level: Vec::new() });
    }
    compare(&mut runs);
    Ok(runs)
}

/// Holds runs against the last, that of triangles.
pub(super) fn compare(runs: &mut [Run]) {
    let Some(truth) = runs.last().map(|run| run.pictures.clone()) else { return };
    let sum = |of: &mut dyn Iterator<Item = Vec3>| of.map(|p| f64::from(p.element_sum())).sum::<f64>();
    let whole: Vec<f64> = truth.iter().map(|t| sum(&mut t.iter().copied()).max(1e-9)).collect();
    for run in runs {
        for ((ours, truth), whole) in run.pictures.iter().zip(&truth).zip(&whole) {
            run.off.push(sum(&mut ours.iter().zip(truth).map(|(a, b)| (*a - *b).abs())) / whole);
            run.level.push(sum(&mut ours.iter().copied()) / whole);
        }
    }
}

fn show(
    runs: &[Run],
    moments: &[Moment],
    (begin, shown, quick): (usize, &[usize], bool),
    (stem, what): (&str, &str),
    report: &mut Report,
) -> Result<()> {
    let mut lines = Vec::new();
    for run in runs.iter().filter(|run| run.name != "triangles") {
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
        let off = mean(&run.off[begin..]);
        let changes: Vec<f64> = run.level[begin..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
        let (steps, jumps) = (mean(&changes), changes.iter().copied().fold(0.0, f64::max));
        // Under a sun that moves, what is missing changes by itself.
        let shown = if stem == "jumps" { 3 } else { 1 };
        let found = [("off", off), ("steps", steps), ("jumps", jumps)];
        for (metric, value) in found.into_iter().take(shown) {
            report.push(Row {
                figure: "light from frame to frame",
                case: format!("atrium, {what}"),
                metric: format!("{metric}, {}", run.name),
                value,
                unit: "1",
                paper: None,
                note: format!("{} frames", run.off.len() - begin),
            });
        }
        let percent = |v: f64| format!("{:.1} %", 100.0 * v);
        let mut line = vec![what.to_owned(), run.name.to_owned()];
        line.extend(found.iter().take(shown).map(|(_, value)| percent(*value)));
        lines.push(line);
    }
    let header = ["frames", "voxels of", "off", "steps", "jumps"].map(str::to_owned);
    report.table(&header[..lines.first().map_or(0, Vec::len)], &lines);
    let brightest = runs.iter().flat_map(|run| shown.iter().flat_map(|n| &run.pictures[*n])).copied();
    let exposure_ev = lumivox_render::tone::auto_exposure(&brightest.collect::<Vec<_>>());
    let size = size(quick);
    let tiles = runs.iter().map(|run| {
        let tile = |n: &usize| {
            let picture = Picture { width: size.x, height: size.y, pixels: run.pictures[*n].clone() };
            let off = match run.name {
                "triangles" => moments[*n].name.clone(),
                _ => format!(
                    "{}, {:.0} % off, mean {:.2}",
                    moments[*n].name,
                    100.0 * run.off[*n],
                    run.level[*n]
                ),
            };
            ([run.name.to_owned(), off], picture.srgb(Layer::Final, exposure_ev))
        };
        shown.iter().map(tile).collect()
    });
    let sheet = sheet::captioned_sheet(&tiles.collect::<Vec<_>>());
    let caption = match stem {
        "jumps" => {
            "Indirect light in the atrium in frames that follow each other on the way back of a walk: above of the voxels that each frame's views show, which changes with \
             what they show; in the middle of those that are kept; below of all triangles"
        }
        _ => {
            "Indirect light in the atrium under a sun that moves, seen from an arcade after the camera has walked out of it, past the curtains of both \
             sides and back; most of them are behind columns here. Above of the voxels of each frame, in the middle of those that are kept, below of all triangles"
        }
    };
    report.picture(stem, caption, &sheet)
}
