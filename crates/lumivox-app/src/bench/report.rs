//! What a benchmark found: Markdown to read, JSON to compute with.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use image::RgbImage;
use serde::Serialize;

use super::plot::Plot;
use crate::{output, stats};

/// One number.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) figure: &'static str,
    pub(super) case: String,
    pub(super) metric: String,
    pub(super) value: f64,
    pub(super) unit: &'static str,
    /// The paper's, where it has one.
    pub(super) paper: Option<f64>,
    pub(super) note: String,
}

/// A number as the JSON has it.
#[derive(Debug, Serialize)]
struct Entry {
    #[serde(flatten)]
    row: Row,
    /// What it is in each frame of a run, rounded to six digits behind the point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    by_frame: Vec<f64>,
}

/// A benchmark's results, and the folder that they go to.
#[derive(Debug)]
pub(super) struct Report {
    folder: PathBuf,
    name: &'static str,
    text: String,
    rows: Vec<Entry>,
}

impl Report {
    /// Makes sure that the results can be written before any are measured.
    pub(super) fn new(folder: &Path, name: &'static str, title: &str) -> Result<Self> {
        let report = Self { folder: folder.to_owned(), name, text: format!("# {title}\n"), rows: Vec::new() };
        output::prepare(&report.path("md"))?;
        output::prepare(&report.path("json"))?;
        Ok(report)
    }

    fn path(&self, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", self.name))
    }

    /// A paragraph.
    pub(super) fn say(&mut self, text: &str) {
        let _ = writeln!(self.text, "\n{text}");
    }

    /// A heading.
    pub(super) fn head(&mut self, text: &str) {
        let _ = writeln!(self.text, "\n## {text}");
        eprintln!("lumivox bench {}: {text}", self.name);
    }

    /// A number, for the JSON.
    pub(super) fn push(&mut self, row: Row) {
        self.push_frames(row, &[]);
    }

    /// The same with what it is made of, frame by frame.
    pub(super) fn push_frames(&mut self, row: Row, frames: &[f64]) {
        if row.value.is_finite() {
            let by_frame = frames.iter().map(|v| (v * 1e6).round() / 1e6).collect();
            self.rows.push(Entry { row, by_frame });
        }
    }

    /// A table, whose first column is text.
    pub(super) fn table(&mut self, header: &[String], lines: &[Vec<String>]) {
        let rule: Vec<&str> = (0..header.len()).map(|n| if n == 0 { "---" } else { "---:" }).collect();
        let _ = writeln!(self.text, "\n| {} |\n| {} |", header.join(" | "), rule.join(" | "));
        for line in lines {
            let _ = writeln!(self.text, "| {} |", line.join(" | "));
        }
    }

    /// A plot in a file of its own.
    pub(super) fn plot(&mut self, stem: &str, plot: &Plot) -> Result<()> {
        let file = format!("{}-{stem}.svg", self.name);
        output::write_text(&self.folder.join(&file), &plot.svg())?;
        self.say(&format!("![{}]({file})", plot.title));
        Ok(())
    }

    /// A picture in a file of its own.
    pub(super) fn picture(&mut self, stem: &str, what: &str, picture: &RgbImage) -> Result<()> {
        let file = format!("{}-{stem}.png", self.name);
        output::write_png(&self.folder.join(&file), picture)?;
        self.say(&format!("![{what}]({file})"));
        Ok(())
    }

    /// Writes all that is not written yet.
    pub(super) fn write(&self) -> Result<()> {
        output::write_text(&self.path("md"), &self.text)?;
        stats::write(&self.path("json"), &self.rows)?;
        eprintln!("lumivox: {}", self.path("md").display());
        Ok(())
    }
}

/// Milliseconds as they are read: three digits.
pub(super) fn ms(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// Counts as the papers print them.
pub(super) fn thousands(count: f64) -> String {
    match count {
        c if c < 1e3 => format!("{c:.0}"),
        c if c < 1e5 => format!("{:.1}K", c / 1e3),
        c => format!("{:.0}K", c / 1e3),
    }
}
