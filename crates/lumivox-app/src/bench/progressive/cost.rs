//! Table 6.1 (dissertation: Table 8), and cost against grids, triangles and bytes.

use anyhow::Result;
use glam::{UVec2, Vec3};
use lumivox::core::{Grid, View};
use lumivox::progressive::{AttributeChannel, AttributeKind, CleanupRule};
use lumivox::voxelize::{Coverage, Options, Voxelizer};

use super::forms::{Dense, measure_bricks};
use super::rig::{Rig, orbit, three_channels};
use super::storage;
use crate::bench::models::{Subject, ball};
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::Timer;

/// Views that fill a volume before it is measured.
const BEFORE: u32 = 3;

/// Runs all of it.
pub(super) fn run(
    timer: &Timer<'_>,
    bodies: &[Subject],
    others: &[Subject],
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    if let Some(body) = bodies.last() {
        grids(timer, body, quick, report)?;
        report.write()?;
    }
    if let Some(hall) = others.iter().find(|s| s.name == "Sponza" || s.name == "builtin:atrium") {
        storage::figure_6_8(timer, hall, quick, report)?;
        report.write()?;
    }
    let of_table: Vec<_> =
        bodies.iter().chain(others).filter(|s| s.name != "Sponza" && (quick || s.name != "Bunny")).collect();
    table_6_1(timer, &of_table, quick, report)?;
    report.write()?;
    triangles(timer, quick, report)
}

pub(super) fn row(
    figure: &'static str,
    case: String,
    metric: &str,
    value: f64,
    unit: &'static str,
    note: &str,
) -> Row {
    Row { figure, case, metric: metric.to_owned(), value, unit, paper: None, note: note.to_owned() }
}

/// A view that shows most of a model, from within where it is a building.
pub(super) fn view_of(subject: &Subject) -> View {
    if subject.name == "Sponza" {
        let (eye, target) = (Vec3::new(-11.0, 1.8, 0.6), Vec3::new(6.0, 4.2, -1.2));
        return View::perspective(eye, target, Vec3::Y, 1.05, 1.0, 0.1, 60.0).with_reversed_depth();
    }
    match subject.scene.cameras.first() {
        Some(c) => {
            View::perspective(c.eye, c.target, c.up, c.fov_y, 1.0, 0.05, 1.5 * subject.bounds.size().length())
                .with_reversed_depth()
        }
        None => orbit(&subject.bounds, 5)[0],
    }
}

/// Cost against the side of the grid, dense and in bricks, and bytes of the volume.
fn grids(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against the grid's side");
    let sides: &[u32] = if quick { &[32, 64, 128] } else { &[64, 128, 256, 512] };
    let size = UVec2::splat(512);
    report.say(&format!(
        "{}: cleanup by footprint and injection of one view of {} x {} texels, all injected, into a volume that {BEFORE} other views have \
         filled; three channels of four numbers. *Dense* goes over all cells, in slabs of layers where its sums do not fit one binding; \
         its points are counted once. Milliseconds of a frame, and its share of reads and writes of the volume in megabytes: counted for the \
         papers' twelve textures at half floats (cleanup reads and writes four, four more are cleared and read to be merged: 128 bytes a \
         cell; twice that at floats), for the dense form (cleanup 48 bytes a cell, sums 44), and for bricks by what a frame did.",
        subject.title(),
        size.x,
        size.y,
    ));
    let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
    let views = orbit(&subject.bounds, BEFORE + 1);
    let mut lines = Vec::new();
    let (mut of_dense, mut of_bricks) = (Vec::new(), Vec::new());
    for &side in sides {
        let grid = subject.grid(side)?;
        rig.look(timer.gpu, views[0]);
        let before = &views[1..=BEFORE as usize];
        let rule = CleanupRule::Footprint;
        let dense = Dense::measure(timer, &mut rig, grid, size, rule, before)?;
        let (time, happened) = measure_bricks(timer, &mut rig, grid, &three_channels(), size, rule, before)?;
        let cells = grid.cell_count() as f64;
        let [papers, ours, bricks] = [128.0 * cells, 92.0 * cells, happened.bytes as f64].map(|b| b / 1e6);
        let ratio = dense.total() / time;
        let case = format!("{}, {side}", subject.name);
        let figure = "cost against the grid";
        for (metric, value, unit) in [
            ("dense", dense.total(), "ms"),
            ("bricks", time, "ms"),
            ("dense / bricks", ratio, "1"),
            ("bytes, papers' layout at half floats", papers, "MB"),
            ("bytes, papers' layout at floats", 2.0 * papers, "MB"),
            ("bytes, dense", ours, "MB"),
            ("bytes, bricks", bricks, "MB"),
            ("bytes per cell, bricks", 1e6 * bricks / cells, "B"),
            ("papers' bytes at half floats / bricks", papers / bricks, "1"),
        ] {
            report.push(row(
                figure,
                case.clone(),
                metric,
                value,
                unit,
                &format!("{} slabs dense", dense.slabs),
            ));
        }
        of_dense.push((f64::from(side), dense.total()));
        of_bricks.push((f64::from(side), time));
        let times = [dense.total(), time].map(ms);
        let bytes = [papers, ours, bricks].map(|b| format!("{b:.1}"));
        let mut line = vec![side.to_string(), happened.occupied.to_string(), dense.slabs.to_string()];
        line.extend(times);
        line.push(format!("{ratio:.1}"));
        line.extend(bytes);
        line.push(format!("{:.2}", 1e6 * bricks / cells));
        lines.push(line);
    }
    let header = [
        "cells",
        "occupied",
        "slabs",
        "dense ms",
        "bricks ms",
        "dense / bricks",
        "papers MB",
        "dense MB",
        "bricks MB",
        "bricks B per cell",
    ];
    report.table(&header.map(str::to_owned), &lines);
    let series = [("dense", of_dense), ("bricks", of_bricks)];
    let series = series.map(|(name, points)| Series { name: name.to_owned(), points }).to_vec();
    let title = format!("{}: cleanup and injection", subject.name);
    report.plot("grid", &Plot { title, x: "cells along the longest side", y: "milliseconds", series })
}

