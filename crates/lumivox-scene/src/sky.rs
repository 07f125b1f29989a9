//! Pictures of the sky: the radiance that comes from each direction, from infinitely far away.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;

/// Rows of a gradient.
const GRADIENT_ROWS: u32 = 64;

/// A latitude-longitude picture of all directions, in W/(m2 sr).
///
/// Row 0 lies around the zenith (+y), the last around the nadir. The middle column lies towards -z, columns to its right turn
/// towards +x, and the picture closes behind, at +z.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row.
    pub pixels: Vec<Vec3>,
}

impl SkyMap {
    /// From the zenith's radiance to the horizon's, evenly by angle, and one radiance for all below.
    pub fn gradient(zenith: Vec3, horizon: Vec3, ground: Vec3) -> Self {
        let half = GRADIENT_ROWS / 2;
        let pixels = (0..GRADIENT_ROWS).map(|row| match row < half {
            true => zenith.lerp(horizon, (row as f32 + 0.5) / half as f32),
            false => ground,
        });
        Self { width: 1, height: GRADIENT_ROWS, pixels: pixels.collect() }
    }

    /// The radiance from a unit direction, between the four nearest pixels.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let d = direction;
        let u = 0.5 + d.x.atan2(-d.z) / TAU;
        let v = 0.5 - d.y.clamp(-1.0, 1.0).asin() / PI;
        let (x, y) = (u * self.width as f32 - 0.5, v * self.height as f32 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let at = |column: f32, row: f32| {
            let column = (column as i64).rem_euclid(i64::from(self.width)) as usize;
            let row = (row as i64).clamp(0, i64::from(self.height) - 1) as usize;
            self.pixels[row * self.width as usize + column]
        };
        let row = |row: f32| at(left, row).lerp(at(left + 1.0, row), x - left);
        row(top).lerp(row(top + 1.0), y - top)
    }

    /// The direction of a pixel's middle.
    pub fn direction(&self, column: u32, row: u32) -> Vec3 {
        let (sin_up, cos_up) = (FRAC_PI_2 - PI * (row as f32 + 0.5) / self.height as f32).sin_cos();
        let (sin, cos) = (TAU * ((column as f32 + 0.5) / self.width as f32 - 0.5)).sin_cos();
        Vec3::new(sin * cos_up, sin_up, -cos * cos_up)
    }

    /// The solid angle of a pixel in this row.
    pub fn solid_angle(&self, row: u32) -> f32 {
        let edge = |row: u32| (PI * row as f32 / self.height as f32).cos();
        TAU / self.width as f32 * (edge(row) - edge(row + 1))
    }

    /// The same sky with at most so many rows, and twice as many columns: each pixel the mean, by solid angle, of those it
    /// takes the place of.
    pub fn shrunk(&self, rows: u32) -> Self {
        let (down, across) = (self.height.div_ceil(rows.max(1)), self.width.div_ceil(2 * rows.max(1)));
        if (down, across) == (1, 1) {
            return self.clone();
        }
        let (width, height) = (self.width.div_ceil(across), self.height.div_ceil(down));
        let mut pixels = Vec::with_capacity((width * height) as usize);
        for row in 0..height {
            for column in 0..width {
                let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
                for y in row * down..((row + 1) * down).min(self.height) {
                    let weight = self.solid_angle(y);
                    for x in column * across..((column + 1) * across).min(self.width) {
                        sum += weight * self.pixels[(y * self.width + x) as usize];
                        weights += weight;
                    }
                }
                pixels.push(sum / f32::max(weights, f32::MIN_POSITIVE));
            }
        }
        Self { width, height, pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn colored(width: u32, height: u32) -> SkyMap {
        let pixels = (0..width * height).map(|n| Vec3::new((n % width) as f32, (n / width) as f32, 1.0));
        SkyMap { width, height, pixels: pixels.collect() }
    }

    #[test]
    fn directions_lead_back_to_their_pixels() {
        let sky = colored(16, 8);
        for (column, row) in (0..8).flat_map(|row| (0..16).map(move |column| (column, row))) {
            let found = sky.radiance(sky.direction(column, row));
            assert!(
                (found - Vec3::new(column as f32, row as f32, 1.0)).length() < 1e-3,
                "{column} {row} {found}"
            );
        }
        assert!(sky.direction(8, 3).dot(Vec3::NEG_Z) > 0.9 && sky.direction(12, 3).x > 0.9);
        assert!(sky.direction(3, 0).y > 0.9);
    }

    #[test]
    fn solid_angles_are_the_whole_sphere_and_shrinking_keeps_the_light() {
        let sky = colored(64, 32);
        let power = |sky: &SkyMap| -> Vec3 {
            let of = |n: usize| sky.solid_angle(n as u32 / sky.width) * sky.pixels[n];
            (0..sky.pixels.len()).map(of).sum()
        };
        let whole = power(&sky);
        assert!((whole.z - 4.0 * PI).abs() < 1e-3);
        let small = sky.shrunk(8);
        assert_eq!((small.width, small.height), (16, 8));
        assert!((power(&small) / whole - 1.0).abs().max_element() < 1e-4);
        assert!(sky.shrunk(100) == sky);
    }

    #[test]
    fn a_gradient_goes_from_the_zenith_to_the_horizon() {
        let sky = SkyMap::gradient(Vec3::X, Vec3::Y, Vec3::Z);
        assert!(sky.radiance(Vec3::Y).x > 0.98 && sky.radiance(Vec3::NEG_Y) == Vec3::Z);
        let halfway = sky.radiance(Vec3::new(0.0, 1.0, 1.0).normalize_or_zero());
        assert!((halfway - Vec3::new(0.5, 0.5, 0.0)).length() < 0.01, "{halfway}");
    }
}
