//! What `lumivox field` did, in words and as JSON.

use std::path::Path;

use lumivox_field::Field;
use serde::Serialize;

use super::check::Errors;

/// Baked or read fields.
#[derive(Debug, Default, Serialize)]
pub(super) struct FieldStats {
    pub(super) input: String,
    pub(super) triangles: Option<usize>,
    pub(super) points: u32,
    pub(super) directions: u32,
    pub(super) mapping: &'static str,
    pub(super) bits: u32,
    pub(super) normals: bool,
    /// Of the only sphere, or the first.
    pub(super) sphere_center_m: [f32; 3],
    pub(super) sphere_radius_m: f32,
    /// Texels of the 3D texture of each.
    pub(super) texture: Option<[u32; 3]>,
    /// Of all spheres.
    pub(super) bytes: u64,
    pub(super) spheres: Vec<SphereStats>,
    /// Volume of all spheres over that of the one around everything.
    pub(super) room: Option<f64>,
    /// Traced by this bake, and kept from one that was stopped.
    pub(super) rays: Option<u64>,
    pub(super) rays_kept: Option<u64>,
    pub(super) load_ms: f64,
    pub(super) bake_ms: Option<f64>,
    pub(super) million_rays_per_second: Option<f64>,
    /// Where the system tells.
    pub(super) million_rays_per_cpu_second: Option<f64>,
    /// Look-ups of the nearest map beside true rays.
    pub(super) nearest: Option<Errors>,
    /// Of the three maps around the entry.
    pub(super) blended: Option<Errors>,
    /// True rays on all cores, unsorted, closest hit.
    pub(super) true_million_rays_per_second: Option<f64>,
}

/// One of an object's spheres.
#[derive(Debug, Serialize)]
pub(super) struct SphereStats {
    file: Option<String>,
    center_m: [f32; 3],
    radius_m: f32,
    bytes: u64,
}

impl SphereStats {
    pub(super) fn of(field: &Field, file: Option<&Path>) -> Self {
        Self {
            file: file.map(|path| path.display().to_string()),
            center_m: field.sphere().center.to_array(),
            radius_m: field.sphere().radius,
            bytes: field.bytes(),
        }
    }
}

impl FieldStats {
    pub(super) fn of(input: &str, field: &Field) -> Self {
        let settings = field.settings();
        Self {
            input: input.to_owned(),
            points: settings.points,
            directions: settings.directions,
            mapping: settings.mapping.name(),
            bits: settings.storage.bits(),
            normals: settings.normals,
            sphere_center_m: field.sphere().center.to_array(),
            sphere_radius_m: field.sphere().radius,
            texture: field.texture_layout().map(|layout| layout.size()),
            bytes: field.bytes(),
            ..Self::default()
        }
    }

    /// What a reader wants to know, a line each.
    pub(super) fn words(&self) -> String {
        let mut words = format!(
            "{}: {} points of {} x {} directions ({}), {} bits{}, {:.2} MiB; a sphere of radius {:.4} m",
            self.input,
            self.points,
            self.directions,
            self.directions,
            self.mapping,
            self.bits,
            if self.normals { " and normals" } else { "" },
            self.bytes as f64 / f64::from(1 << 20),
            self.sphere_radius_m,
        );
        if self.spheres.len() > 1 {
            let radii: Vec<_> = self.spheres.iter().map(|s| format!("{:.4}", s.radius_m)).collect();
            words += &format!(
                "\n{} spheres, since the object leaves much of a single one empty; radii {} m",
                self.spheres.len(),
                radii.join(", ")
            );
            if let Some(room) = self.room {
                words += &format!(", together {:.0} % of its volume", 1e2 * room);
            }
        }
        if let (Some(ms), Some(rays), Some(rate)) = (self.bake_ms, self.rays, self.million_rays_per_second) {
            words += &format!("\nbaked in {:.2} s: {rays} rays, {rate:.2} million a second", ms / 1e3);
            if let Some(kept) = self.rays_kept.filter(|kept| *kept > 0) {
                words += &format!(", and {kept} kept from a bake that was stopped");
            }
            if let Some(rate) = self.million_rays_per_cpu_second {
                words += &format!(", {rate:.2} million a CPU-second");
            }
        }
        let kinds = [("nearest map", &self.nearest), ("three maps", &self.blended)];
        for (kind, errors) in kinds.into_iter().filter_map(|(kind, e)| Some((kind, e.as_ref()?))) {
            words += &format!(
                "\n{kind}: {:.2} % of verdicts wrong, distances off by {:.2} % of the diameter (RMS), {:.2} million look-ups a second",
                100.0 * errors.wrong,
                100.0 * errors.distance_rms,
                errors.million_per_second
            );
        }
        if let Some(rate) = self.true_million_rays_per_second {
            words += &format!("\ntrue rays: {rate:.2} million a second");
        }
        words
    }
}