/// What Table 8 prints of its scenes at 128 cells: VoxelPipe, geometry slicing, G-buffers and progressive voxelization.
const TABLE_8: [(&str, [f64; 4]); 2] =
    [("Conference", [5.1, 31.73, 3.2, 0.28]), ("Dragon", [7.5, 198.33, 59.0, 0.18])];

/// Progressive voxelization beside the voxelization of triangles.
fn table_6_1(timer: &Timer<'_>, subjects: &[&Subject], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 6.1: beside the voxelization of triangles");
    let side = if quick { 64 } else { 128 };
    let size = UVec2::splat(512);
    report.say(&format!(
        "{side} cells; milliseconds, in parentheses as Table 8 prints them for 128. VP is VoxelPipe there, on another device and scaled by \
         1.5. *Triangles* is our direct voxelization, exact, of a normal; *G-buffer* the rendering of {} x {} texels, and *progressive* \
         cleanup by footprint and injection of two points for each cell along the side, in bricks, one channel.",
        size.x, size.y
    ));
    let heavy = if quick { 40_000 } else { 3_000_000 };
    let tessellated = Subject::new(timer.gpu, "Tessellated ball", ball(heavy))?;
    let mut lines = Vec::new();
    for subject in subjects.iter().copied().chain([&tessellated]) {
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
        let one = [AttributeChannel::new("normal", AttributeKind::Normal)];
        let points = UVec2::splat(2 * side).min(size);
        let (ours, _) = measure_bricks(timer, &mut rig, grid, &one, points, CleanupRule::Footprint, &[])?;
        let paper = TABLE_8.iter().find(|(name, _)| *name == subject.name && side == 128).map(|(_, p)| *p);
        let case = format!("{}, {side}", subject.name);
        for (metric, value, n) in
            [("triangles", of_triangles, 1), ("G-buffer", gbuffer, 2), ("progressive", ours, 3)]
        {
            let paper = paper.map(|p| p[n]);
            report.push(Row { paper, ..row("Table 6.1", case.clone(), metric, value, "ms", "") });
        }
        let cell =
            |value: f64, n: usize| ms(value) + &paper.map_or(String::new(), |p| format!(" ({})", p[n]));
        lines.push(vec![
            subject.title(),
            paper.map_or(String::new(), |p| format!("({})", p[0])),
            cell(of_triangles, 1),
            cell(gbuffer, 2),
            cell(ours, 3),
        ]);
    }
    let header = ["scene", "VP", "triangles", "G-buffer", "progressive"];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

/// The same view of a ball of more and more triangles.
fn triangles(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against triangles");
    let (side, size) = (128, UVec2::splat(512));
    report.say(&format!(
        "A bumpy ball of more and more triangles at {side} cells, one view of {} x {} texels, all injected, three channels; milliseconds \
         of cleanup and injection in bricks, without the G-buffer.",
        size.x, size.y
    ));
    let counts: &[u32] = if quick { &[10_000, 40_000] } else { &[10_000, 100_000, 1_000_000, 10_000_000] };
    let mut lines = Vec::new();
    for &count in counts {
        let scene = ball(count);
        let bounds = scene.bounds();
        let mut rig = Rig::new(timer.gpu, &scene, size)?;
        rig.look(timer.gpu, orbit(&bounds, 5)[0]);
        let grid = Grid::fit(&bounds, side)?;
        let rule = CleanupRule::Footprint;
        let (time, happened) = measure_bricks(timer, &mut rig, grid, &three_channels(), size, rule, &[])?;
        let case = scene.triangle_count().to_string();
        report.push(row("triangles", case.clone(), "progressive", time, "ms", ""));
        lines.push(vec![case, ms(time), happened.occupied.to_string()]);
    }
    report.table(&["triangles", "ms", "occupied"].map(str::to_owned), &lines);
    Ok(())
}
