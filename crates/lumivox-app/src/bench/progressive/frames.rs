//! What is measured in each frame of a run, for plots.

use anyhow::Result;

use crate::bench::plot::{Plot, Series};
use crate::bench::report::Report;

/// Shares of one kind, of several forms, frame by frame.
pub(super) struct Frames {
    metric: &'static str,
    y: &'static str,
    stem: String,
    series: Vec<Series>,
}

impl Frames {
    pub(super) fn new(metric: &'static str, y: &'static str, stem: &str) -> Self {
        Self { metric, y, stem: stem.to_owned(), series: Vec::new() }
    }

    /// A form's shares from the first frame on.
    pub(super) fn add(&mut self, name: &str, shares: &[f64]) {
        let points = shares.iter().enumerate().map(|(n, share)| (n as f64 + 1.0, 100.0 * share));
        // A logarithmic axis has no zero.
        let points: Vec<_> = points.filter(|point| point.1 > 0.0).collect();
        if !points.is_empty() {
            self.series.push(Series { name: name.to_owned(), points });
        }
    }

    /// Draws them, if there are any.
    pub(super) fn plot(self, subject: &str, report: &mut Report) -> Result<()> {
        if self.series.is_empty() {
            return Ok(());
        }
        let title = format!("{subject}: {}", self.metric);
        report.plot(&self.stem, &Plot { title, x: "frame", y: self.y, series: self.series })
    }
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}
