//! What was done, in words and as JSON.

use std::path::PathBuf;

use glam::{UVec3, Vec3};
use lumivox_scene::{ImportReport, Scene};
use lumivox_voxels::files::FileReport;
use lumivox_voxels::{Rule, SolidReport, SparseVolume};
use serde::Serialize;

use super::channel::{FORMATS, RULES};
use super::device::{DeviceStats, Made};
use crate::stats::StageStats;

/// One mesh that became a volume.
#[derive(Debug, Serialize)]
pub(super) struct VolumeStats {
    pub(super) input: String,
    pub(super) files: Vec<PathBuf>,
    pub(super) device: DeviceStats,
    pub(super) coverage: String,
    pub(super) meshes: usize,
    pub(super) textures: usize,
    pub(super) triangles: u64,
    /// Triangles whose corners are not finite where they stand.
    pub(super) skipped_triangles: u64,
    pub(super) dims: [u32; 3],
    pub(super) origin: [f32; 3],
    pub(super) cell_size_m: f32,
    /// All occupied cells.
    pub(super) voxels: u64,
    pub(super) channels: Vec<ChannelStats>,
    pub(super) volume_bytes: u64,
    pub(super) solid: Option<SolidStats>,
    /// Channels that were asked for and that the format has no place for.
    pub(super) left_out_channels: Vec<&'static str>,
    /// Largest error of a colour in a palette, in steps of 1/255.
    pub(super) color_error: Option<u8>,
    pub(super) stages: Vec<StageStats>,
    pub(super) total_ms: f64,
    /// The most memory that the program has had, where the system tells.
    pub(super) peak_memory_bytes: Option<u64>,
    #[serde(flatten)]
    pub(super) import: ImportReport,
}

/// One channel.
#[derive(Debug, Serialize)]
pub(super) struct ChannelStats {
    name: String,
    components: usize,
    format: &'static str,
    rule: Option<&'static str>,
    /// Cells that have a value; those that were filled have none.
    voxels: u64,
    /// Cells whose value is not zero.
    nonzero_voxels: u64,
}

/// What a solid fill found.
#[derive(Debug, Serialize)]
pub(super) struct SolidStats {
    filled_voxels: u64,
    boundary_edges: u64,
    hole: Option<HoleStats>,
}

#[derive(Debug, Serialize)]
struct HoleStats {
    center: [f32; 3],
    on_edge: [f32; 3],
    length_m: f64,
    edges: u64,
}

impl From<&SolidReport> for SolidStats {
    fn from(report: &SolidReport) -> Self {
        Self {
            filled_voxels: report.filled_cells,
            boundary_edges: report.boundary_edges,
            hole: report.hole.map(|hole| HoleStats {
                center: hole.center.to_array(),
                on_edge: hole.edge.to_array(),
                length_m: hole.length,
                edges: hole.edges,
            }),
        }
    }
}

impl VolumeStats {
    pub(super) fn new(input: &str, scene: &Scene, made: &Made) -> Self {
        let volume = &made.volume;
        let grid = volume.grid();
        Self {
            input: input.to_owned(),
            files: Vec::new(),
            device: made.device.clone(),
            coverage: String::new(),
            meshes: scene.meshes.len(),
            textures: scene.textures.len(),
            triangles: scene.triangle_count(),
            skipped_triangles: made.skipped_triangles,
            dims: grid.dims.to_array(),
            origin: grid.origin.to_array(),
            cell_size_m: grid.cell_size,
            voxels: volume.len(),
            channels: channels(volume),
            volume_bytes: volume.bytes(),
            solid: volume.report().solid.as_ref().map(SolidStats::from),
            left_out_channels: Vec::new(),
            color_error: None,
            stages: Vec::new(),
            total_ms: 0.0,
            peak_memory_bytes: None,
            import: scene.report.clone(),
        }
    }

    pub(super) fn add_files(&mut self, written: FileReport) {
        self.files = written.files;
        self.color_error = written.color_error;
    }
}

fn channels(volume: &SparseVolume) -> Vec<ChannelStats> {
    let occupancy = ChannelStats {
        name: "occupancy".to_owned(),
        components: 1,
        format: "u8",
        rule: None,
        voxels: volume.len(),
        nonzero_voxels: volume.len(),
    };
    let others = volume.channels().iter().map(|channel| {
        let slots = volume.surface_len() as usize;
        let format = channel.values().format();
        ChannelStats {
            name: channel.name().to_owned(),
            components: channel.components(),
            format: FORMATS.iter().find(|known| known.1 == format).map_or("", |known| known.0),
            rule: Some(rule_name(channel.rule())),
            voxels: volume.surface_len(),
            nonzero_voxels: (0..slots).filter(|&slot| channel.value(slot) != glam::Vec4::ZERO).count() as u64,
        }
    });
    std::iter::once(occupancy).chain(others).collect()
}

fn rule_name(rule: Rule) -> &'static str {
    RULES.iter().find(|known| known.1 == rule).map_or("", |known| known.0)
}

/// What a fill found, in one sentence, if there is anything to tell.
pub(super) fn solid_words(report: &SolidReport) -> Option<String> {
    let hole = report.hole?;
    let point = |point: Vec3| point.to_array().map(|v| short(v.into())).join(",");
    let holes = format!(
        "the surface is open: {} edges have one triangle only, the longest hole is {} m around with its middle at {} and an edge at {}",
        report.boundary_edges,
        short(hole.length),
        point(hole.center),
        point(hole.edge)
    );
    Some(match report.filled_cells {
        0 => format!("{holes}; the outside leaks in and nothing was filled"),
        n => format!("{holes}; {} were enclosed nevertheless and filled", count(n, "voxel")),
    })
}

/// Four digits that matter.
fn short(number: f64) -> String {
    let places = if number == 0.0 { 0.0 } else { (3.0 - number.abs().log10().floor()).clamp(0.0, 12.0) };
    let text = format!("{number:.*}", places as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// `1 voxel`, `1,234 voxels`.
pub(super) fn count(number: u64, what: &str) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    format!("{text} {what}{}", if number == 1 { "" } else { "s" })
}

/// `8 x 9 x 10`.
pub(super) fn sides(dims: UVec3) -> String {
    format!("{} x {} x {}", dims.x, dims.y, dims.z)
}

/// The most memory that the program has had, where the system tells (Linux).
pub(super) fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().trim_end_matches(" kB").parse::<u64>().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits_that_matter() {
        for (number, text) in [
            (0.0, "0"),
            (0.5, "0.5"),
            (-0.034593, "-0.03459"),
            (400.0, "400"),
            (12345.6, "12346"),
            (1e-7, "0.0000001"),
        ] {
            assert_eq!(short(number), text);
        }
    }

    #[test]
    fn numbers_have_commas() {
        assert_eq!(count(1, "voxel"), "1 voxel");
        assert_eq!(count(999, "voxel"), "999 voxels");
        assert_eq!(count(1234567, "voxel"), "1,234,567 voxels");
    }
}
