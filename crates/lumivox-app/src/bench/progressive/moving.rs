//! Scenes that move: Figures 6.7 and 6.11 (dissertation: 72 and 77). What is left where nothing is any more, what is found, and
//! pictures of both.

use std::collections::HashSet;

use anyhow::Result;
use glam::{UVec2, UVec3, Vec3};
use image::RgbImage;
use lumivox::core::{Grid, TriangleView, View};
use lumivox::progressive::CleanupRule;
use lumivox_oracle::voxels::{Coverage, VoxelSet};
use lumivox_scene::{Camera, Light, Pose, Scene, builtin};

use super::frames::{Frames, percent};
use super::pictures::by_age;
use super::proof::Shot;
use super::quality::{BEYOND, soup};
use super::rig::{Bricks, Rig, orbit, three_channels};
use crate::bench::report::{Report, Row};
use crate::bench::timing::Timer;
use crate::sheet;

/// Texels a side of the camera's pictures.
const SIZE: u32 = 384;
/// Frames after which cells die that few frames have shown, and how many are few.
const MAX_AGE: u32 = 8;
const CONFIDENT: u32 = 12;

/// A scene that moves.
struct Moving {
    name: &'static str,
    scene: Scene,
    /// Seconds between frames.
    step: f32,
    /// What the second view is.
    other: &'static str,
    /// How much of the grid its pictures show along each axis, so that a wall does not hide the rest.
    cut: Vec3,
    /// What they show.
    caption: &'static str,
}

/// How a volume is kept in such a scene.
struct Way {
    name: &'static str,
    cleanup: CleanupRule,
    /// Whether the second view cleans.
    other_cleans: bool,
    dies: bool,
}

/// Those that pictures show.
const SHOWN: [usize; 3] = [0, 4, 6];
const WAYS: [Way; 7] = [
    Way { name: "footprint", cleanup: CleanupRule::Footprint, other_cleans: false, dies: false },
    Way { name: "center", cleanup: CleanupRule::Center, other_cleans: false, dies: false },
    Way { name: "rays", cleanup: CleanupRule::Rays, other_cleans: false, dies: false },
    Way { name: "footprint, two views", cleanup: CleanupRule::Footprint, other_cleans: true, dies: false },
    Way { name: "rays, two views", cleanup: CleanupRule::Rays, other_cleans: true, dies: false },
    Way { name: "footprint, age", cleanup: CleanupRule::Footprint, other_cleans: false, dies: true },
    Way { name: "rays, two views, age", cleanup: CleanupRule::Rays, other_cleans: true, dies: true },
];

/// What became of a way, frame by frame.
#[derive(Default)]
struct Fate {
    /// Shares of the occupied cells.
    stale: Vec<f64>,
    seen: Vec<f64>,
    /// Cells that a view proves empty, and those of them that are stale and still there.
    proven: Vec<f64>,
    left: Vec<f64>,
    /// The share of the thin cells.
    found: Vec<f64>,
    /// What is occupied after the last frame.
    cells: HashSet<UVec3>,
    pictures: Vec<RgbImage>,
}

