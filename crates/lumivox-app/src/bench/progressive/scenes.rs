//! Scenes that move, and pictures of cells by their age and by their normals: Figures 6.5, 6.7, 6.9 and 6.11 (dissertation: 68, 72, 75
//! and 77).

use std::collections::HashMap;

use anyhow::Result;
use glam::{UVec2, UVec3, Vec3};
use image::RgbImage;
use lumivox::core::{Grid, TriangleView, View};
use lumivox::progressive::{BrickCell, CleanupRule};
use lumivox_oracle::voxels::{Coverage, VoxelSet};
use lumivox_scene::{Camera, Light, Pose, Scene, builtin};

use super::quality::{BEYOND, soup};
use super::rig::{Bricks, Rig, orbit, three_channels};
use crate::bench::models::Subject;
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row};
use crate::bench::timing::Timer;
use crate::bench::voxel_picture::voxel_picture;
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
const SHOWN: [usize; 3] = [0, 3, 5];
const WAYS: [Way; 6] = [
    Way { name: "footprint", cleanup: CleanupRule::Footprint, other_cleans: false, dies: false },
    Way { name: "center", cleanup: CleanupRule::Center, other_cleans: false, dies: false },
    Way { name: "rays", cleanup: CleanupRule::Rays, other_cleans: false, dies: false },
    Way { name: "footprint, two views", cleanup: CleanupRule::Footprint, other_cleans: true, dies: false },
    Way { name: "footprint, age", cleanup: CleanupRule::Footprint, other_cleans: false, dies: true },
    Way { name: "rays, two views, age", cleanup: CleanupRule::Rays, other_cleans: true, dies: true },
];

/// Measures the scenes, frame by frame.
pub(super) fn moving(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Scenes that move");
    let (frames, side) = if quick { (8, 32) } else { (60, 64) };
    report.say(&format!(
        "One camera that stands still, {SIZE} x {SIZE} texels, all injected, {side} cells. *Stale* are occupied cells that do not touch \
         anything where it stands in that frame, even when they are 1/64 cell larger on each side; *found* is the share of the `thin` cells of that moment \
         that are occupied. *Two views*: a second view has its depth taken for cleanup and nothing else, in `door` one from the other \
         room, in `tunnel` the lamp's. *Age*: cells that fewer than {CONFIDENT} frames have shown die after {MAX_AGE} frames in which none did.",
    ));
    let detail = u32::from(!quick);
    let scenes = [
        Moving {
            name: "door",
            scene: builtin::door(detail),
            step: 9.8 / 60.0,
            other: "back room",
            cut: Vec3::new(0.9, 0.75, 0.93),
            caption: "the wall behind the door comes when it opens, and stays; the leaf and the figure that walks behind it leave a trail \
                      where no view sees their places free (above), and none where one does (below).",
        },
        Moving {
            name: "tunnel",
            scene: builtin::tunnel(detail),
            step: 12.0 / 60.0,
            other: "lamp",
            cut: Vec3::new(0.8, 0.55, 0.93),
            caption: "a tank drives towards the camera, which does not see what is behind its hull (above); the light's view does, and the cells that \
                      the tank has left vanish (in the middle).",
        },
    ];
    let mut lines = Vec::new();
    for moving in &scenes {
        lines.extend(one(timer, moving, (frames, side), report)?);
    }
    let header = ["scene", "form", "stale, mean", "stale, most", "found, first", "found, last"];
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
    let mut stale: Vec<Vec<f64>> = vec![Vec::new(); WAYS.len()];
    let mut found = stale.clone();
    let mut pictures: Vec<Vec<RgbImage>> = vec![Vec::new(); SHOWN.len()];
    let moments = [frames / 12, frames / 3, 3 * frames / 4];
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
        for (n, bricks) in bricks.iter_mut().enumerate() {
            bricks.step_with(timer, &rig, Some(&other))?;
            let cells: Vec<UVec3> =
                bricks.voxelizer.read_occupied(gpu)?.iter().map(|c| c.as_uvec3()).collect();
            let wrong = cells.iter().filter(|c| !exact.verdict(**c).possibly).count();
            stale[n].push(wrong as f64 / cells.len().max(1) as f64);
            let cells: std::collections::HashSet<UVec3> = cells.into_iter().collect();
            found[n]
                .push(thin.iter().filter(|c| cells.contains(c)).count() as f64 / thin.len().max(1) as f64);
        }
        if moments.contains(&frame) {
            for (row, way) in pictures.iter_mut().zip(SHOWN) {
                row.push(by_age(&grid, &bricks[way].voxelizer.read_cells(gpu)?, moving.cut));
            }
        }
    }
    let what = format!(
        "{}: {} Cells that the camera injects in that frame in red, older ones from yellow to blue, those that 30 frames have not shown grey; the \
         walls that would hide the rest are left out.",
        moving.name, moving.caption
    );
    let titles = moments.map(|frame| format!("{:.1} s", frame as f32 * moving.step));
    let rows: Vec<_> = SHOWN.iter().zip(pictures).map(|(way, row)| (WAYS[*way].name, row)).collect();
    let picture = sheet::contact_sheet(&rows, &titles.each_ref().map(String::as_str));
    report.picture(moving.name, &what, &picture)?;
    let mut series = Vec::new();
    let mut lines = Vec::new();
    for ((way, stale), found) in WAYS.iter().zip(&stale).zip(&found) {
        let mean = stale.iter().sum::<f64>() / stale.len().max(1) as f64;
        let most = stale.iter().copied().fold(0.0, f64::max);
        let [first, last] = [found.first(), found.last()].map(|f| f.copied().unwrap_or_default());
        for (metric, value) in
            [("stale, mean", mean), ("stale, most", most), ("found, first", first), ("found, last", last)]
        {
            report.push(Row {
                figure: "scenes that move",
                case: format!("{}, {side}", moving.name),
                metric: format!("{metric}, {}", way.name),
                value,
                unit: "1",
                paper: None,
                note: format!("{frames} frames"),
            });
        }
        let percent = |v: f64| format!("{:.2} %", 100.0 * v);
        let mut line = vec![moving.name.to_owned(), way.name.to_owned()];
        line.extend([mean, most, first, last].map(percent));
        lines.push(line);
        let points = stale.iter().enumerate().map(|(n, s)| (n as f64 + 1.0, 100.0 * s));
        series.push(Series { name: way.name.to_owned(), points: points.filter(|p| p.1 > 0.0).collect() });
    }
    let title = format!("{}: stale cells", moving.name);
    let stem = format!("stale-{}", moving.name);
    report.plot(&stem, &Plot { title, x: "frame", y: "% of the occupied cells", series })?;
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

