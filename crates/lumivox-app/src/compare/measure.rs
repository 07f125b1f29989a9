//! The numbers: which pixels count, and how far ours is from the reference.

use std::f32::consts::PI;

use glam::Vec3;
use lumivox_oracle::metrics::{self, MetricsError};
use lumivox_oracle::picture::Picture;
use lumivox_oracle::tracer::{Layer, Rendering};
use serde::Serialize;

use super::ours::Ours;
use super::reference::{Files, NOISE_SHARE};

/// Irradiance is radiance over albedo, so it is not asked of pixels with less albedo than this in any channel.
pub(crate) const MIN_ALBEDO: f32 = 0.01;

/// Which pixels both show.
#[derive(Clone, Debug)]
pub(crate) struct Masks {
    /// A surface in both.
    pub(crate) foreground: Vec<bool>,
    /// The same with enough albedo to divide by.
    pub(crate) reflecting: Vec<bool>,
    /// A surface in ours alone, and in the reference alone.
    pub(crate) only_ours: usize,
    pub(crate) only_reference: usize,
}

impl Masks {
    /// `divisors`: the albedos that irradiance is derived with.
    pub(crate) fn new(drawn: &[bool], seen: &[bool], divisors: &[&Picture]) -> Self {
        let count = |ours: bool| drawn.iter().zip(seen).filter(|(d, s)| **d == ours && **s != ours).count();
        let foreground: Vec<bool> = drawn.iter().zip(seen).map(|(d, s)| *d && *s).collect();
        let enough = |n: usize| divisors.iter().all(|a| a.pixels[n].min_element() >= MIN_ALBEDO);
        let reflecting = foreground.iter().enumerate().map(|(n, kept)| *kept && enough(n)).collect();
        Self { foreground, reflecting, only_ours: count(true), only_reference: count(false) }
    }
}

/// Two pictures of the same light, and where they can be compared.
pub(crate) struct Pair {
    pub(crate) layer: &'static str,
    pub(crate) quantity: &'static str,
    pub(crate) ours: Picture,
    pub(crate) reference: Picture,
    pub(crate) standard_error: Option<Picture>,
    pub(crate) kept: Vec<bool>,
}

/// Ours against the path tracer's; it knows its irradiance without any albedo.
pub(crate) fn traced_pairs(ours: &Ours, rendering: &Rendering, masks: &Masks) -> Vec<Pair> {
    let layers =
        [("direct", &ours.direct, &rendering.direct), ("indirect", &ours.indirect, &rendering.indirect)];
    let pairs = layers.into_iter().flat_map(|(layer, seen, traced): (_, &Picture, &Layer)| {
        [
            Pair {
                layer,
                quantity: "radiance",
                ours: seen.clone(),
                reference: traced.radiance.clone(),
                standard_error: Some(traced.radiance_error.clone()),
                kept: masks.foreground.clone(),
            },
            Pair {
                layer,
                quantity: "irradiance",
                ours: irradiance(seen, &ours.albedo, &masks.reflecting),
                reference: traced.irradiance.clone(),
                standard_error: Some(traced.irradiance_error.clone()),
                kept: masks.reflecting.clone(),
            },
        ]
    });
    pairs.collect()
}

/// Ours against another renderer's; its irradiance is its radiance over the path tracer's `albedo`.
pub(crate) fn file_pairs(ours: &Ours, files: &Files, albedo: &Picture, masks: &Masks) -> Vec<Pair> {
    let layers = [("direct", &ours.direct, &files.direct), ("indirect", &ours.indirect, &files.indirect)];
    let pairs = layers.into_iter().flat_map(|(layer, seen, file): (_, &Picture, &Picture)| {
        [
            Pair {
                layer,
                quantity: "radiance",
                ours: seen.clone(),
                reference: file.clone(),
                standard_error: None,
                kept: masks.foreground.clone(),
            },
            Pair {
                layer,
                quantity: "irradiance",
                ours: irradiance(seen, &ours.albedo, &masks.reflecting),
                reference: irradiance(file, albedo, &masks.reflecting),
                standard_error: None,
                kept: masks.reflecting.clone(),
            },
        ]
    });
    pairs.collect()
}

/// The sum of direct and indirect light: what can be compared where surfaces glow, since the renderer counts all of their light
/// as indirect.
pub(crate) fn total(pairs: &[Pair], quantity: &str) -> Option<Pair> {
    let of = |layer| pairs.iter().find(|p| p.layer == layer && p.quantity == quantity);
    let (direct, indirect) = (of("direct")?, of("indirect")?);
    Some(Pair {
        layer: "total",
        quantity: direct.quantity,
        ours: sum(&direct.ours, &indirect.ours),
        reference: sum(&direct.reference, &indirect.reference),
        // Not independent: their sum is an upper bound.
        standard_error: direct
            .standard_error
            .as_ref()
            .zip(indirect.standard_error.as_ref())
            .map(|(a, b)| sum(a, b)),
        kept: direct.kept.clone(),
    })
}

/// All pairs, and the totals behind them if surfaces glow.
pub(crate) fn with_totals(mut pairs: Vec<Pair>, glows: bool) -> Vec<Pair> {
    if glows {
        let totals = ["radiance", "irradiance"].map(|quantity| total(&pairs, quantity));
        pairs.extend(totals.into_iter().flatten());
    }
    pairs
}

fn sum(a: &Picture, b: &Picture) -> Picture {
    Picture { pixels: a.pixels.iter().zip(&b.pixels).map(|(a, b)| *a + *b).collect(), ..*a }
}

fn irradiance(radiance: &Picture, albedo: &Picture, kept: &[bool]) -> Picture {
    let pixels = radiance.pixels.iter().zip(&albedo.pixels).zip(kept);
    let pixels = pixels.map(|((l, a), kept)| if *kept { PI * *l / *a } else { Vec3::ZERO });
    Picture { pixels: pixels.collect(), ..*radiance }
}

