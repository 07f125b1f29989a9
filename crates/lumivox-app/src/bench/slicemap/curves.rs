//! Cost against slices, triangles and size.

use anyhow::Result;
use glam::UVec2;
use lumivox::slicemap::{SlicemapSettings, Slicing};

use super::rates::measure;
use super::row;
use crate::bench::models::{Subject, ball};
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, ms};
use crate::bench::timing::Timer;

const WAYS: [(&str, Slicing, bool); 3] = [
    ("uniform", Slicing::Uniform, false),
    ("local", Slicing::Local, false),
    ("local, conservative", Slicing::Local, true),
];

/// Triangles that are drawn conservatively at most.
const MOST_CONSERVATIVE: u64 = 200_000;

/// What is varied.
struct Sweep {
    figure: &'static str,
    x: &'static str,
    title: String,
}

/// A table and a plot over some subjects and settings, each with its place on the axis.
fn sweep(
    timer: &Timer<'_>,
    sweep: Sweep,
    cases: &[(f64, &Subject, SlicemapSettings)],
    report: &mut Report,
) -> Result<()> {
    report.head(&format!("Cost against {}", sweep.x));
    report.say(&format!("{}; milliseconds.", sweep.title));
    let named = |(name, ..): &(&str, Slicing, bool)| Series { name: (*name).to_owned(), points: Vec::new() };
    let mut series: Vec<Series> = WAYS.iter().map(named).collect();
    let mut lines = Vec::new();
    for (x, subject, settings) in cases {
        let mut line = vec![x.to_string()];
        for ((name, slicing, conservative), series) in WAYS.into_iter().zip(&mut series) {
            // Half a minute for a number that goes with the triangles anyway.
            if conservative && subject.scene.triangle_count() > MOST_CONSERVATIVE {
                line.push("-".to_owned());
                continue;
            }
            let time = measure(timer, subject, SlicemapSettings { slicing, conservative, ..*settings })?;
            line.push(ms(time.ms));
            series.points.push((*x, time.ms));
            report.push(row(sweep.figure, x.to_string(), name, time.ms, "ms", None));
        }
        lines.push(line);
    }
    let header: Vec<String> =
        std::iter::once(sweep.x).chain(WAYS.map(|way| way.0)).map(str::to_owned).collect();
    report.table(&header, &lines);
    report.plot(sweep.figure, &Plot { title: sweep.title, x: sweep.x, y: "milliseconds", series })
}

pub(super) fn curves(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    let subject = |triangles: u32| Subject::new(timer.gpu, "Bumpy ball", ball(triangles));
    let middle = subject(100_000)?;
    let side = if quick { 256 } else { 512 };
    let usual = SlicemapSettings { size: UVec2::splat(side), ..Default::default() };
    let all: &[u32] = if quick { &[32, 512] } else { &[32, 96, 128, 256, 512, 1024] };
    // Bits of 512 x 512 columns in 1024 slices are 32 MiB.
    let slices: Vec<_> =
        all.iter().map(|&n| (f64::from(n), &middle, SlicemapSettings { slices: n, ..usual })).collect();
    let title = format!("{}, {side} x {side} columns", middle.title());
    sweep(timer, Sweep { figure: "slices", x: "slices", title }, &slices, report)?;

    let counts: &[u32] = if quick { &[10_000, 100_000] } else { &[10_000, 100_000, 1_000_000] };
    let balls = counts.iter().map(|&n| subject(n)).collect::<Result<Vec<_>>>()?;
    let triangles: Vec<_> =
        balls.iter().map(|ball| (ball.scene.triangle_count() as f64, ball, usual)).collect();
    let title = format!("Bumpy ball, {side} x {side} columns of 96 cells");
    sweep(timer, Sweep { figure: "triangles", x: "triangles", title }, &triangles, report)?;

    let sides: &[u32] = if quick { &[128, 256] } else { &[128, 256, 512, 1024] };
    let sizes: Vec<_> = sides
        .iter()
        .map(|&n| (f64::from(n), &middle, SlicemapSettings { size: UVec2::splat(n), ..usual }))
        .collect();
    let title = format!("{}, columns of 96 cells", middle.title());
    sweep(timer, Sweep { figure: "columns", x: "columns a side", title }, &sizes, report)
}
