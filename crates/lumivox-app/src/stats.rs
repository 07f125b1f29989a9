//! What a command did, as one JSON object.

use std::path::Path;

use anyhow::Result;
use lumivox::gpu::{Gpu, StageTime};
use lumivox_scene::Scene;
use serde::Serialize;

/// The adapter in use.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct AdapterStats {
    name: String,
    backend: String,
    kind: String,
    driver: String,
    tier: String,
}

impl AdapterStats {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let info = gpu.device.adapter_info();
        Self {
            name: info.name,
            backend: info.backend.to_string(),
            kind: format!("{:?}", info.device_type),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            tier: format!("{:?}", gpu.tier()),
        }
    }
}

/// A rendered scene.
#[derive(Debug, Serialize)]
pub(crate) struct RenderStats {
    pub(crate) scene: String,
    pub(crate) adapter: AdapterStats,
    pub(crate) size: [u32; 2],
    pub(crate) triangles: u64,
    pub(crate) meshes: usize,
    pub(crate) textures: usize,
    pub(crate) lights: usize,
    pub(crate) grid: [u32; 3],
    pub(crate) cell_size_m: f32,
    /// Surfels of gathered light.
    pub(crate) surfels: Option<u32>,
    /// Objects with visibility fields, and the spheres of all their meshes.
    pub(crate) field_objects: usize,
    pub(crate) field_spheres: usize,
    pub(crate) frames: u32,
    pub(crate) iterations: u32,
    pub(crate) settled: bool,
    pub(crate) exposure_ev: Option<f32>,
    pub(crate) load_ms: f64,
    pub(crate) total_ms: f64,
    pub(crate) stages: Vec<StageStats>,
    #[serde(flatten)]
    pub(crate) import: lumivox_scene::ImportReport,
}

/// Milliseconds of a stage, summed over what the command rendered.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct StageStats {
    pub(crate) stage: &'static str,
    pub(crate) ms: f64,
}

/// Adds stage times up.
pub(crate) fn add_stages(sum: &mut Vec<StageStats>, stages: &[StageTime]) {
    for time in stages {
        match sum.iter_mut().find(|s| s.stage == time.stage) {
            Some(s) => s.ms += time.millis,
            None => sum.push(StageStats { stage: time.stage, ms: time.millis }),
        }
    }
}

/// Writes any statistics.
pub(crate) fn write(path: &Path, stats: &impl Serialize) -> Result<()> {
    crate::output::write_text(path, &(serde_json::to_string_pretty(stats)? + "\n"))
}

/// Tells what was left out on import.
pub(crate) fn warn_of_import(scene: &Scene) {
    let report = &scene.report;
    for warning in &report.warnings {
        tracing::warn!("{warning}");
    }
    for texture in &report.missing_textures {
        tracing::warn!("missing texture: {texture}");
    }
    if report.dropped_vertices + report.dropped_triangles > 0 {
        let (v, t) = (report.dropped_vertices, report.dropped_triangles);
        tracing::warn!("{v} vertices and {t} triangles were dropped because they are not finite");
    }
}
