//! Tables 1 to 5.

use std::sync::Arc;

use anyhow::Result;
use lumivox::core::Grid;
use lumivox::volume::Format;
use lumivox::voxelize::{Channel, Method, Rule, SurfaceFunction};

use super::{Measured, Way, clipping, measure, measure_cpu, paper, slicing, way, ways};
use crate::bench::models::Subject;
use crate::bench::report::{Report, Row, ms, thousands};
use crate::bench::timing::Timer;

/// More slices times triangles than this, and all triangles are not looked at once for each slice: minutes, on a processor.
const MAX_SLICED: u64 = 40_000_000;

fn sides(quick: bool) -> &'static [u32] {
    if quick { &[64] } else { &[64, 128, 256] }
}

fn strings<const N: usize>(texts: [&str; N]) -> Vec<String> {
    texts.map(str::to_owned).to_vec()
}

fn dims(grid: &Grid) -> String {
    let [x, y, z] = grid.dims.to_array();
    format!("{x} x {y} x {z}")
}

/// A time beside the paper's.
fn beside(value: f64, paper: Option<f64>) -> String {
    paper.map_or_else(|| ms(value), |p| format!("{} ({})", ms(value), ms(p)))
}

fn cells_beside(cells: u64, paper: Option<f64>) -> String {
    let ours = thousands(cells as f64);
    paper.map_or_else(|| ours.clone(), |p| format!("{ours} ({})", thousands(p)))
}

fn push(
    report: &mut Report,
    figure: &'static str,
    case: &str,
    metric: &str,
    found: &Measured,
    paper: [Option<f64>; 2],
) {
    let mut note = format!("median of {}", found.time.runs);
    if found.passes > 1 {
        note += &format!(", {} passes over the triangles", found.passes);
    }
    let row = |metric: &str, value, unit, paper| Row {
        figure,
        case: case.to_owned(),
        metric: metric.to_owned(),
        value,
        unit,
        paper,
        note: note.clone(),
    };
    report.push(row(metric, found.time.ms, "ms", paper[0]));
    report.push(row(&format!("{metric}, cells"), found.cells as f64, "cells", paper[1]));
}

/// Table 1: both methods by their limits on output vertices.
pub(super) fn limits(
    timer: &Timer<'_>,
    subjects: &[Subject],
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    report.head("Table 1: limits on output vertices (dissertation: Table 3)");
    report.say("Milliseconds for occupancy, which is a bit for a cell here and a half float in the paper.");
    let sides = if quick { &[64][..] } else { &[64, 128, 256, 512] };
    // Two of the papers' models, what stands for a third, or their stand-ins.
    for subject in subjects.iter().take(3) {
        report.say(&subject.title());
        let mut header = strings(["grid"]);
        let named = |name: &str, limit: Option<u32>| limit.map_or(name.to_owned(), |l| format!("{name} {l}"));
        let limited = |all: [u32; 4]| all.map(Some).into_iter().chain([None]);
        let both: Vec<(String, Method, usize)> = limited(paper::SLICING_VERTICES)
            .enumerate()
            .map(|(n, limit)| (named("slicing", limit), slicing(limit), n))
            .chain(
                limited(paper::CLIPPING_VERTICES)
                    .enumerate()
                    .map(|(n, limit)| (named("clipping", limit), clipping(limit), 5 + n)),
            )
            .collect();
        header.extend(both.iter().map(|b| b.0.clone()));
        header.push("cells".to_owned());
        let mut lines = Vec::new();
        for &side in sides {
            // The largest grids for the papers' own models alone.
            if side == 512 && paper::limits(&subject.name, side).is_none() {
                continue;
            }
            let grid = subject.grid(side)?;
            let printed = paper::limits(&subject.name, side);
            let case = format!("{} {side}", subject.name);
            let mut line = vec![dims(&grid)];
            let mut cells = 0;
            for (name, method, n) in &both {
                let is_asked = !quick || matches!(n, 0 | 4 | 5 | 9);
                if !is_asked {
                    line.push("-".to_owned());
                    continue;
                }
                let found = measure(timer, subject, grid, &[], &way("", *method).options)?;
                let theirs =
                    printed.and_then(|p| if *n < 5 { p.slicing.get(*n) } else { p.clipping.get(n - 5) });
                let whole = if matches!(n, 4 | 9) { printed.and_then(|p| p.cells) } else { None };
                push(report, "Table 1", &case, name, &found, [theirs.copied(), whole]);
                line.push(beside(found.time.ms, theirs.copied()));
                cells = found.cells;
            }
            line.push(cells_beside(cells, printed.and_then(|p| p.cells)));
            lines.push(line);
        }
        report.table(&header, &lines);
    }
    Ok(())
}

