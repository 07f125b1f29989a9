//! Even steps of the azimuth along s and of the angle from the normal along t (Figure 32a).

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Vec2, Vec3};

/// The direction of a point of the unit square.
pub(super) fn direction(unit: Vec2) -> Vec3 {
    let (sin_azimuth, cos_azimuth) = (TAU * unit.x - PI).sin_cos();
    let (sin_polar, cos_polar) = (FRAC_PI_2 * unit.y).sin_cos();
    Vec3::new(cos_azimuth * sin_polar, sin_azimuth * sin_polar, cos_polar)
}

/// The point of the unit square of a direction.
#[inline]
pub(super) fn inverse(local: Vec3) -> Vec2 {
    let azimuth = local.y.atan2(local.x);
    // An arc cosine loses half its digits around the normal, where this mapping is densest.
    let polar = local.truncate().length().atan2(local.z);
    Vec2::new((azimuth + PI) / TAU, polar / FRAC_PI_2)
}