/// What is measured of a pair; absent where it has no meaning.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Comparison {
    pub(crate) layer: &'static str,
    pub(crate) quantity: &'static str,
    pub(crate) pixels: usize,
    pub(crate) mean_ours: f64,
    pub(crate) mean_reference: f64,
    pub(crate) mean_ratio: Option<f64>,
    pub(crate) nrmse: Option<f64>,
    pub(crate) trimmed: Option<f64>,
    pub(crate) low_frequency: Option<f64>,
    pub(crate) flip: Option<f64>,
    /// Of the reference, in the unit of the NRMSE; absent when nobody says how large it is.
    pub(crate) noise: Option<f64>,
    pub(crate) noise_is_low: Option<bool>,
    /// Why numbers are absent.
    pub(crate) note: Option<String>,
}

impl Pair {
    pub(crate) fn compare(&self) -> Comparison {
        let mut c = Comparison {
            layer: self.layer,
            quantity: self.quantity,
            pixels: self.kept.iter().filter(|&&kept| kept).count(),
            mean_ours: metrics::foreground_mean(&self.ours, &self.kept),
            mean_reference: metrics::foreground_mean(&self.reference, &self.kept),
            ..Comparison::default()
        };
        match metrics::compare(&self.ours, &self.reference, &self.kept) {
            Ok(d) => {
                c.mean_ratio = Some(d.mean_ratio);
                c.nrmse = Some(d.nrmse);
                c.trimmed = Some(d.trimmed);
                c.low_frequency = Some(d.low_frequency);
                c.flip = Some(d.flip);
                c.noise = self.noise().and_then(Result::ok);
                c.noise_is_low = c.noise.map(|noise| noise <= NOISE_SHARE * d.trimmed);
            }
            Err(reason) => c.note = Some(reason.to_string()),
        }
        c
    }

    /// Whether more samples would tell nothing new.
    pub(crate) fn is_quiet(&self) -> bool {
        let Some(noise) = self.noise() else { return true };
        match (noise, metrics::compare(&self.ours, &self.reference, &self.kept)) {
            (Ok(noise), Ok(d)) => noise <= NOISE_SHARE * d.trimmed,
            // Black or empty: no number of samples gives it an error.
            (_, Err(_)) => true,
            (Err(_), _) => false,
        }
    }

    fn noise(&self) -> Option<Result<f64, MetricsError>> {
        Some(metrics::noise(self.standard_error.as_ref()?, &self.reference, &self.kept))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(ours: f32, reference: f32, error: Option<f32>) -> Pair {
        let picture = |value: f32| Picture::filled(8, 4, Vec3::splat(value));
        Pair {
            layer: "direct",
            quantity: "radiance",
            ours: picture(ours),
            reference: picture(reference),
            standard_error: error.map(picture),
            kept: vec![true; 32],
        }
    }

    #[test]
    fn noise_is_low_below_a_quarter_of_the_error() {
        for (error, low) in [(0.04, true), (0.06, false)] {
            let c = pair(1.2, 1.0, Some(error)).compare();
            assert_eq!(c.noise_is_low, Some(low));
            assert_eq!(pair(1.2, 1.0, Some(error)).is_quiet(), low);
            assert!(
                (c.nrmse.unwrap() - 0.2).abs() < 1e-6 && (c.noise.unwrap() - f64::from(error)).abs() < 1e-6
            );
        }
        let silent = pair(1.2, 1.0, None).compare();
        assert_eq!((silent.noise, silent.noise_is_low), (None, None));
        // A single sample knows nothing of its error.
        assert!(!pair(1.2, 1.0, Some(f32::INFINITY)).is_quiet());
    }

    #[test]
    fn a_black_reference_has_means_and_a_reason_but_no_ratio() {
        let c = pair(0.5, 0.0, Some(0.0)).compare();
        assert_eq!((c.mean_ours, c.mean_reference, c.mean_ratio, c.nrmse), (0.5, 0.0, None, None));
        assert!(c.note.unwrap().contains("black"));
    }

    #[test]
    fn the_total_is_the_sum_of_both_layers() {
        let layers = |layer, value: f32| Pair { layer, ..pair(value, 2.0 * value, Some(0.1)) };
        let pairs = with_totals(vec![layers("direct", 1.0), layers("indirect", 3.0)], true);
        let total = pairs.last().unwrap();
        assert_eq!((pairs.len(), total.layer, total.quantity), (3, "total", "radiance"));
        assert_eq!((total.ours.at(0, 0).x, total.reference.at(0, 0).x), (4.0, 8.0));
        assert_eq!(total.standard_error.as_ref().unwrap().at(0, 0).x, 0.2);
    }

    #[test]
    fn pixels_count_where_both_show_a_surface_that_reflects() {
        let albedo = Picture {
            width: 4,
            height: 1,
            pixels: vec![Vec3::ONE, Vec3::ONE, Vec3::new(0.5, 0.0, 0.5), Vec3::ONE],
        };
        let masks = Masks::new(&[true, true, true, false], &[true, false, true, true], &[&albedo]);
        assert_eq!(masks.foreground, [true, false, true, false]);
        assert_eq!(masks.reflecting, [true, false, false, false]);
        assert_eq!((masks.only_ours, masks.only_reference), (1, 1));
        let radiance = Picture::filled(4, 1, Vec3::splat(0.5));
        let e = irradiance(&radiance, &albedo, &masks.reflecting);
        assert_eq!(e.pixels, [Vec3::splat(0.5 * PI), Vec3::ZERO, Vec3::ZERO, Vec3::ZERO]);
    }
}
