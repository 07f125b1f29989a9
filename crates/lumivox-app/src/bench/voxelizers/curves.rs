//! Cost against triangles and against cells.

use anyhow::Result;

use super::{measure, measure_cpu, ways};
use crate::bench::models::{Subject, ball};
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row, ms};
use crate::bench::timing::{Time, Timer};

const CPU: &str = "CPU, exact";

/// A table and a plot of all ways over some cases.
struct Curves {
    figure: &'static str,
    names: Vec<&'static str>,
    lines: Vec<Vec<String>>,
    series: Vec<Series>,
}

impl Curves {
    fn new(figure: &'static str) -> Self {
        let names: Vec<_> = ways().iter().map(|w| w.name).chain([CPU]).collect();
        let series = names.iter().map(|n| Series { name: (*n).to_owned(), points: Vec::new() }).collect();
        Self { figure, names, lines: Vec::new(), series }
    }

    /// Measures all ways on one subject and grid.
    fn add(
        &mut self,
        timer: &Timer<'_>,
        subject: &Subject,
        side: u32,
        x: f64,
        report: &mut Report,
    ) -> Result<()> {
        let grid = subject.grid(side)?;
        let gpu = ways().into_iter().map(|way| Ok(measure(timer, subject, grid, &[], &way.options)?.time));
        let mut times = gpu.collect::<Result<Vec<Time>>>()?;
        times.push(measure_cpu(timer, subject, grid, lumivox_voxels::Coverage::Exact)?.time);
        let mut line = vec![x.to_string()];
        for ((name, time), series) in self.names.iter().zip(&times).zip(&mut self.series) {
            line.push(ms(time.ms));
            series.points.push((x, time.ms));
            report.push(Row {
                figure: self.figure,
                case: x.to_string(),
                metric: (*name).to_owned(),
                value: time.ms,
                unit: "ms",
                paper: None,
                note: format!(
                    "{}, {side} cells along the longest side, median of {}",
                    subject.name, time.runs
                ),
            });
        }
        self.lines.push(line);
        Ok(())
    }

    fn finish(self, stem: &str, x: &'static str, title: String, report: &mut Report) -> Result<()> {
        let header: Vec<String> = std::iter::once(x).chain(self.names).map(str::to_owned).collect();
        report.table(&header, &self.lines);
        report.plot(stem, &Plot { title, x, y: "milliseconds", series: self.series })
    }
}

/// A ball of more and more triangles.
pub(super) fn triangles(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against triangles");
    let side = if quick { 64 } else { 128 };
    report.say(&format!("A bumpy ball, tessellated, at {side} cells; milliseconds for occupancy."));
    let counts: &[u32] =
        if quick { &[10_000, 100_000] } else { &[10_000, 40_000, 160_000, 640_000, 2_560_000, 10_240_000] };
    let mut curves = Curves::new("triangles");
    for &count in counts {
        let subject = Subject::new(timer.gpu, "Bumpy ball", ball(count))?;
        curves.add(timer, &subject, side, subject.scene.triangle_count() as f64, report)?;
    }
    curves.finish("triangles", "triangles", format!("Bumpy ball, {side} cells"), report)
}

/// One model on finer and finer grids.
pub(super) fn grids(timer: &Timer<'_>, subject: &Subject, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against cells");
    report.say(&format!("{}; milliseconds for occupancy.", subject.title()));
    let sides: &[u32] = if quick { &[32, 128] } else { &[32, 64, 128, 256, 512] };
    let mut curves = Curves::new("cells");
    for &side in sides {
        curves.add(timer, subject, side, f64::from(side), report)?;
    }
    curves.finish("cells", "cells along the longest side", subject.title(), report)
}
