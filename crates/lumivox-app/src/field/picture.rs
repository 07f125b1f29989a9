//! Maps as a picture.

use glam::Vec3;
use image::{Rgb, RgbImage};
use lumivox_field::{BYTE_MISS, Distances, Field};

/// Sides of a map and of the gaps between maps in the picture.
const SIDE: u32 = 256;
const GAP: u32 = 8;
/// Where nothing is met, where a mapping leaves a texel unused, and between maps.
const NOTHING: Rgb<u8> = Rgb([24, 34, 70]);
const GROUND: Rgb<u8> = Rgb([255, 255, 255]);

/// The maps of some fields, one sheet below the other.
pub(crate) fn sheets(fields: &[Field]) -> RgbImage {
    let all: Vec<_> = fields.iter().map(sheet).collect();
    let (width, height) = all.first().map_or((1, 1), RgbImage::dimensions);
    let mut together = RgbImage::new(width, height * all.len().max(1) as u32);
    for (n, sheet) in all.iter().enumerate() {
        image::imageops::replace(&mut together, sheet, 0, i64::from(height) * n as i64);
    }
    together
}

/// Six maps: of the sample points nearest to +x, +y, +z in the upper row and -x, -y, -z in the lower.
fn sheet(field: &Field) -> RgbImage {
    let mut sheet = RgbImage::from_pixel(3 * SIDE + 4 * GAP, 2 * SIDE + 3 * GAP, GROUND);
    for (n, axis) in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].into_iter().enumerate() {
        let point = field.points().nearest(axis);
        let corner = [n as u32 % 3, n as u32 / 3].map(|n| GAP + n * (SIDE + GAP));
        let side = field.settings().directions;
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let texel = x * side / SIDE + side * (y * side / SIDE);
            let colour = distance(field, point, texel).map_or(NOTHING, shade);
            sheet.put_pixel(corner[0] + x, corner[1] + y, colour);
        }
    }
    sheet
}

/// Bright where it is near.
fn shade(distance: f32) -> Rgb<u8> {
    Rgb([(255.0 - 225.0 * distance.clamp(0.0, 1.0)) as u8; 3])
}

/// The distance of a texel over the sphere's diameter.
fn distance(field: &Field, point: u32, texel: u32) -> Option<f32> {
    let at = (point * field.directions().count() + texel) as usize;
    match field.distances() {
        Distances::Byte(codes) => (codes[at] != BYTE_MISS).then(|| f32::from(codes[at]) / 254.0),
        Distances::Float(values) => (values[at] < 1.0).then_some(values[at]),
        Distances::Bit { words, depths } => {
            (words[at / 32] >> (at % 32) & 1 == 1).then_some(depths[point as usize])
        }
    }
}
