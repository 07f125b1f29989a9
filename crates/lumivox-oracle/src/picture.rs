//! Linear pictures in memory.

use glam::{DVec3, Vec3};

/// Linear Rec. 709 pixels, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` colours, row by row.
    pub pixels: Vec<Vec3>,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: u32, height: u32, color: Vec3) -> Self {
        Self { width, height, pixels: vec![color; width as usize * height as usize] }
    }

    /// A picture from the colour of each pixel `(x, y)`.
    pub fn from_fn(width: u32, height: u32, color: impl Fn(u32, u32) -> Vec3) -> Self {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self { width, height, pixels: pixels.map(|(x, y)| color(x, y)).collect() }
    }

    /// The colour of a pixel.
    ///
    /// # Panics
    /// When the pixel lies outside.
    pub fn at(&self, x: u32, y: u32) -> Vec3 {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Mean colour; zero for a picture without pixels.
    pub fn mean(&self) -> Vec3 {
        let sum: DVec3 = self.pixels.iter().map(|p| p.as_dvec3()).sum();
        (sum / self.pixels.len().max(1) as f64).as_vec3()
    }

    /// The sum of two pictures.
    ///
    /// # Panics
    /// When their sizes differ.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        assert_eq!((self.width, self.height), (other.width, other.height), "pictures of different sizes");
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(a, b)| *a + *b).collect();
        Self { pixels, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_row_by_row() {
        let p = Picture::from_fn(3, 2, |x, y| Vec3::new(x as f32, y as f32, 0.0));
        assert_eq!(p.at(2, 1), Vec3::new(2.0, 1.0, 0.0));
        assert_eq!(p.mean(), Vec3::new(1.0, 0.5, 0.0));
        assert_eq!(p.plus(&p).at(1, 1), Vec3::new(2.0, 2.0, 0.0));
    }
}
