//! Figures 1, 6 and 7.

use std::sync::Arc;

use anyhow::{Context, Result};
use glam::{UVec3, Vec3};
use lumivox::core::Grid;
use lumivox::volume::{ALBEDO, NORMAL};
use lumivox::voxelize::{Channel, Method, SurfaceFunction, Voxelizer};

use super::{clipping, paper, slicing, way};
use crate::bench::models::Subject;
use crate::bench::report::{Report, Row, thousands};
use crate::bench::timing::Timer;
use crate::bench::voxel_picture::voxel_picture;
use crate::sheet::contact_sheet;

const GREY: Vec3 = Vec3::splat(0.78);
const SIDE: u32 = 420;

fn cells(timer: &Timer<'_>, subject: &Subject, grid: Grid, method: Method) -> Result<Vec<bool>> {
    let gpu = timer.gpu;
    let mut voxelizer = Voxelizer::new(gpu, grid, &[], &way("", method).options)?;
    let mut volume = voxelizer.volume(gpu)?;
    let meshes: Vec<_> = subject.meshes.iter().collect();
    timer.submit(|e| voxelizer.record(gpu, e, &meshes, &mut volume))?;
    Ok(voxelizer.read_occupancy(gpu)?)
}

fn count(cells: &[bool]) -> usize {
    cells.iter().filter(|c| **c).count()
}

fn number(figure: &'static str, case: String, metric: String, value: usize, paper: Option<f64>) -> Row {
    Row { figure, case, metric, value: value as f64, unit: "cells", paper, note: String::new() }
}

/// Figure 1: several volumes of one scene.
pub(super) fn channels(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Figure 1: channels");
    report.say(
        "Occupancy, albedo, normals and sunlight (without shadows) of the built-in terrain, by slicing in one recording. The paper shows its model of Knossos.",
    );
    let gpu = timer.gpu;
    let subject = Subject::new(gpu, "builtin:terrain", lumivox_scene::builtin::terrain(1))?;
    let grid = subject.grid(if quick { 64 } else { 128 })?;
    let sunlight = Arc::new(SurfaceFunction {
        name: "bench_sunlight".to_owned(),
        text: "fn bench_sunlight(point: SurfacePoint) -> vec4f {\n    \
               let sun = normalize(vec3f(0.7, 0.6, 0.2));\n    \
               return vec4f(point.color.rgb * max(dot(point.normal, sun), 0.0), 1.0);\n}"
            .to_owned(),
        outputs: 1,
    });
    let sunlight = Channel::function("sunlight", 3, &sunlight, 0);
    let channels = [Channel::albedo(), Channel::normal(), sunlight];
    let mut voxelizer = Voxelizer::new(gpu, grid, &channels, &way("", slicing(None)).options)?;
    let mut volume = voxelizer.volume(gpu)?;
    let meshes: Vec<_> = subject.meshes.iter().collect();
    timer.submit(|e| voxelizer.record(gpu, e, &meshes, &mut volume))?;
    let (occupied, volume) = (voxelizer.read_occupancy(gpu)?, volume.read_back(gpu)?);
    let value = |name: &str| volume.channel(name).context("a channel is missing");
    let (albedo, normal, light) = (value(ALBEDO)?, value(NORMAL)?, value("sunlight")?);
    let screen = |v: Vec3| v.max(Vec3::ZERO).powf(1.0 / 2.2);
    let picture = |color: &dyn Fn(usize) -> Vec3| {
        voxel_picture(&grid, SIDE, |cell: UVec3| {
            let index = grid.index(cell);
            occupied[index].then(|| color(index))
        })
    };
    let pictures = vec![
        picture(&|_| GREY),
        picture(&|i| screen(albedo[i].truncate())),
        picture(&|i| 0.5 * normal[i].truncate() + 0.5),
        picture(&|i| screen(light[i].truncate())),
    ];
    let sheet = contact_sheet(&[("terrain", pictures)], &["occupancy", "albedo", "normals", "sunlight"]);
    report.picture("figure-1", "Channels of the terrain", &sheet)
}

/// Figure 6: what only slicing finds, and what only clipping finds.
pub(super) fn difference(
    timer: &Timer<'_>,
    subject: &Subject,
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    report.head("Figure 6: slicing against clipping (dissertation: Figure 65)");
    let grid = subject.grid(if quick { 64 } else { 128 })?;
    let mut pictures = Vec::new();
    let mut words = Vec::new();
    for limit in [Some(11), None] {
        let sliced = cells(timer, subject, grid, slicing(limit))?;
        let clipped = cells(timer, subject, grid, clipping(limit))?;
        let only = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|(a, b)| **a && !**b).count();
        let (green, red) = (only(&sliced, &clipped), only(&clipped, &sliced));
        let named = limit.map_or("without a limit".to_owned(), |l| format!("{l} vertices"));
        words.push(format!(
            "{named}, of {} cells {green} only by slicing and {red} only by clipping",
            count(&sliced).max(count(&clipped))
        ));
        let theirs = Some(33.0).filter(|_| limit.is_some() && subject.name == "Bunny" && !quick);
        let case = format!("{} {}", subject.name, grid.dims.max_element());
        report.push(number("Figure 6", case, format!("differing cells, {named}"), green + red, theirs));
        pictures.push(voxel_picture(&grid, SIDE, |cell| {
            match (sliced[grid.index(cell)], clipped[grid.index(cell)]) {
                (true, true) => Some(GREY),
                (true, false) => Some(Vec3::new(0.1, 0.75, 0.2)),
                (false, true) => Some(Vec3::new(0.9, 0.1, 0.1)),
                (false, false) => None,
            }
        }));
    }
    report.say(&format!(
        "{}. The paper has 33 of 22K at 128 cells with 11 vertices, by the rasterizer's rounding; ours ask in single precision, and differ only where a limit leaves different holes.",
        words.join("; ")
    ));
    let sheet = contact_sheet(&[("slicing and clipping", pictures)], &["11 vertices", "no limit"]);
    report.picture("figure-6", "Cells by slicing and by clipping", &sheet)
}

/// Figure 7: holes where few vertices are allowed.
pub(super) fn holes(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Figure 7: holes by limits on output vertices (dissertation: Figure 66)");
    let side = if quick { 64 } else { 256 };
    let grid = subject.grid(side)?;
    let (mut pictures, mut titles, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for (limit, theirs) in paper::HOLES {
        let theirs = Some(theirs).filter(|_| side == 256 && subject.name == "Bunny");
        let found = cells(timer, subject, grid, clipping(Some(limit)))?;
        let case = format!("{} {side}", subject.name);
        report.push(number("Figure 7", case, format!("clipping {limit}"), count(&found), theirs));
        let beside = theirs.map_or("-".to_owned(), |t| t.to_string());
        lines.push(vec![limit.to_string(), count(&found).to_string(), beside]);
        titles.push(format!("{limit} vertices, {}", thousands(count(&found) as f64)));
        pictures.push(voxel_picture(&grid, SIDE, |cell| found[grid.index(cell)].then_some(GREY)));
    }
    let whole = cells(timer, subject, grid, clipping(None))?;
    lines.push(vec!["none".to_owned(), count(&whole).to_string(), "-".to_owned()]);
    report.say(&format!("{} at {side}, clipping.", subject.title()));
    report.table(&["output vertices", "cells", "paper"].map(str::to_owned), &lines);
    let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
    let sheet = contact_sheet(&[("clipping", pictures)], &titles);
    report.picture("figure-7", "Holes by limits on output vertices", &sheet)
}
