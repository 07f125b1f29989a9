//! The numbers as a table and as JSON.

use std::io::Write;

use anyhow::Result;
use lumivox_scene::{Camera, ImportReport};
use serde::Serialize;

use super::measure::Comparison;
use super::voxels::VoxelComparison;
use crate::stats::{AdapterStats, StageStats};

/// Everything that `compare.json` holds.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) scene: String,
    pub(crate) adapter: AdapterStats,
    pub(crate) size: [u32; 2],
    /// Points to a pixel, along each side.
    pub(crate) antialias: u32,
    pub(crate) camera: CameraStats,
    pub(crate) time_s: f32,
    pub(crate) triangles: u64,
    pub(crate) lights: usize,
    pub(crate) sky: [f32; 3],
    pub(crate) grid: [u32; 3],
    pub(crate) cell_size_m: f32,
    pub(crate) voxelizer: String,
    pub(crate) gi: String,
    pub(crate) persistence: f32,
    pub(crate) shadow_size: u32,
    pub(crate) area_samples: u32,
    pub(crate) frames: u32,
    pub(crate) iterations: u32,
    pub(crate) settled: bool,
    pub(crate) reference: ReferenceStats,
    pub(crate) foreground: ForegroundStats,
    pub(crate) comparisons: Vec<Comparison>,
    pub(crate) voxels: Option<VoxelComparison>,
    /// Why there are no voxels to compare.
    pub(crate) voxels_note: Option<String>,
    pub(crate) load_ms: f64,
    pub(crate) render_ms: f64,
    pub(crate) voxels_ms: f64,
    pub(crate) total_ms: f64,
    pub(crate) stages: Vec<StageStats>,
    #[serde(flatten)]
    pub(crate) import: ImportReport,
}

#[derive(Debug, Serialize)]
pub(crate) struct CameraStats {
    eye: [f32; 3],
    target: [f32; 3],
    up: [f32; 3],
    fov_y_deg: f32,
}

impl From<&Camera> for CameraStats {
    fn from(camera: &Camera) -> Self {
        Self {
            eye: camera.eye.into(),
            target: camera.target.into(),
            up: camera.up.into(),
            fov_y_deg: camera.fov_y.to_degrees(),
        }
    }
}

/// What ours was held against.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum ReferenceStats {
    PathTracer {
        samples: u32,
        seconds: f64,
        seed: u64,
        max_samples: u32,
        max_seconds: u32,
        /// Of all comparisons.
        noise_is_low: bool,
    },
    Files {
        folder: String,
        /// Where its irradiance comes from.
        irradiance: &'static str,
    },
}

/// Pixels by who shows a surface there.
#[derive(Debug, Serialize)]
pub(crate) struct ForegroundStats {
    pub(crate) both: usize,
    pub(crate) only_ours: usize,
    pub(crate) only_reference: usize,
    /// Irradiance is asked of pixels with at least this albedo in all channels.
    pub(crate) min_albedo: f32,
}

impl ReferenceStats {
    /// Its name on pictures.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::PathTracer { samples, .. } => format!("path tracer, {samples} samples"),
            Self::Files { .. } => "reference".to_owned(),
        }
    }
}

impl Report {
    /// The table.
    pub(crate) fn print(&self, out: &mut impl Write) -> Result<()> {
        let [width, height] = self.size;
        writeln!(
            out,
            "{}: {width}x{height}, grid {:?}, {} triangles",
            self.scene, self.grid, self.triangles
        )?;
        match &self.reference {
            ReferenceStats::PathTracer { samples, seconds, .. } => {
                writeln!(out, "reference: path tracer, {samples} samples a pixel, {seconds:.1} s")?;
            }
            ReferenceStats::Files { folder, irradiance } => {
                writeln!(out, "reference: {folder}; its irradiance is {irradiance}")?;
            }
        }
        let f = &self.foreground;
        writeln!(
            out,
            "pixels: {} in both, {} in ours alone, {} in the reference alone",
            f.both, f.only_ours, f.only_reference
        )?;
        writeln!(
            out,
            "{:<20} {:>10} {:>8} {:>8} {:>8} {:>8} {:>7} {:>8}",
            "", "mean(R)", "ratio", "NRMSE", "trimmed", "low", "FLIP", "noise"
        )?;
        for c in &self.comparisons {
            write!(out, "{:<20} {:>10.5}", format!("{} {}", c.layer, c.quantity), c.mean_reference)?;
            match &c.note {
                Some(note) => writeln!(out, " not compared: {note}; mean of ours {:.5}", c.mean_ours)?,
                None => writeln!(
                    out,
                    " {:>8} {:>8} {:>8} {:>8} {:>7} {:>8}",
                    number(c.mean_ratio),
                    percent(c.nrmse),
                    percent(c.trimmed),
                    percent(c.low_frequency),
                    number(c.flip),
                    noise(c)
                )?,
            }
        }
        match (&self.voxels, &self.voxels_note) {
            (Some(v), _) => writeln!(
                out,
                "voxels: {} cells; recall of {} thin cells {:.4} ({:.4} with the margin); strays outside {} exact cells: {} ({} beyond the margin of {} cells)",
                v.cells,
                v.thin_cells,
                v.recall,
                v.recall_with_margin,
                v.exact_cells,
                v.strays,
                v.strays_beyond_margin,
                v.margin_cells
            )?,
            (None, Some(note)) => writeln!(out, "voxels: not compared: {note}")?,
            (None, None) => {}
        }
        if let ReferenceStats::PathTracer { noise_is_low: false, max_samples, max_seconds, samples, .. } =
            &self.reference
        {
            let limit = if samples == max_samples {
                format!("--max-samples {max_samples}")
            } else {
                format!("--max-seconds {max_seconds}")
            };
            writeln!(
                out,
                "the noise marked ! is above a quarter of the error: {limit} ended the path tracer before it was low"
            )?;
        }
        Ok(())
    }
}

fn number(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |v| format!("{v:.4}"))
}

fn percent(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |v| format!("{:.2}%", 100.0 * v))
}

fn noise(c: &Comparison) -> String {
    match c.noise_is_low {
        Some(false) => format!("{}!", percent(c.noise)),
        _ => percent(c.noise),
    }
}
