//! How far a picture A is from a reference R.
//!
//! Only foreground pixels count. With `e` the mean absolute channel error of a pixel and `mean(R)` the mean over all
//! channels of the reference:
//!
//! - **NRMSE** `= rms(e) / mean(R)`;
//! - **trimmed**: the same without the 1 % of pixels with the largest `e` (edges, fireflies); the divisor stays;
//! - **low-frequency**: the NRMSE of both pictures blurred with a Gaussian of 1/32 of the picture's height, in which
//!   background pixels and those beyond the border have no weight;
//! - **mean ratio**: `mean(A) / mean(R)`: too bright above 1;
//! - **FLIP** (Andersson et al. 2020, at 67 pixels per degree): mean over the foreground of the difference that a viewer
//!   notices when flipping between the tone-mapped pictures, 0..=1. Both are scaled so that the reference's mean is 1/2,
//!   mapped by `x / (1 + x)`, and have a black background.
//!
//! A reference that is itself an estimate has a [`noise`] in the same unit as the NRMSE; as long as it stays below a
//! quarter of the error it adds less than 3.1 % to it, since independent errors add as squares.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::picture::Picture;

/// How far a picture is from its reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureDifference {
    /// Root mean square error over mean of the reference.
    pub nrmse: f64,
    /// The same without the worst 1 % of pixels.
    pub trimmed: f64,
    /// The same of the blurred pictures.
    pub low_frequency: f64,
    /// Mean of the picture over mean of the reference.
    pub mean_ratio: f64,
    /// Mean FLIP error, 0..=1.
    pub flip: f64,
    /// Foreground pixels.
    pub pixels: usize,
}

/// Why pictures cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MetricsError {
    /// Sizes differ, or the number of pixels or flags is not what the size says.
    #[error("the pictures and the foreground do not have the same size")]
    Size,
    /// No pixel is foreground.
    #[error("there is no foreground to compare")]
    NoForeground,
    /// The reference is black, so no error is small against it.
    #[error("the reference is black")]
    Black,
    /// A foreground pixel is not finite.
    #[error("pixel {x}, {y} is not finite")]
    NotFinite {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
}

/// Compares a picture with its reference where `foreground` says so.
///
/// # Errors
/// When sizes differ, nothing is foreground, the reference is black there, or a value is not finite.
pub fn compare(
    ours: &Picture,
    reference: &Picture,
    foreground: &[bool],
) -> Result<PictureDifference, MetricsError> {
    let mean = checked_mean(ours, reference, foreground)?;
    let mut errors = errors(ours, reference, foreground);
    let nrmse = rms(&errors) / mean;
    errors.sort_by(f64::total_cmp);
    let kept = errors.len() - errors.len() / 100;
    let sigma = f64::from(ours.height) / 32.0;
    let [blurred, blurred_reference] = [ours, reference].map(|p| blurred(p, foreground, sigma));
    Ok(PictureDifference {
        nrmse,
        trimmed: rms(&errors[..kept]) / mean,
        low_frequency: rms(&self::errors(&blurred, &blurred_reference, foreground)) / mean,
        mean_ratio: self::mean(ours, foreground) / mean,
        flip: flip(ours, reference, foreground, 0.5 / mean as f32),
        pixels: errors.len(),
    })
}

/// The NRMSE alone, as [`compare`] gives it.
///
/// # Errors
/// As for [`compare`].
pub fn nrmse(ours: &Picture, reference: &Picture, foreground: &[bool]) -> Result<f64, MetricsError> {
    let mean = checked_mean(ours, reference, foreground)?;
    Ok(rms(&errors(ours, reference, foreground)) / mean)
}

/// Mean of a picture's foreground over all channels; zero without foreground.
pub fn foreground_mean(picture: &Picture, foreground: &[bool]) -> f64 {
    if foreground.contains(&true) { mean(picture, foreground) } else { 0.0 }
}

/// What the standard errors of a reference's pixels contribute to an NRMSE at most:
/// `sqrt(mean over pixels and channels of error^2) / mean(R)`.
///
/// # Errors
/// As for [`compare`].
pub fn noise(
    standard_error: &Picture,
    reference: &Picture,
    foreground: &[bool],
) -> Result<f64, MetricsError> {
    let mean = checked_mean(standard_error, reference, foreground)?;
    let squares = kept(standard_error, foreground).map(|p| p.as_dvec3().length_squared() / 3.0);
    let squares: Vec<f64> = squares.collect();
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt() / mean)
}