/// Four-component channels that take the largest value, and cost nothing to compute.
fn four_channels(count: u32, format: Format) -> Vec<Channel> {
    let function = Arc::new(SurfaceFunction {
        name: "bench_target".to_owned(),
        text: "fn bench_target(point: SurfacePoint) -> vec4f { return vec4f(1.0, 0.5, 0.25, 1.0); }"
            .to_owned(),
        outputs: 1,
    });
    let channel =
        |n| Channel::function(&format!("target {n}"), 4, &function, 0).rule(Rule::Maximum).format(format);
    (0..count).map(channel).collect()
}

/// A measurement that may not fit the device.
fn tried(found: Result<Measured>, report: &mut Report, what: &str) -> Option<Measured> {
    match found {
        Ok(found) => Some(found),
        Err(error) => {
            report.say(&format!("{what}: {error:#}."));
            None
        }
    }
}

/// Table 2: one to eight targets of four floats, of which the paper has three.
pub(super) fn targets(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 2: one to eight targets of four floats (dissertation: Table 4)");
    report.say(&format!(
        "{}, channels of four 32-bit floats with the rule Maximum, nothing computed; eight are 1024 bits a cell. The paper has one to three.",
        subject.title()
    ));
    let methods = [
        way("slicing 15", slicing(Some(15))),
        way("clipping 9", clipping(Some(9))),
        super::direct("direct, sampled", lumivox::voxelize::Coverage::Sampled),
    ];
    let counts: &[u32] = if quick { &[1, 3, 8] } else { &[1, 2, 3, 4, 6, 8] };
    let header = ["grid", "method"].map(str::to_owned).into_iter().chain(counts.iter().map(u32::to_string));
    let header: Vec<String> = header.collect();
    let mut lines = Vec::new();
    for (side, slicing_ms, clipping_ms) in paper::TARGETS.into_iter().filter(|t| sides(quick).contains(&t.0))
    {
        let grid = subject.grid(side)?;
        for (m, method) in methods.iter().enumerate() {
            let mut line = vec![dims(&grid), method.name.to_owned()];
            let printed = [Some(slicing_ms), Some(clipping_ms), None][m].filter(|_| subject.name == "Bunny");
            for &n in counts {
                let theirs = printed.and_then(|times| times.get(n as usize - 1).copied());
                let found = measure(timer, subject, grid, &four_channels(n, Format::F32), &method.options);
                // What does not fit one method does not fit the next either.
                let found =
                    if m == 0 { tried(found, report, &format!("{side}, {n} targets")) } else { found.ok() };
                line.push(found.map_or("-".to_owned(), |f| beside(f.time.ms, theirs)));
                if let Some(found) = found {
                    let what = format!("{}, {n} targets", method.name);
                    push(
                        report,
                        "Table 2",
                        &format!("{} {side}", subject.name),
                        &what,
                        &found,
                        [theirs, None],
                    );
                }
            }
            lines.push(line);
        }
    }
    report.table(&header, &lines);
    Ok(())
}

