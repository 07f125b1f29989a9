//! Figure 6.10, and cells that are lost again, frame by frame.

use anyhow::Result;
use glam::{UVec3, Vec3};
use lumivox::core::{Grid, TriangleView};
use lumivox_oracle::distance;

use crate::bench::models::Subject;
use crate::bench::plot::{Plot, Series};
use crate::bench::report::{Report, Row};

/// Distances after some of the frames.
#[derive(Default)]
pub(super) struct Curve {
    /// From cells to the mesh.
    points: Vec<(f64, f64)>,
    /// The larger of that and the way from the mesh to the nearest cell.
    both: Vec<(f64, f64)>,
    /// Points of the mesh.
    truth: Vec<Vec3>,
}

impl Curve {
    pub(super) fn add(
        &mut self,
        frame: usize,
        cells: &[UVec3],
        grid: &Grid,
        mesh: TriangleView<'_>,
    ) -> Result<()> {
        let diagonal = f64::from(mesh.bounds().size().length());
        if self.truth.is_empty() {
            self.truth = distance::spread(mesh, 20_000)?;
        }
        let centers: Vec<Vec3> = cells.iter().map(|c| grid.center(*c)).collect();
        if centers.is_empty() {
            return Ok(());
        }
        let frame = frame as f64 + 1.0;
        let there = distance::points_to_mesh(&centers, mesh)?.percent_of(diagonal).mean;
        let back = distance::points_to_points(&self.truth, &centers)?.percent_of(diagonal).mean;
        self.points.push((frame, there));
        self.both.push((frame, there.max(back)));
        Ok(())
    }

    pub(super) fn plot(self, subject: &Subject, side: u32, report: &mut Report) -> Result<()> {
        for (metric, points) in [("distance to the mesh", &self.points), ("distance both ways", &self.both)] {
            for (frame, value) in points {
                report.push(Row {
                    figure: "Figure 6.10",
                    case: format!("{}, {side}, frame {frame}", subject.name),
                    metric: metric.to_owned(),
                    value: *value,
                    unit: "%",
                    paper: None,
                    note: "mean, of the diagonal".to_owned(),
                });
            }
        }
        let series = vec![
            Series { name: "cells to the mesh".to_owned(), points: self.points },
            Series { name: "larger of both ways".to_owned(), points: self.both },
        ];
        let title = format!("Figure 6.10: {}, {side} cells", subject.name);
        let stem = format!("distance-{}", subject.name.to_lowercase().replace(' ', "-"));
        report.plot(&stem, &Plot { title, x: "frames", y: "mean distance, % of the diagonal", series })
    }
}

/// Cells that are lost again, frame by frame, of named runs.
pub(super) fn losses<'r>(
    subject: &Subject,
    runs: impl Iterator<Item = (String, &'r [f64])>,
    report: &mut Report,
) -> Result<()> {
    let mut series = Vec::new();
    for (name, lost) in runs.filter(|(_, lost)| !lost.is_empty()) {
        let points = lost.iter().enumerate().map(|(n, lost)| (n as f64 + 2.0, 100.0 * lost));
        // A logarithmic axis has no zero.
        series.push(Series { name, points: points.filter(|(_, lost)| *lost > 0.0).collect() });
    }
    let stem = format!("lost-{}", subject.name.to_lowercase().replace(' ', "-"));
    let title = format!("{}: cells cleared again", subject.name);
    report.plot(&stem, &Plot { title, x: "frame", y: "% of the occupied cells", series })
}