/// Signed difference `ours - reference`, zero in the background.
///
/// # Errors
/// When sizes differ, nothing is foreground or a value is not finite.
pub fn signed_difference(
    ours: &Picture,
    reference: &Picture,
    foreground: &[bool],
) -> Result<Picture, MetricsError> {
    check(ours, reference, foreground)?;
    let pairs = ours.pixels.iter().zip(&reference.pixels).zip(foreground);
    let pixels = pairs.map(|((a, r), &kept)| if kept { *a - *r } else { Vec3::ZERO }).collect();
    Ok(Picture { pixels, ..*ours })
}

/// sRGB bytes of a linear picture: scaled by `exposure`, mapped by `x / (1 + x)` per channel, encoded.
pub fn tone_mapped(picture: &Picture, exposure: f32) -> Vec<u8> {
    let encode = |linear: f32| {
        let x = (exposure * linear).max(0.0);
        let x = if x.is_finite() { x / (1.0 + x) } else { 1.0 };
        let srgb = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (255.0 * srgb + 0.5) as u8
    };
    picture.pixels.iter().flat_map(|p| p.to_array().map(encode)).collect()
}

fn check(a: &Picture, b: &Picture, foreground: &[bool]) -> Result<(), MetricsError> {
    let pixels = a.width as usize * a.height as usize;
    let lengths = [a.pixels.len(), b.pixels.len(), foreground.len()];
    if (a.width, a.height) != (b.width, b.height) || lengths.iter().any(|&n| n != pixels) {
        return Err(MetricsError::Size);
    }
    if !foreground.contains(&true) {
        return Err(MetricsError::NoForeground);
    }
    for picture in [a, b] {
        let values = picture.pixels.iter().zip(foreground);
        if let Some(n) = values.into_iter().position(|(p, &kept)| kept && !p.is_finite()) {
            let n = n as u32;
            return Err(MetricsError::NotFinite { x: n % a.width, y: n / a.width });
        }
    }
    Ok(())
}

/// The reference's mean, above zero, of two pictures that can be compared.
fn checked_mean(a: &Picture, reference: &Picture, foreground: &[bool]) -> Result<f64, MetricsError> {
    check(a, reference, foreground)?;
    let mean = mean(reference, foreground);
    if mean > 0.0 { Ok(mean) } else { Err(MetricsError::Black) }
}

fn kept<'a>(picture: &'a Picture, foreground: &'a [bool]) -> impl Iterator<Item = Vec3> + 'a {
    picture.pixels.iter().zip(foreground).filter(|(_, kept)| **kept).map(|(p, _)| *p)
}

fn mean(picture: &Picture, foreground: &[bool]) -> f64 {
    let count = foreground.iter().filter(|&&kept| kept).count();
    let sum: DVec3 = kept(picture, foreground).map(|p| p.as_dvec3()).sum();
    sum.element_sum() / (3 * count) as f64
}