/// Table 3: other approaches, and our own.
pub(super) fn approaches(
    timer: &Timer<'_>,
    subjects: &[Subject],
    quick: bool,
    report: &mut Report,
) -> Result<()> {
    report.head("Table 3: other approaches (dissertation: Table 5)");
    report.say(
        "Milliseconds and cells of occupancy. Slice per pass is the paper's Fang et al., the slicemap from three directions its Eisemann et al., \
         whose cells the paper takes on a cubic grid; ours are on the same grid as all others.",
    );
    let fang = way("slice per pass", Method::SlicePerPass);
    for subject in subjects {
        let all: Vec<Way> = std::iter::once(fang).chain(ways()).collect();
        let mut header = vec![subject.title()];
        header.extend(sides(quick).iter().map(ToString::to_string));
        let mut lines = Vec::new();
        for way in &all {
            let mut line = strings([way.name]);
            for &side in sides(quick) {
                let grid = subject.grid(side)?;
                let slices = u64::from(grid.dims.element_sum());
                let looks = slices * subject.scene.triangle_count();
                if way.name == fang.name && looks > if quick { MAX_SLICED / 3 } else { MAX_SLICED } {
                    line.push(format!("- ({} M triangles to look at)", looks / 1_000_000));
                    continue;
                }
                let found = measure(timer, subject, grid, &[], &way.options)?;
                let printed = paper::approaches(&subject.name, side);
                let theirs = match way.name {
                    "slice per pass" => printed.map(|p| [p.2.0, p.2.1]),
                    "slicemap, three directions" => printed.map(|p| [Some(p.3.0), p.3.1]),
                    _ => None,
                };
                let theirs = theirs.unwrap_or_default();
                push(report, "Table 3", &format!("{} {side}", subject.name), way.name, &found, theirs);
                line.push(format!(
                    "{} / {}",
                    beside(found.time.ms, theirs[0]),
                    cells_beside(found.cells, theirs[1])
                ));
            }
            lines.push(line);
        }
        for (name, coverage) in [
            ("CPU, exact", lumivox_voxels::Coverage::Exact),
            ("CPU, sampled", lumivox_voxels::Coverage::Sampled),
        ] {
            let mut line = strings([name]);
            for &side in sides(quick) {
                let found = measure_cpu(timer, subject, subject.grid(side)?, coverage)?;
                push(report, "Table 3", &format!("{} {side}", subject.name), name, &found, [None; 2]);
                line.push(format!("{} / {}", ms(found.time.ms), thousands(found.cells as f64)));
            }
            lines.push(line);
        }
        report.table(&header, &lines);
    }
    Ok(())
}

/// Table 4: the paper's devices and this one.
pub(super) fn devices(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 4: devices (dissertation: Table 6)");
    let side = if quick { 64 } else { 128 };
    let grid = subject.grid(side)?;
    report.say(&format!("{} at {}; the paper's devices at 106 x 128 x 82.", subject.title(), dims(&grid)));
    let device = timer.gpu.device.adapter_info().name;
    let mut line = vec![device];
    for (name, method) in [("slicing 15", slicing(Some(15))), ("clipping 9", clipping(Some(9)))] {
        let found = measure(timer, subject, grid, &[], &way(name, method).options)?;
        push(report, "Table 4", &format!("{} {side}", subject.name), name, &found, [None; 2]);
        line.push(ms(found.time.ms));
    }
    let theirs =
        paper::DEVICES.map(|(name, slicing, clipping)| vec![name.to_owned(), ms(slicing), ms(clipping)]);
    let lines: Vec<_> = theirs.into_iter().chain([line]).collect();
    report.table(&strings(["device", "slicing 15", "clipping 9"]), &lines);
    Ok(())
}

/// Table 5: half floats and floats.
pub(super) fn formats(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 5: half floats and floats (dissertation: Table 7)");
    report.say(&format!(
        "{}, slicing with 15 vertices, one channel of four numbers. Sums are the same for both; formats differ in what is resolved to.",
        subject.title()
    ));
    let mut lines = Vec::new();
    for (side, half, float) in paper::FORMATS.into_iter().filter(|f| sides(quick).contains(&f.0)) {
        let grid = subject.grid(side)?;
        let mut line = vec![dims(&grid)];
        for (name, format, theirs) in [("half floats", Format::F16, half), ("floats", Format::F32, float)] {
            let theirs = Some(theirs).filter(|_| subject.name == "Bunny");
            let options = way("slicing 15", slicing(Some(15))).options;
            let found = measure(timer, subject, grid, &four_channels(1, format), &options);
            let found = tried(found, report, &format!("{side}, {name}"));
            line.push(found.map_or("-".to_owned(), |f| beside(f.time.ms, theirs)));
            if let Some(found) = found {
                push(report, "Table 5", &format!("{} {side}", subject.name), name, &found, [theirs, None]);
            }
        }
        lines.push(line);
    }
    report.table(&strings(["grid", "half floats", "floats"]), &lines);
    Ok(())
}
