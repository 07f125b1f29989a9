//! Lights and the camera of a scene file.

use glam::Vec3;

use super::format::{CameraEntry, LightEntry, LightMotion};
use super::{amount, unit, vector};
use crate::{Camera, Light, SpotFalloff};

pub(super) fn camera(entry: &CameraEntry) -> Result<Camera, String> {
    let (eye, target) = (vector(entry.eye, "eye")?, vector(entry.target, "target")?);
    let ahead = unit((target - eye).to_array(), "distance from eye to target")?;
    let up = unit(entry.up, "up")?;
    if ahead.cross(up).length() < 1e-4 {
        return Err("that looks along its up".to_owned());
    }
    if !(entry.fov_y_deg > 0.0 && entry.fov_y_deg < 180.0) {
        return Err(format!("whose fov_y_deg is {}, not between 0 and 180", entry.fov_y_deg));
    }
    Ok(Camera { name: "camera".to_owned(), eye, target, up, fov_y: entry.fov_y_deg.to_radians() })
}

/// A light, its motion and the point that this is about.
type Placed<'a> = (Light, Option<&'a LightMotion>, Vec3);

/// `None` for a sky.
pub(super) fn light(entry: &LightEntry) -> Result<Option<Placed<'_>>, String> {
    Ok(Some(match *entry {
        LightEntry::Constant { .. } => return Ok(None),
        LightEntry::Point { position, intensity, ref motion } => {
            let position = vector(position, "position")?;
            let light = Light::Point { position, intensity: amount(intensity, "intensity")? };
            (light, motion.as_ref(), position)
        }
        LightEntry::Directional { direction, irradiance, ref motion } => {
            let direction = unit(direction, "direction")?;
            let light = Light::Directional { direction, irradiance: amount(irradiance, "irradiance")? };
            (light, motion.as_ref(), Vec3::ZERO)
        }
        LightEntry::Spot { position, target, intensity, cutoff_deg, beam_deg, ref motion } => {
            let position = vector(position, "position")?;
            let direction =
                unit((vector(target, "target")? - position).to_array(), "distance to its target")?;
            let beam_deg = beam_deg.unwrap_or(0.75 * cutoff_deg);
            if !(cutoff_deg > 0.0 && cutoff_deg <= 180.0 && beam_deg >= 0.0 && beam_deg <= cutoff_deg) {
                return Err("whose angles are not 0 <= beam_deg <= cutoff_deg <= 180".to_owned());
            }
            let cutoff = cutoff_deg.to_radians();
            // A hard edge keeps a sliver of falloff, so that its quotient stays defined.
            let beam = beam_deg.to_radians().min(0.999 * cutoff);
            let intensity = amount(intensity, "intensity")?;
            let falloff = SpotFalloff::LinearAngle;
            (Light::Spot { position, direction, intensity, beam, cutoff, falloff }, motion.as_ref(), position)
        }
        LightEntry::Rect { origin, u, v, radiance, ref motion } => {
            let (origin, u, v) = (vector(origin, "origin")?, vector(u, "u")?, vector(v, "v")?);
            if u.cross(v) == Vec3::ZERO {
                return Err("without an area".to_owned());
            }
            let radiance = amount(radiance, "radiance")?;
            (Light::Rect { origin, u, v, radiance }, motion.as_ref(), origin + 0.5 * (u + v))
        }
    }))
}
