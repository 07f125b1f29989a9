//! The sky of a scene file: a gradient, or a picture of all directions.

use std::io::Cursor;

use glam::Vec3;
use image::{DynamicImage, ImageReader};

use super::super::source::Source;
use super::amount;
use super::format::SkyEntry;
use crate::{Limits, SkyMap};

/// Most rows that are kept: a row is then a fifth of a degree.
const MAX_ROWS: u32 = 1024;

/// Reads it, or says what is wrong with it.
pub(super) fn sky(entry: &SkyEntry, source: &Source, limits: &Limits) -> Result<SkyMap, String> {
    match (&entry.gradient, &entry.image) {
        (Some(_), None) if entry.scale.is_some() || entry.rot_y_deg.is_some() => {
            Err("whose gradient has a scale or rot_y_deg, which only an image can have".to_owned())
        }
        (Some(gradient), None) => Ok(SkyMap::gradient(
            amount(gradient.zenith, "zenith")?,
            amount(gradient.horizon, "horizon")?,
            amount(gradient.ground, "ground")?,
        )),
        (None, Some(file)) => {
            let scale = entry.scale.unwrap_or(1.0);
            let turn = entry.rot_y_deg.unwrap_or(0.0);
            if !(scale.is_finite() && scale >= 0.0 && turn.is_finite()) {
                return Err("whose scale is negative, or whose scale or rot_y_deg is not finite".to_owned());
            }
            let within = |e: crate::SceneError| format!("whose image cannot be used: {e}");
            let bytes = source.beside(file).map_err(within)?.read_self(limits).map_err(within)?;
            let map = picture(&bytes, limits).map_err(|why| format!("whose image {file} {why}"))?;
            Ok(turned(map.shrunk(MAX_ROWS), scale, turn))
        }
        _ => Err("that is not exactly one of gradient and image".to_owned()),
    }
}

/// A picture, twice as wide as high: linear, or decoded from sRGB if its channels have 8 or 16 bits.
fn picture(bytes: &[u8], limits: &Limits) -> Result<SkyMap, String> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string());
    let (width, height) = reader()?.into_dimensions().map_err(|e| format!("cannot be read: {e}"))?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > limits.image_pixels {
        return Err(format!("has {width} x {height} pixels, outside of 1 to {}", limits.image_pixels));
    }
    if width != 2 * height {
        return Err(format!(
            "has {width} x {height} pixels; a picture of all directions is twice as wide as high"
        ));
    }
    let mut reader = reader()?;
    let mut most = image::Limits::default();
    most.max_alloc = Some(pixels * 32 + (1 << 20));
    reader.limits(most);
    let decoded = reader.decode().map_err(|e| format!("cannot be read: {e}"))?;
    let is_linear = matches!(decoded, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let linear = |c: f32| match c {
        c if is_linear => c,
        c if c <= 0.04045 => c / 12.92,
        c => ((c + 0.055) / 1.055).powf(2.4),
    };
    let pixels =
        decoded.into_rgb32f().pixels().map(|p| Vec3::from_array(p.0.map(linear))).collect::<Vec<_>>();
    if pixels.iter().any(|p| !p.is_finite() || p.min_element() < 0.0) {
        return Err("has pixels that are negative or not finite".to_owned());
    }
    Ok(SkyMap { width, height, pixels })
}

/// The sky turned by whole columns, counter-clockwise as seen from above.
fn turned(map: SkyMap, scale: f32, degrees: f32) -> SkyMap {
    let width = map.width as usize;
    let columns = (degrees / 360.0).rem_euclid(1.0) * width as f32;
    let shift = columns.round() as usize % width;
    let row = |row: &[Vec3]| (0..width).map(|x| scale * row[(x + shift) % width]).collect::<Vec<_>>();
    let pixels = map.pixels.chunks(width).flat_map(row).map(|p| p.min(Vec3::MAX)).collect();
    SkyMap { pixels, ..map }
}
