//! Cost against the grid's side, dense and in bricks, with equal cells; and bytes of the volume.

use anyhow::Result;
use glam::UVec2;
use lumivox::core::View;
use lumivox::progressive::{CleanupRule, FrameDiagnostics};

use super::cost::row;
use super::forms::InBricks;
use super::rig::{Rig, orbit, three_channels};
use super::slabs::{Dense, Kept, Targets, one_channel};
use crate::bench::models::Subject;
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, ms, thousands};
use crate::bench::timing::Timer;

/// Views that fill a volume before it is measured.
const BEFORE: u32 = 3;
const FIGURE: &str = "cost against the grid";

/// A side of a grid with so many targets.
struct Cost {
    dense: Dense,
    bricks: f64,
    happened: FrameDiagnostics,
}

pub(super) fn run(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against the grid's side");
    let sides: &[u32] = if quick { &[32, 64, 128] } else { &[64, 128, 256, 512] };
    let size = UVec2::splat(512);
    report.say(&format!(
        "{}: cleanup by footprint and injection of one view of {} x {} texels, all injected, into a volume that {BEFORE} other views have \
         filled; one target of four numbers, the normal, and three. *Dense* goes over all cells, in slabs of layers where its sums do not fit one binding; \
         its points are counted once. Milliseconds of a frame. After the same views all cells of the grid are held against each other: \
         *different* are those that only one of the forms holds, or that they hold with other values, bit by bit. A slab has an origin of its own, \
         from which a point next to a cell's face may be rounded to its other side.",
        subject.title(),
        size.x,
        size.y,
    ));
    let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
    let views = orbit(&subject.bounds, BEFORE + 1);
    let (mut lines, mut bytes) = (Vec::new(), Vec::new());
    let names = ["dense, 1 target", "bricks, 1 target", "dense, 3 targets", "bricks, 3 targets"];
    let mut series = names.map(|name| Series { name: name.to_owned(), points: Vec::new() });
    for &side in sides {
        for (n, (targets, count)) in [(Targets::One, 1), (Targets::Three, 3)].into_iter().enumerate() {
            let cost = measure(timer, &mut rig, subject, (side, size), targets, &views)?;
            series[2 * n].points.push((f64::from(side), cost.dense.total()));
            series[2 * n + 1].points.push((f64::from(side), cost.bricks));
            lines.push(told(subject, side, count, &cost, report));
            if targets == Targets::Three {
                bytes.push(traffic(subject, side, &cost, report)?);
            }
        }
    }
    let header = [
        "cells",
        "targets",
        "occupied",
        "slabs",
        "dense ms",
        "bricks ms",
        "dense / bricks",
        "compared",
        "different",
    ];
    report.table(&header.map(str::to_owned), &lines);
    for pair in series.chunks(2) {
        let grown = |s: &Series| match s.points[..] {
            [.., (_, before), (_, last)] => last / before,
            _ => f64::NAN,
        };
        report.say(&format!(
            "From {} to {} cells: {} {:.1} times as long, {} {:.1} times (a cube would be 8, a square 4).",
            sides[sides.len() - 2],
            sides[sides.len() - 1],
            pair[0].name,
            grown(&pair[0]),
            pair[1].name,
            grown(&pair[1]),
        ));
    }
    report.say(
        "Of the three targets, a frame's reads and writes of the volume in megabytes: counted for the papers' twelve textures at half floats (cleanup \
         reads and writes four, four more are cleared and read to be merged: 128 bytes a cell; twice that at floats), for the dense form \
         (cleanup 48 bytes a cell, sums 44), and for bricks by what a frame did.",
    );
    let header = ["cells", "papers MB", "dense MB", "bricks MB", "bricks B per cell", "papers / bricks"];
    report.table(&header.map(str::to_owned), &bytes);
    let title = format!("{}: cleanup and injection", subject.name);
    let series = series.to_vec();
    report.plot("grid", &Plot { title, x: "cells along the longest side", y: "milliseconds", series })
}

fn measure(
    timer: &Timer<'_>,
    rig: &mut Rig,
    subject: &Subject,
    (side, size): (u32, UVec2),
    targets: Targets,
    views: &[View],
) -> Result<Cost> {
    let (grid, rule) = (subject.grid(side)?, CleanupRule::Footprint);
    rig.look(timer.gpu, views[0]);
    let before = &views[1..=BEFORE as usize];
    let channels = if targets == Targets::One { one_channel().to_vec() } else { three_channels() };
    let in_bricks = InBricks::filled(timer, rig, grid, &channels, size, rule, before)?;
    let mut in_bricks = in_bricks.read(timer.gpu)?;
    let (bricks, happened) = in_bricks.measure(timer, rig)?;
    let kept = Kept::new(&in_bricks.cells);
    let dense = Dense::measure(timer, rig, grid, (size, rule, targets), before, Some(&kept))?;
    Ok(Cost { dense, bricks, happened })
}

/// A line of the table; its numbers go to the JSON.
fn told(subject: &Subject, side: u32, count: u32, cost: &Cost, report: &mut Report) -> Vec<String> {
    let Cost { dense, bricks, happened } = cost;
    let (ratio, compared) = (dense.total() / bricks, dense.compared);
    // Those of three targets have no word behind their names.
    let behind = if count == 1 { ", one target" } else { "" };
    for (metric, value, unit) in [
        ("dense", dense.total(), "ms"),
        ("bricks", *bricks, "ms"),
        ("dense / bricks", ratio, "1"),
        ("cells compared", compared.cells as f64, "1"),
        ("cells different", compared.different as f64, "1"),
    ] {
        let note = format!("{} slabs dense", dense.slabs);
        let case = format!("{}, {side}", subject.name);
        report.push(row(FIGURE, case, &format!("{metric}{behind}"), value, unit, &note));
    }
    let mut line: Vec<String> = [side, count, happened.occupied].map(|n| n.to_string()).to_vec();
    line.push(dense.slabs.to_string());
    line.extend([dense.total(), *bricks].map(ms));
    line.push(format!("{ratio:.1}"));
    line.push(thousands(compared.cells as f64));
    line.push(format!("{} of {}", compared.different, compared.occupied));
    line
}

/// Bytes that a frame reads and writes of three targets.
fn traffic(subject: &Subject, side: u32, cost: &Cost, report: &mut Report) -> Result<Vec<String>> {
    let cells = subject.grid(side)?.cell_count() as f64;
    let [papers, ours, bricks] = [128.0 * cells, 92.0 * cells, cost.happened.bytes as f64].map(|b| b / 1e6);
    for (metric, value, unit) in [
        ("bytes, papers' layout at half floats", papers, "MB"),
        ("bytes, papers' layout at floats", 2.0 * papers, "MB"),
        ("bytes, dense", ours, "MB"),
        ("bytes, bricks", bricks, "MB"),
        ("bytes per cell, bricks", 1e6 * bricks / cells, "B"),
        ("papers' bytes at half floats / bricks", papers / bricks, "1"),
    ] {
        report.push(row(FIGURE, format!("{}, {side}", subject.name), metric, value, unit, ""));
    }
    let mut line = vec![side.to_string()];
    line.extend([papers, ours, bricks].map(|b| format!("{b:.1}")));
    line.extend([format!("{:.2}", 1e6 * bricks / cells), format!("{:.0}", papers / bricks)]);
    Ok(line)
}