/// A model's normals as colours, after more and more views.
pub(super) fn normals(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Figures 6.9 and 6.5: normals and ages");
    let (side, steps, size) = if quick { (48, 4, UVec2::splat(192)) } else { (128, 12, UVec2::splat(512)) };
    let grid = subject.grid(side)?;
    let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
    let mut bricks = Bricks::new(timer.gpu, &rig, grid, &three_channels(), size, CleanupRule::Footprint)?;
    let views = orbit(&subject.bounds, steps);
    let moments = [0, steps / 4, steps / 2, views.len() as u32 - 1];
    let (mut of_normals, mut of_ages) = (Vec::new(), Vec::new());
    for (n, view) in views.iter().enumerate() {
        rig.look(timer.gpu, *view);
        rig.draw(timer)?;
        bricks.step(timer, &rig)?;
        if moments.contains(&(n as u32)) {
            let cells = bricks.voxelizer.read_cells(timer.gpu)?;
            of_normals.push(by_normal(&grid, &cells));
            of_ages.push(by_age_of(&grid, &cells, |_| true));
        }
    }
    let what = format!(
        "{}, {side} cells, after 1, {}, {} and all {} frames of a camera that goes round each axis: normals as colours, and cells of that frame \
         in red, older ones from yellow to blue",
        subject.name,
        moments[1] + 1,
        moments[2] + 1,
        views.len()
    );
    let all: Vec<RgbImage> = of_normals.into_iter().zip(of_ages).flat_map(|(n, a)| [n, a]).collect();
    report.picture("normals", &what, &rows(&all, 2))
}

fn numbered(cells: &[BrickCell]) -> HashMap<UVec3, &BrickCell> {
    cells.iter().map(|c| (c.cell.as_uvec3(), c)).collect()
}

fn by_normal(grid: &Grid, cells: &[BrickCell]) -> RgbImage {
    let cells = numbered(cells);
    voxel_picture(grid, 360, |cell| {
        let normal = cells.get(&cell)?.values.first()?.truncate().normalize_or_zero();
        Some(0.5 + 0.5 * normal)
    })
}

/// A room's cells by age, without the walls towards the viewer and the ceiling.
pub(super) fn by_age(grid: &Grid, cells: &[BrickCell], cut: Vec3) -> RgbImage {
    let top = grid.dims.as_vec3() * cut;
    by_age_of(grid, cells, |cell| cell.as_vec3().cmplt(top).all())
}

fn by_age_of(grid: &Grid, cells: &[BrickCell], shows: impl Fn(UVec3) -> bool) -> RgbImage {
    let cells = numbered(cells);
    voxel_picture(grid, 360, |cell| {
        let age = cells.get(&cell).filter(|_| shows(cell))?.age;
        Some(match age {
            0 => Vec3::new(0.93, 0.16, 0.12),
            1..30 => Vec3::new(0.95, 0.8, 0.25).lerp(Vec3::new(0.2, 0.4, 0.9), age as f32 / 30.0),
            _ => Vec3::splat(0.62),
        })
    })
}

/// Pictures in columns of so many, on the colour of their corners.
fn rows(pictures: &[RgbImage], high: usize) -> RgbImage {
    let paper = pictures.first().map_or(image::Rgb([255; 3]), |p| *p.get_pixel(0, 0));
    let widest = pictures.iter().map(|p| p.width()).max().unwrap_or(1);
    let tallest = pictures.iter().map(|p| p.height()).max().unwrap_or(1);
    let columns = pictures.len().div_ceil(high) as u32;
    let mut sheet = RgbImage::from_pixel(columns * widest, high as u32 * tallest, paper);
    for (n, picture) in pictures.iter().enumerate() {
        let (x, y) = ((n / high) as i64 * i64::from(widest), (n % high) as i64 * i64::from(tallest));
        image::imageops::replace(&mut sheet, picture, x, y);
    }
    sheet
}