/// Measures the scenes, frame by frame.
pub(super) fn run(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Scenes that move");
    let (frames, side) = if quick { (8, 32) } else { (60, 64) };
    report.say(&format!(
        "One camera that stands still, {SIZE} x {SIZE} texels, all injected, {side} cells, {frames} frames. *Two views*: a second view has its \
         depth taken for cleanup and nothing else, in `door` one from the other room, in `tunnel` the lamp's. *Age*: cells that fewer than \
         {CONFIDENT} frames have shown die after {MAX_AGE} frames in which none did.\n\n\
         *Stale* are occupied cells that do not touch anything where it stands in that frame, even when they are 1/64 cell larger on each side. \
         *Proven*: cells occupied before a frame that a view of that frame proves empty under the rule in use, as a definition in double precision on the \
         CPU has it, over all frames; *left*: stale cells that such a view proves empty and that are there after it. What is proven empty is to be gone \
         within two frames; 0 says that it is gone in the first. *Seen through*: stale cells \
         that lie in a view's picture whole, with something behind them at every texel whose ray meets them, by geometry alone; rules must \
         leave some of these, since they also ask about texels that a cell only comes near to. *Found* is the share of the `thin` cells of that moment \
         that are occupied; most of both scenes is what no camera sees, such as the outer faces of walls.\n\n\
         `footprint`, the default, leaves most: it wants the nearest depth all over a cell's footprint to lie behind the cell's farthest corner, and around what was left \
         beside a floor or a wall the picture shows that floor or wall before that corner. What keeps good cells at grazing angles \
         keeps those stale ones too. `rays` asks where each texel's ray leaves the cell, and clears them; what no view sees is left to age.",
    ));
    let detail = u32::from(!quick);
    let scenes = [
        Moving {
            name: "door",
            scene: builtin::door(detail),
            step: 9.8 / 60.0,
            other: "back room",
            cut: Vec3::new(0.9, 0.75, 0.93),
            caption: "the door opens, and with it comes the wall behind it (3.3 and 7.4 s); it shuts again, and the wall is still there (9.6 s). By \
                      footprint with the camera alone (above) the leaf leaves a trail where it swung, on the floor and along the wall, and the figure columns \
                      where it walked. By rays with a view from the back room (in the middle) the floor is clear and so is the figure's way; cells \
                      along the leaf stay. With age (below) most of these go, and with them the piece of wall that the open leaf hides, which is good; what \
                      the leaf left last is not old enough yet (9.6 s).",
        },
        Moving {
            name: "tunnel",
            scene: builtin::tunnel(detail),
            step: 12.0 / 60.0,
            other: "lamp",
            cut: Vec3::new(0.8, 0.55, 0.93),
            caption: "a tank drives towards the camera (1.0 and 4.0 s) and back (9.0 and 11.8 s). The camera does not see what is behind its \
                      hull, and keeps a trail over the whole way (above); the lamp, which travels ahead of the tank on one side, sees that side free and clears the \
                      trail there, not on the other (in the middle); with age (below) the rest goes after some frames. In the end the tank \
                      covers where its trail was.",
        },
    ];
    let mut lines = Vec::new();
    for moving in &scenes {
        lines.extend(one(timer, moving, (frames, side), report)?);
    }
    let header = [
        "scene",
        "form",
        "stale, mean",
        "stale, most",
        "seen through, mean",
        "proven / left",
        "found, first",
        "found, last",
    ];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

fn one(
    timer: &Timer<'_>,
    moving: &Moving,
    (frames, side): (u32, u32),
    report: &mut Report,
) -> Result<Vec<Vec<String>>> {
    let (gpu, size) = (timer.gpu, UVec2::splat(SIZE));
    let bounds = moving.scene.bounds_in_motion(0);
    let grid = Grid::fit(&bounds, side)?;
    let mut scene = moving.scene.clone();
    let mut rig = Rig::new(gpu, &scene, size)?;
    let mut other = Rig::new(gpu, &scene, size)?;
    let mut bricks: Vec<Bricks> = WAYS
        .iter()
        .map(|way| {
            let bricks = Bricks::new(gpu, &rig, grid, &three_channels(), size, way.cleanup)?;
            let bricks = if way.dies { bricks.mortal(gpu, MAX_AGE, CONFIDENT)? } else { bricks };
            Ok(if way.other_cleans { bricks.with_other(gpu, &other) } else { bricks })
        })
        .collect::<Result<_>>()?;
    let mut fates: Vec<Fate> = WAYS.iter().map(|_| Fate::default()).collect();
    let moments = [frames / 12, frames / 3, 3 * frames / 4, frames - 1];
    for frame in 0..frames {
        let pose = scene.pose(0, frame as f32 * moving.step);
        scene.apply(&pose);
        rig.pose(gpu, &pose);
        other.pose(gpu, &pose);
        let reach = bounds.size().length();
        rig.look(gpu, camera(&scene, 0, reach));
        other.look(gpu, other_view(moving, &scene, &pose, reach));
        rig.draw(timer)?;
        other.draw(timer)?;
        let (positions, indices) = soup(&scene);
        let mesh = TriangleView { positions: &positions, indices: &indices };
        let exact = VoxelSet::with_margin(grid, mesh, Coverage::Exact, 2.0 * BEYOND);
        let thin: Vec<UVec3> = VoxelSet::of(grid, mesh, Coverage::Thin).cells().collect();
        let shots = [Shot::take(gpu, &rig)?, Shot::take(gpu, &other)?];
        for ((bricks, way), fate) in bricks.iter_mut().zip(&WAYS).zip(&mut fates) {
            bricks.step_with(timer, &rig, Some(&other))?;
            let cells: HashSet<UVec3> =
                bricks.voxelizer.read_occupied(gpu)?.iter().map(|c| c.as_uvec3()).collect();
            let stale: HashSet<UVec3> =
                cells.iter().copied().filter(|c| !exact.verdict(*c).possibly).collect();
            let views = &shots[..if way.other_cleans { 2 } else { 1 }];
            let count = |of: &HashSet<UVec3>, is: &dyn Fn(&Shot, UVec3) -> bool| {
                of.iter().filter(|cell| views.iter().any(|shot| is(shot, **cell))).count() as f64
            };
            let proven = |shot: &Shot, cell| shot.proves_empty(&grid, cell, way.cleanup);
            let all = cells.len().max(1) as f64;
            fate.stale.push(stale.len() as f64 / all);
            fate.seen.push(count(&stale, &|shot, cell| shot.sees_through(&grid, cell)) / all);
            fate.proven.push(count(&fate.cells, &proven));
            fate.left.push(count(&stale, &proven));
            fate.found
                .push(thin.iter().filter(|c| cells.contains(c)).count() as f64 / thin.len().max(1) as f64);
            fate.cells = cells;
        }
        if moments.contains(&frame) {
            for way in SHOWN {
                fates[way].pictures.push(by_age(&grid, &bricks[way].voxelizer.read_cells(gpu)?, moving.cut));
            }
        }
    }
    let what = format!(
        "{}: {} Cells that the camera injects in that frame in red, older ones from yellow to blue, those that 30 frames have not shown grey; the \
         walls that would hide the rest are left out.",
        moving.name, moving.caption
    );
    let titles = moments.map(|frame| format!("{:.1} s", frame as f32 * moving.step));
    let rows: Vec<_> =
        SHOWN.iter().map(|way| (WAYS[*way].name, std::mem::take(&mut fates[*way].pictures))).collect();
    let picture = sheet::contact_sheet(&rows, &titles.each_ref().map(String::as_str));
    report.picture(moving.name, &what, &picture)?;
    told(moving.name, side, &fates, report)
}

/// The numbers, for the JSON, plots and the table.
fn told(name: &str, side: u32, fates: &[Fate], report: &mut Report) -> Result<Vec<Vec<String>>> {
    let frames = |metric, y, stem: &str| Frames::new(metric, y, &format!("{stem}-{name}"));
    let mut stale = frames("stale cells", "% of the occupied cells", "stale");
    let mut found = frames("coverage", "% of the thin cells", "found");
    let mut lines = Vec::new();
    for (way, fate) in WAYS.iter().zip(fates) {
        let sum = |of: &[f64]| of.iter().sum::<f64>();
        let mean = |of: &[f64]| sum(of) / of.len().max(1) as f64;
        let most = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
        let [first, last] = [fate.found.first(), fate.found.last()].map(|f| f.copied().unwrap_or_default());
        let (of_stale, of_found): (&[f64], &[f64]) = (&fate.stale, &fate.found);
        let values = [
            ("stale, mean", mean(of_stale), of_stale),
            ("stale, most", most(of_stale), &[]),
            ("seen through, mean", mean(&fate.seen), &fate.seen),
            ("cells proven empty, sum", sum(&fate.proven), &[]),
            ("stale cells proven empty and left, sum", sum(&fate.left), &fate.left),
            ("found, first", first, &[]),
            ("found, last", last, of_found),
        ];
        for (metric, value, by_frame) in values {
            let row = Row {
                figure: "scenes that move",
                case: format!("{name}, {side}"),
                metric: format!("{metric}, {}", way.name),
                value,
                unit: "1",
                paper: None,
                note: format!("{} frames", fate.stale.len()),
            };
            report.push_frames(row, by_frame);
        }
        let [.., proven, left, _, _] = values.map(|(_, value, _)| value);
        let shares = [values[0].1, values[1].1, values[2].1].map(percent);
        let mut line = vec![name.to_owned(), way.name.to_owned()];
        line.extend(shares);
        line.push(format!("{proven} / {left}"));
        line.extend([first, last].map(percent));
        lines.push(line);
        stale.add(way.name, &fate.stale);
        found.add(way.name, &fate.found);
    }
    stale.plot(name, report)?;
    found.plot(name, report)?;
    Ok(lines)
}

fn camera(scene: &Scene, number: usize, reach: f32) -> View {
    let Some(c) = scene.cameras.get(number).or(scene.cameras.first()) else {
        return orbit(&scene.bounds(), 5)[0];
    };
    view_from(c, reach)
}

/// A square view from a camera into a scene that is so long.
pub(super) fn view_from(c: &Camera, reach: f32) -> View {
    View::perspective(c.eye, c.target, c.up, c.fov_y, 1.0, 0.05, 1.5 * reach).with_reversed_depth()
}

/// The view that only cleans: the first spot light's, or the last camera's.
fn other_view(moving: &Moving, scene: &Scene, pose: &Pose, reach: f32) -> View {
    let spot = pose.lights.iter().find_map(|light| match *light {
        Light::Spot { position, direction, .. } if moving.other == "lamp" => Some((position, direction)),
        _ => None,
    });
    match spot {
        Some((eye, along)) => {
            View::perspective(eye, eye + along, Vec3::Y, 1.6, 1.0, 0.05, 1.5 * reach).with_reversed_depth()
        }
        None => camera(scene, scene.cameras.len().saturating_sub(1), reach),
    }
}
