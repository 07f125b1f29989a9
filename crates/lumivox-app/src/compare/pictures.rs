//! The pictures: ours, the reference and the signed difference, each alone and all on one sheet.

use std::f32::consts::PI;
use std::path::Path;

use anyhow::Result;
use glam::Vec3;
use image::RgbImage;
use lumivox_oracle::metrics;
use lumivox_oracle::picture::Picture;
use lumivox_render::{Layer, tone};

use super::measure::{Comparison, Pair};
use crate::output::{self, Picture as OutputPicture};
use crate::sheet;

/// What lies outside the comparison.
const OUTSIDE: Vec3 = Vec3::splat(0.01);
/// Where ours is brighter and where it is darker, linear.
const BRIGHTER: Vec3 = Vec3::new(0.45, 0.0, 0.02);
const DARKER: Vec3 = Vec3::new(0.0, 0.05, 0.45);
/// Wide enough for the captions.
const LEAST_WIDTH: u32 = 400;

/// Writes three pictures of every pair, as EXR and PNG, and `sheet.png`.
pub(crate) fn write(
    folder: &Path,
    pairs: &[Pair],
    comparisons: &[Comparison],
    reference: &str,
) -> Result<()> {
    let mut rows = Vec::new();
    for (pair, comparison) in pairs.iter().zip(comparisons) {
        let difference = difference(pair);
        let (exposure, [ours, theirs, map]) = shown(pair, comparison);
        let name = match pair.quantity {
            "radiance" => pair.layer.to_owned(),
            quantity => format!("{}_{quantity}", pair.layer),
        };
        for (what, linear, png) in [
            ("ours", &pair.ours, &ours),
            ("reference", &pair.reference, &theirs),
            ("difference", &difference, &map),
        ] {
            let exr = folder.join(format!("{what}_{name}.exr"));
            output::write_picture(&exr, &scaled(linear, 1.0), Layer::Final, 0.0)?;
            output::write_png(&folder.join(format!("{what}_{name}.png")), png)?;
        }
        let title = format!("{} {}", pair.layer, pair.quantity);
        let names = [format!("{title}: ours"), format!("{title}: {reference}")];
        rows.push(row(comparison, names, exposure, [ours, theirs, map]));
    }
    output::write_png(&folder.join("sheet.png"), &sheet::captioned_sheet(&rows))
}

/// A row of a sheet: ours, the reference and the difference, the first two under these names.
pub(crate) fn compared(
    pair: &Pair,
    comparison: &Comparison,
    names: [String; 2],
) -> Vec<([String; 2], RgbImage)> {
    let (exposure, pictures) = shown(pair, comparison);
    row(comparison, names, exposure, pictures)
}

/// The exposure that suits the reference; ours and the reference at it, and the difference in colours.
fn shown(pair: &Pair, comparison: &Comparison) -> (f32, [RgbImage; 3]) {
    let mean = comparison.mean_reference as f32;
    // Irradiance is shown as a white surface would reflect it.
    let gain = if pair.quantity == "irradiance" { 1.0 / PI } else { 1.0 };
    let shown = |picture: &Picture| scaled(&kept(picture, &pair.kept), gain);
    let lit = if mean > 0.0 { &pair.reference } else { &pair.ours };
    let exposure = tone::auto_exposure(&shown(lit).pixels);
    let [ours, theirs] = [&pair.ours, &pair.reference].map(|p| shown(p).srgb(Layer::Final, exposure));
    (exposure, [ours, theirs, difference_colors(&difference(pair), &pair.kept, mean)])
}

fn row(
    c: &Comparison,
    [ours, reference]: [String; 2],
    exposure: f32,
    pictures: [RgbImage; 3],
) -> Vec<([String; 2], RgbImage)> {
    let percent = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{:.2}%", 100.0 * v));
    let captions = [
        [ours, format!("mean {:.4}, shown at {exposure:+.1} EV", c.mean_ours)],
        [reference, format!("mean {:.4}, noise {}", c.mean_reference, percent(c.noise))],
        [
            format!(
                "ours/reference {}, NRMSE {}, trimmed {}",
                c.mean_ratio.map_or("-".to_owned(), |r| format!("{r:.3}")),
                percent(c.nrmse),
                percent(c.trimmed)
            ),
            "red: ours brighter; full at the mean, half at 1/4".to_owned(),
        ],
    ];
    captions.into_iter().zip(pictures.map(enlarged)).collect()
}

/// Whole multiples of small pictures, so that captions have room.
fn enlarged(image: RgbImage) -> RgbImage {
    let (width, height) = image.dimensions();
    let times = LEAST_WIDTH.div_ceil(width.max(1));
    match times {
        0 | 1 => image,
        _ => image::imageops::resize(
            &image,
            times * width,
            times * height,
            image::imageops::FilterType::Nearest,
        ),
    }
}

/// Ours less reference where both are compared, zero elsewhere.
fn difference(pair: &Pair) -> Picture {
    // Without a foreground nothing differs.
    metrics::signed_difference(&pair.ours, &pair.reference, &pair.kept)
        .unwrap_or_else(|_| Picture::filled(pair.ours.width, pair.ours.height, Vec3::ZERO))
}

fn kept(picture: &Picture, kept: &[bool]) -> Picture {
    let pixels = picture.pixels.iter().zip(kept).map(|(p, kept)| if *kept { *p } else { Vec3::ZERO });
    Picture { pixels: pixels.collect(), ..*picture }
}

fn scaled(picture: &Picture, gain: f32) -> OutputPicture {
    let pixels = picture.pixels.iter().map(|p| gain * *p).collect();
    OutputPicture { width: picture.width, height: picture.height, pixels }
}

/// The mean over channels as colour: white for none, full where it is as large as `scale`, and by the square root in
/// between, so that one percent still shows.
fn difference_colors(difference: &Picture, kept: &[bool], scale: f32) -> RgbImage {
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let color = |d: &Vec3| {
        let value = d.element_sum() / 3.0 / scale;
        let share = value.abs().min(1.0).sqrt();
        Vec3::ONE.lerp(if value > 0.0 { BRIGHTER } else { DARKER }, share)
    };
    let pixels = difference.pixels.iter().zip(kept).map(|(d, kept)| if *kept { color(d) } else { OUTSIDE });
    let colors =
        OutputPicture { width: difference.width, height: difference.height, pixels: pixels.collect() };
    colors.srgb(Layer::Albedo, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_red_where_ours_is_brighter_and_blue_where_it_is_darker() {
        let values = [0.5, -0.5, 0.0, 9.0, 7.0].map(Vec3::splat).to_vec();
        let difference = Picture { width: 5, height: 1, pixels: values };
        let colors = difference_colors(&difference, &[true, true, true, true, false], 2.0);
        let [brighter, darker, same, most, outside] = [0, 1, 2, 3, 4].map(|x| colors.get_pixel(x, 0).0);
        assert!(brighter[0] > brighter[2] && darker[2] > darker[0] && same == [255; 3]);
        assert_eq!(most, tone::srgb_bytes(BRIGHTER));
        assert_eq!(outside, tone::srgb_bytes(OUTSIDE));
        // A quarter of the scale is half of the way.
        assert_eq!(brighter, tone::srgb_bytes(Vec3::ONE.lerp(BRIGHTER, 0.5)));
    }
}
