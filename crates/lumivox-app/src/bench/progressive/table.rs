//! Table 6.1 (dissertation: Table 8): progressive voxelization beside the voxelization of triangles.

use anyhow::Result;
use glam::UVec2;
use lumivox::progressive::CleanupRule;
use lumivox::voxelize::{Coverage, Options, Voxelizer};

use super::cost::{row, view_of};
use super::forms::measure_bricks;
use super::rig::Rig;
use super::slabs::one_channel;
use crate::bench::models::{Subject, ball};
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::Timer;

/// What Table 8 prints of a scene at so many cells: VoxelPipe, geometry slicing, G-buffers and progressive voxelization.
struct Printed {
    scene: &'static str,
    cells: u32,
    times: [Option<f64>; 4],
}

const fn printed(scene: &'static str, cells: u32, times: [f64; 4]) -> Printed {
    let mut found = [None; 4];
    let mut n = 0;
    while n < 4 {
        if times[n] > 0.0 {
            found[n] = Some(times[n]);
        }
        n += 1;
    }
    Printed { scene, cells, times: found }
}

/// Zero where nothing is printed; G-buffers are printed once a scene.
const TABLE_8: [Printed; 9] = [
    printed("Conference", 128, [5.1, 31.73, 3.2, 0.28]),
    printed("Conference", 512, [12.5, 64.67, 3.2, 4.93]),
    printed("Dragon", 128, [7.5, 198.33, 59.0, 0.18]),
    printed("Dragon", 512, [11.2, 0.0, 59.0, 6.98]),
    printed("Turbine Blade", 128, [11.9, 265.7, 121.0, 0.14]),
    printed("Turbine Blade", 512, [15.2, 0.0, 121.0, 5.37]),
    printed("Hairball", 128, [23.0, 436.2, 198.0, 0.33]),
    printed("Hairball", 320, [0.0, 0.0, 198.0, 4.04]),
    printed("Hairball", 512, [58.4, 0.0, 198.0, 0.0]),
];

pub(super) fn run(timer: &Timer<'_>, subjects: &[&Subject], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 6.1: beside the voxelization of triangles");
    let sides: &[u32] = if quick { &[64] } else { &[128, 512] };
    report.say(
        "Milliseconds, in parentheses as Table 8 prints them; scenes with these alone are not at hand. *VP* is VoxelPipe there, one number a cell, on another \
         device and scaled by 1.5; *GS* its geometry slicing of four numbers. *Triangles* is our direct voxelization, exact, of which cells are \
         occupied. *G-buffer* is the rendering of 512 x 512 texels at 128 cells and of 1024 x 1024 at 512, *progressive* cleanup by footprint \
         and injection of two points for each cell along the side, in bricks, one target of four numbers, and *total* both together.",
    );
    let heavy = if quick { 40_000 } else { 3_000_000 };
    let tessellated = Subject::new(timer.gpu, "Tessellated ball", ball(heavy))?;
    let mut lines = Vec::new();
    for subject in subjects.iter().copied().chain([&tessellated]) {
        for &side in sides {
            let ours = match measure(timer, subject, side) {
                Ok(ours) => Some(ours),
                // What is measured at fewer cells stands without it.
                Err(error) if side > sides[0] => {
                    report.say(&format!("**Left out:** {} at {side} cells: {error:#}.", subject.name));
                    None
                }
                Err(error) => return Err(error),
            };
            let paper = TABLE_8.iter().find(|p| p.scene == subject.name && p.cells == side);
            told(&subject.name, side, paper.map_or([None; 4], |p| p.times), ours, report);
            lines.push(line(subject.title(), side, paper, ours));
        }
    }
    let is_there = |p: &Printed| subjects.iter().any(|s| s.name == p.scene) && sides.contains(&p.cells);
    for paper in TABLE_8.iter().filter(|p| !is_there(p)) {
        told(paper.scene, paper.cells, paper.times, None, report);
        lines.push(line(paper.scene.to_owned(), paper.cells, Some(paper), None));
    }
    let header = ["scene", "cells", "(VP)", "triangles (GS)", "G-buffer", "progressive", "total"];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

/// Milliseconds of triangles, G-buffer and progressive voxelization.
fn measure(timer: &Timer<'_>, subject: &Subject, side: u32) -> Result<[f64; 3]> {
    let size = UVec2::splat(if side > 256 { 1024 } else { 512 });
    let grid = subject.grid(side)?;
    let options = Options { coverage: Coverage::Exact, ..Options::default() };
    let mut voxelizer = Voxelizer::new(timer.gpu, grid, &[], &options)?;
    let mut volume = voxelizer.volume(timer.gpu)?;
    let meshes: Vec<_> = subject.meshes.iter().collect();
    let of_triangles =
        timer.median(|| timer.submit(|e| voxelizer.record(timer.gpu, e, &meshes, &mut volume)))?.ms;
    let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
    rig.look(timer.gpu, view_of(subject));
    let gbuffer = timer.median(|| rig.draw(timer))?.ms;
    let (points, rule) = (UVec2::splat(2 * side).min(size), CleanupRule::Footprint);
    let (progressive, _) = measure_bricks(timer, &mut rig, grid, &one_channel(), points, rule, &[])?;
    Ok([of_triangles, gbuffer, progressive])
}

/// The sum of what is printed of G-buffers and progressive voxelization.
fn printed_total(paper: [Option<f64>; 4]) -> Option<f64> {
    Some(paper[2]? + paper[3]?)
}

/// The numbers, for the JSON: ours with what is printed beside them, and what is printed alone.
fn told(scene: &str, side: u32, paper: [Option<f64>; 4], ours: Option<[f64; 3]>, report: &mut Report) {
    let case = format!("{scene}, {side}");
    let [voxel_pipe, slicing, gbuffer, progressive] = paper;
    let total = printed_total(paper);
    if let Some(ours) = ours {
        for (metric, value, paper) in [
            ("triangles", ours[0], slicing),
            ("G-buffer", ours[1], gbuffer),
            ("progressive", ours[2], progressive),
            ("total", ours[1] + ours[2], total),
        ] {
            report.push(Row { paper, ..row("Table 6.1", case.clone(), metric, value, "ms", "") });
        }
    }
    for (metric, value) in [
        ("VP, as printed", voxel_pipe),
        ("GS, as printed", slicing),
        ("G-buffer, as printed", gbuffer),
        ("progressive, as printed", progressive),
    ] {
        let Some(value) = value else { continue };
        let note = "Table 8; not measured here";
        let paper = Some(value);
        report.push(Row { paper, ..row("Table 6.1", case.clone(), metric, value, "ms", note) });
    }
}

fn line(scene: String, side: u32, paper: Option<&Printed>, ours: Option<[f64; 3]>) -> Vec<String> {
    let paper = paper.map_or([None; 4], |p| p.times);
    let cell = |value: Option<f64>, paper: Option<f64>| {
        let both = [value.map(ms), paper.map(|p| format!("({})", (1e4 * p).round() / 1e4))];
        both.into_iter().flatten().collect::<Vec<_>>().join(" ")
    };
    let [triangles, gbuffer, progressive] = ours.map_or([None; 3], |o| o.map(Some));
    let total = ours.map(|o| o[1] + o[2]);
    vec![
        scene,
        side.to_string(),
        cell(None, paper[0]),
        cell(triangles, paper[1]),
        cell(gbuffer, paper[2]),
        cell(progressive, paper[3]),
        cell(total, printed_total(paper)),
    ]
}
