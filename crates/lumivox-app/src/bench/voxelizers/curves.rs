//! Cost against triangles and against cells.

use anyhow::Result;
use lumivox::gpu::Buffer;
use lumivox::wgpu;

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

    /// Triangles a second of the last case, and the part of the device's bandwidth that takes, if `bytes` is what has to be read.
    fn throughput(&self, timer: &Timer<'_>, bytes: f64, report: &mut Report) -> Result<()> {
        let bandwidth = bandwidth(timer)?;
        let gb = |bytes: f64| format!("{:.1}", bytes / 1e9);
        report.say(&format!(
            "Triangles a second of the most triangles, and how much of the memory's bandwidth that is: vertices and indices read once, {} MB, beside a copy \
             from buffer to buffer at {} GB/s, read and written.",
            (bytes / 1e6).round(),
            gb(bandwidth)
        ));
        let mut lines = Vec::new();
        for series in &self.series {
            let Some(&(triangles, ms)) = series.points.last() else { continue };
            let (rate, part) = (triangles / ms / 1e3, bytes / (1e-3 * ms) / bandwidth);
            lines.push(vec![series.name.clone(), format!("{rate:.2}"), format!("{:.2} %", 1e2 * part)]);
            for (metric, value, unit) in
                [("triangles a second", rate, "M/s"), ("part of the bandwidth", part, "fraction")]
            {
                report.push(Row {
                    figure: "throughput",
                    case: format!("{}, {triangles} triangles", series.name),
                    metric: metric.to_owned(),
                    value,
                    unit,
                    paper: None,
                    note: String::new(),
                });
            }
        }
        report.table(&["method", "million triangles/s", "of the bandwidth"].map(str::to_owned), &lines);
        Ok(())
    }

    fn finish(&self, stem: &str, x: &'static str, title: String, report: &mut Report) -> Result<()> {
        let names = self.names.iter().copied();
        let header: Vec<String> = std::iter::once(x).chain(names).map(str::to_owned).collect();
        report.table(&header, &self.lines);
        report.plot(stem, &Plot { title, x, y: "milliseconds", series: self.series.clone() })
    }
}

/// Bytes a second that a copy from buffer to buffer reads and writes.
fn bandwidth(timer: &Timer<'_>) -> Result<f64> {
    const BYTES: u64 = 64 << 20;
    let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    let buffer = || Buffer::with_usage(timer.gpu, "bench/copy", BYTES, usage);
    let (from, to) = (buffer(), buffer());
    let time = timer.median(|| {
        timer.submit(|e| {
            e.copy_buffer_to_buffer(&from.raw, 0, &to.raw, 0, BYTES);
            Ok(())
        })
    })?;
    Ok(2.0 * BYTES as f64 / (1e-3 * time.ms))
}

/// A ball of more and more triangles.
pub(super) fn triangles(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Cost against triangles");
    let side = if quick { 64 } else { 128 };
    report.say(&format!("A bumpy ball, tessellated, at {side} cells; milliseconds for occupancy."));
    let counts: &[u32] =
        if quick { &[10_000, 100_000] } else { &[10_000, 40_000, 160_000, 640_000, 2_560_000, 10_240_000] };
    let mut curves = Curves::new("triangles");
    let mut bytes = 0.0;
    for &count in counts {
        let subject = Subject::new(timer.gpu, "Bumpy ball", ball(count))?;
        let of_mesh = |mesh: &lumivox_scene::Mesh| 12 * (mesh.positions.len() + mesh.indices.len());
        bytes = subject.scene.meshes.iter().map(of_mesh).sum::<usize>() as f64;
        curves.add(timer, &subject, side, subject.scene.triangle_count() as f64, report)?;
    }
    curves.finish("triangles", "triangles", format!("Bumpy ball, {side} cells"), report)?;
    curves.throughput(timer, bytes, report)
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