fn errors(a: &Picture, b: &Picture, foreground: &[bool]) -> Vec<f64> {
    let pairs = kept(a, foreground).zip(kept(b, foreground));
    pairs.map(|(a, b)| (a.as_dvec3() - b.as_dvec3()).abs().element_sum() / 3.0).collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Weighted with a Gaussian of `sigma` pixels out to four sigmas; background has no weight.
fn blurred(picture: &Picture, foreground: &[bool], sigma: f64) -> Picture {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let radius = (4.0 * sigma).ceil() as usize;
    let weights: Vec<f64> = (0..=radius).map(|d| (-0.5 * (d as f64 / sigma).powi(2)).exp()).collect();
    let seen = picture.pixels.iter().zip(foreground);
    let mut values: Vec<(DVec3, f64)> =
        seen.map(|(p, &kept)| if kept { (p.as_dvec3(), 1.0) } else { (DVec3::ZERO, 0.0) }).collect();
    for (count, stride) in [(width, 1), (height, width)] {
        let source = values;
        values = (0..width * height)
            .into_par_iter()
            .map(|n| {
                let at = n / stride % count;
                let (first, last) = (at.saturating_sub(radius), (at + radius).min(count - 1));
                let mut sum = (DVec3::ZERO, 0.0);
                for other in first..=last {
                    let (value, weight) = source[n + other * stride - at * stride];
                    let gauss = weights[other.abs_diff(at)];
                    sum = (sum.0 + gauss * value, sum.1 + gauss * weight);
                }
                sum
            })
            .collect();
    }
    let pixels = values.iter().map(|(v, w)| if *w > 0.0 { (*v / *w).as_vec3() } else { Vec3::ZERO });
    Picture { pixels: pixels.collect(), ..*picture }
}

fn flip(ours: &Picture, reference: &Picture, foreground: &[bool], exposure: f32) -> f64 {
    let image = |picture: &Picture| {
        let pairs = picture.pixels.iter().zip(foreground);
        let pixels = pairs.map(|(p, &kept)| if kept { *p } else { Vec3::ZERO }).collect();
        let bytes = tone_mapped(&Picture { pixels, ..*picture }, exposure);
        nv_flip::FlipImageRgb8::with_data(picture.width, picture.height, &bytes)
    };
    let map = nv_flip::flip(image(reference), image(ours), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
    let kept = map.iter().zip(foreground).filter(|(_, kept)| **kept).map(|(e, _)| f64::from(*e));
    let (count, sum) = kept.fold((0usize, 0.0), |(count, sum), e| (count + 1, sum + e));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Picture {
        Picture::from_fn(64, 48, |x, y| Vec3::new(x as f32 / 64.0, 0.5, y as f32 / 48.0))
    }

    fn all(picture: &Picture) -> Vec<bool> {
        vec![true; picture.pixels.len()]
    }

    fn mapped(picture: &Picture, f: impl Fn(usize, Vec3) -> Vec3) -> Picture {
        let pixels = picture.pixels.iter().enumerate().map(|(n, &p)| f(n, p)).collect();
        Picture { pixels, ..*picture }
    }

    #[test]
    fn equal_pictures_have_no_error() {
        let d = compare(&ramp(), &ramp(), &all(&ramp())).unwrap();
        assert_eq!((d.nrmse, d.trimmed, d.low_frequency, d.mean_ratio), (0.0, 0.0, 0.0, 1.0));
        assert!(d.flip < 1e-6 && d.pixels == 64 * 48);
    }

    #[test]
    fn a_constant_offset_shows_in_all_of_them() {
        let reference = Picture::filled(64, 48, Vec3::new(0.2, 0.4, 0.6));
        // Mean absolute channel error (0.1 + 0.2 + 0) / 3 on a mean of 0.4.
        let ours = mapped(&reference, |_, p| p + Vec3::new(0.1, -0.2, 0.0));
        let d = compare(&ours, &reference, &all(&reference)).unwrap();
        for value in [d.nrmse, d.trimmed, d.low_frequency] {
            assert!((value - 0.25).abs() < 1e-6, "{d:?}");
        }
        assert_eq!(nrmse(&ours, &reference, &all(&reference)), Ok(d.nrmse));
        assert!((foreground_mean(&ours, &all(&ours)) - 1.1 / 3.0).abs() < 1e-6);
        assert!((d.mean_ratio - 1.1 / 1.2).abs() < 1e-6);
        assert!(d.flip > 0.05 && d.flip < 1.0);
    }

    #[test]
    fn trimming_drops_one_percent_of_the_worst_and_no_more() {
        let reference = Picture::filled(100, 100, Vec3::ONE);
        let spoiled =
            |count| mapped(&reference, |n, p| if n % 97 == 0 && n / 97 < count { p + 3.0 } else { p });
        let d = |count| compare(&spoiled(count), &reference, &all(&reference)).unwrap();
        assert!((d(100).nrmse - 0.3).abs() < 1e-6 && d(100).trimmed == 0.0);
        assert!((d(101).trimmed - (9.0f64 / 9900.0).sqrt()).abs() < 1e-6);
    }

    #[test]
    fn fine_noise_vanishes_at_low_frequency_and_coarse_error_stays() {
        let reference = Picture::filled(128, 128, Vec3::ONE);
        let sign = |n: usize| if n % 2 == n / 128 % 2 { 0.2 } else { -0.2 };
        let fine = mapped(&reference, |n, p| p + sign(n));
        let d = compare(&fine, &reference, &all(&reference)).unwrap();
        assert!((d.nrmse - 0.2).abs() < 1e-6 && d.low_frequency < 0.005, "{d:?}");
        let coarse = mapped(&reference, |n, p| if n < 64 * 128 { p + 0.2 } else { p - 0.2 });
        let d = compare(&coarse, &reference, &all(&reference)).unwrap();
        assert!(d.low_frequency > 0.18 && d.low_frequency < 0.2, "{d:?}");
    }

    /// A step blurred by a Gaussian is its error function: 0.8413 of the step one sigma beyond it.
    #[test]
    fn blur_has_the_sigma_it_says() {
        let step = Picture::from_fn(200, 8, |x, _| Vec3::splat(if x < 100 { 0.0 } else { 1.0 }));
        let out = blurred(&step, &all(&step), 10.0);
        let between = |x: u32| 0.5 * (out.at(x - 1, 4).x + out.at(x, 4).x);
        assert!((between(100) - 0.5).abs() < 1e-4);
        assert!((between(110) - 0.841_34).abs() < 1e-3 && (between(90) - 0.158_66).abs() < 1e-3);
    }

    #[test]
    fn background_changes_nothing() {
        let foreground: Vec<bool> = (0..64 * 48).map(|n| n % 64 > 10).collect();
        let ours = mapped(&ramp(), |_, p| 1.1 * p);
        let clean = compare(&ours, &ramp(), &foreground).unwrap();
        let dirty = |p: &Picture| mapped(p, |n, p| if foreground[n] { p } else { Vec3::splat(f32::NAN) });
        assert_eq!(compare(&dirty(&ours), &dirty(&ramp()), &foreground), Ok(clean));
        assert!((clean.mean_ratio - 1.1).abs() < 1e-6 && clean.pixels == 53 * 48);
        let difference = signed_difference(&dirty(&ours), &ramp(), &foreground).unwrap();
        assert_eq!(difference.at(3, 3), Vec3::ZERO);
        assert!((difference.at(40, 3) - 0.1 * ramp().at(40, 3)).abs().max_element() < 1e-6);
    }

    #[test]
    fn flip_grows_with_the_difference_up_to_black_on_white() {
        let reference = ramp();
        let flip = |scale: f32| {
            let ours = mapped(&reference, |_, p| scale * p);
            compare(&ours, &reference, &all(&reference)).unwrap().flip
        };
        let all = [1.0, 1.05, 1.2, 2.0, 10.0].map(flip);
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "{all:?}");
        let white = Picture::filled(32, 32, Vec3::splat(1e9));
        let black = Picture::filled(32, 32, Vec3::ZERO);
        let most = self::flip(&black, &white, &vec![true; 1024], 1.0);
        assert!(most > 0.9 && most <= 1.0, "{most}");
    }

    #[test]
    fn noise_is_the_rms_of_the_standard_errors_over_the_mean() {
        let reference = Picture::filled(8, 8, Vec3::splat(2.0));
        let error = Picture::from_fn(8, 8, |x, _| Vec3::splat(if x < 4 { 0.3 } else { 0.4 }));
        let value = noise(&error, &reference, &all(&reference)).unwrap();
        assert!((value - (0.125f64).sqrt() / 2.0).abs() < 1e-6);
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let (a, black) = (ramp(), Picture::filled(64, 48, Vec3::ZERO));
        let few = Picture::filled(64, 47, Vec3::ONE);
        assert_eq!(compare(&a, &few, &all(&a)), Err(MetricsError::Size));
        assert_eq!(compare(&a, &a, &vec![false; 64 * 48]), Err(MetricsError::NoForeground));
        assert_eq!(compare(&a, &black, &all(&a)), Err(MetricsError::Black));
        let bad = mapped(&a, |n, p| if n == 64 + 3 { Vec3::NAN } else { p });
        assert_eq!(compare(&bad, &a, &all(&a)), Err(MetricsError::NotFinite { x: 3, y: 1 }));
    }
}
