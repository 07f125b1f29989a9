//! The `glass` of a mesh.

use glam::Vec3;

use super::amount;
use super::format::GlassEntry;
use crate::Glass;

/// Largest number of radians, metres and factors that is taken.
const MOST: f32 = 1e6;

/// What an entry says.
pub(super) fn glass(entry: &GlassEntry) -> Result<Glass, String> {
    let clear = Glass::default();
    let within = |value: Option<f32>, name: &str, low: f32, high: f32, otherwise: f32| match value {
        None => Ok(otherwise),
        Some(v) if (low..=high).contains(&v) => Ok(v),
        Some(_) => Err(format!("whose glass has {name} outside of {low} to {high}")),
    };
    let color = entry.color.map_or(Ok(Vec3::ONE), |c| amount(c, "glass color"))?;
    if color.max_element() > 1.0 {
        return Err("whose glass color is above 1".to_owned());
    }
    // A colour without a distance is that of a metre.
    let usual = if entry.color.is_some() { 1.0 } else { clear.distance };
    Ok(Glass {
        ior: within(entry.ior, "ior", 1.0, 4.0, clear.ior)?,
        color,
        distance: within(entry.distance, "distance", 1.0 / MOST, MOST, usual)?,
        roughness: within(entry.roughness, "roughness", 0.0, 1.0, 0.0)?,
        frost: within(entry.frost, "frost", 0.0, MOST, 0.0)?,
        bend: entry.bend.map(|b| within(Some(b), "bend", 0.0, MOST, 0.0)).transpose()?,
        body: entry.body.map_or(Ok(Vec3::ZERO), |b| amount(b, "glass body"))?,
        is_thin: entry.thin,
    })
}
