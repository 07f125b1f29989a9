//! The tone curve of PNG output.
//!
//! Radiance is scaled by `2^EV`, then each channel goes through Hable's filmic curve, normalised so that 11.2 becomes white,
//! then the sRGB transfer function. Radiance 0.18 at exposure 0 becomes a middle grey; the shoulder
//! keeps bright surfaces from clipping, the toe keeps shadows deep. Layers that are not radiance (albedo, normal) skip the
//! curve, and depth is shown from white (near) to black (far).

use glam::Vec3;

/// Input that becomes white.
const WHITE: f32 = 11.2;
/// Radiance that [`auto_exposure`] aims at.
const MIDDLE_GREY: f32 = 0.18;
/// Brings middle grey to where the eye expects it after the curve has pressed highlights down.
const PRE_EXPOSURE: f32 = 2.0;

/// More stops than this change no picture of half floats any more, which span 40; a product with them is finite.
const EV_LIMIT: f32 = 64.0;

/// Linear radiance to sRGB bytes; what is not a number is black.
pub fn tone_mapped(radiance: Vec3, exposure_ev: f32) -> [u8; 3] {
    let scale = PRE_EXPOSURE * exposure_ev.clamp(-EV_LIMIT, EV_LIMIT).exp2();
    // The curve is white from there on, and its squares would overflow.
    let exposed = radiance.to_array().map(|c| (scale * c.max(0.0)).min(WHITE));
    srgb_bytes(exposed.map(|c| hable(c) / hable(WHITE)).into())
}

/// The exposure that brings the geometric mean of what is lit to middle grey, between -8 and +8 stops. Pixels darker than a
/// thousandth of the mean count as unlit, so that black shadows do not make the rest glare.
pub fn auto_exposure(radiance: &[Vec3]) -> f32 {
    let luminance = |c: &Vec3| c.dot(Vec3::new(0.2126, 0.7152, 0.0722));
    let mean = radiance.iter().map(luminance).sum::<f32>() / radiance.len().max(1) as f32;
    let lit: Vec<f32> =
        radiance.iter().map(luminance).filter(|l| *l > 1e-3 * mean && l.is_finite()).collect();
    if lit.is_empty() {
        return 0.0;
    }
    let log_mean = lit.iter().map(|l| l.log2()).sum::<f32>() / lit.len() as f32;
    (MIDDLE_GREY.log2() - log_mean).clamp(-8.0, 8.0)
}

/// Linear values 0..1 to sRGB bytes.
pub fn srgb_bytes(linear: Vec3) -> [u8; 3] {
    linear.to_array().map(|c| (255.0 * srgb_from_linear(c.clamp(0.0, 1.0)) + 0.5) as u8)
}

/// The curve of Hable, *Uncharted 2: HDR lighting* (2010), with its published constants.
fn hable(x: f32) -> f32 {
    const A: f32 = 0.15;
    const B: f32 = 0.50;
    const C: f32 = 0.10;
    const D: f32 = 0.20;
    const E: f32 = 0.02;
    const F: f32 = 0.30;
    (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F
}

fn srgb_from_linear(c: f32) -> f32 {
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_stays_black_and_brighter_is_never_darker() {
        assert_eq!(tone_mapped(Vec3::ZERO, 0.0), [0; 3]);
        let ramp: Vec<u8> = (0..200).map(|i| tone_mapped(Vec3::splat(0.05 * i as f32), 0.0)[0]).collect();
        assert!(ramp.is_sorted());
        assert_eq!(*ramp.last().unwrap(), 255);
    }

    #[test]
    fn middle_grey_looks_so() {
        let [grey, ..] = tone_mapped(Vec3::splat(0.18), 0.0);
        assert!((90..=125).contains(&grey), "{grey}");
        let dark = vec![Vec3::splat(0.18 / 8.0); 10];
        assert!((auto_exposure(&dark) - 3.0).abs() < 1e-3);
        assert_eq!(auto_exposure(&[Vec3::ZERO; 4]), 0.0);
    }

    #[test]
    fn no_exposure_or_radiance_is_too_much() {
        for ev in [100.0, 1e4, f32::MAX, f32::INFINITY] {
            assert_eq!(tone_mapped(Vec3::new(0.0, 1e-4, 6e4), ev), [0, 255, 255]);
            assert_eq!(tone_mapped(Vec3::new(0.0, 1e-4, 6e4), -ev), [0; 3]);
        }
        let odd = Vec3::new(f32::INFINITY, f32::NAN, f32::NEG_INFINITY);
        assert_eq!(tone_mapped(odd, 0.0), [255, 0, 0]);
    }

    #[test]
    fn one_stop_doubles_radiance() {
        assert_eq!(tone_mapped(Vec3::splat(0.4), 0.0), tone_mapped(Vec3::splat(0.2), 1.0));
    }
}
