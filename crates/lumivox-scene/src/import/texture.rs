//! Decodes images and shrinks them to the size that is kept.

use std::io::Cursor;

use image::{ImageReader, RgbaImage};

use crate::mesh::check_limit;
use crate::{Limits, Scene, SceneError, Texture, Wrap};

/// Decodes the images of one scene within its budget of pixels.
pub(crate) struct Textures<'a> {
    limits: &'a Limits,
    read: u64,
    kept: u64,
    decoded: u64,
}

impl<'a> Textures<'a> {
    pub(crate) fn new(limits: &'a Limits) -> Self {
        Self { limits, read: 0, kept: 0, decoded: 0 }
    }

    /// Adds an sRGB image to the scene and returns its index. One that cannot be decoded is a warning and `None`.
    ///
    /// # Errors
    /// If all images together have more bytes or pixels than the limits allow.
    pub(crate) fn add(
        &mut self,
        name: &str,
        bytes: &[u8],
        wrap: [Wrap; 2],
        scene: &mut Scene,
    ) -> Result<Option<usize>, SceneError> {
        self.read += bytes.len() as u64;
        check_limit(name, "the size of all images in bytes", self.read, self.limits.buffer_bytes)?;
        match self.decode(bytes) {
            Ok((image, shrunk)) => {
                scene.report.shrunk_textures += u64::from(shrunk);
                let (width, height) = image.dimensions();
                self.kept += u64::from(width) * u64::from(height);
                check_limit(name, "the number of texture pixels", self.kept, self.limits.texture_pixels)?;
                let pixels = image.into_raw();
                scene.textures.push(Texture {
                    name: name.to_owned(),
                    width,
                    height,
                    srgb: true,
                    pixels,
                    wrap,
                });
                Ok(Some(scene.textures.len() - 1))
            }
            Err(reason) => {
                scene.report.warn(format!("texture '{name}' is left out: {reason}"));
                scene.report.missing_textures.push(name.to_owned());
                Ok(None)
            }
        }
    }

    fn decode(&mut self, bytes: &[u8]) -> Result<(RgbaImage, bool), String> {
        let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string());
        let (width, height) = reader()?.into_dimensions().map_err(|e| e.to_string())?;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > self.limits.image_pixels {
            return Err(format!(
                "its {width} x {height} pixels are outside of 1 to {}",
                self.limits.image_pixels
            ));
        }
        // Small kept textures can come from huge images, each of which takes its time.
        self.decoded += pixels;
        if self.decoded > self.limits.texture_pixels.saturating_mul(4) {
            return Err("the images before it took all the time that textures may take".to_owned());
        }
        let mut reader = reader()?;
        let mut limits = image::Limits::default();
        // 16-bit RGBA at worst, and as much again to work in.
        limits.max_alloc = Some(pixels * 16 + (1 << 20));
        reader.limits(limits);
        let mut image = reader.decode().map_err(|e| e.to_string())?.into_rgba8();
        let shrunk = image.width().max(image.height()) > self.limits.texture_side;
        while image.width().max(image.height()) > self.limits.texture_side.max(1) {
            image = halved(&image);
        }
        Ok((image, shrunk))
    }
}

/// Half the size by a 2 x 2 box; an odd last row or column counts twice. Averaged as stored, which darkens sRGB edges a
/// little but keeps flat areas exact.
fn halved(image: &RgbaImage) -> RgbaImage {
    let (w, h) = image.dimensions();
    RgbaImage::from_fn((w / 2).max(1), (h / 2).max(1), |x, y| {
        let at = |dx: u32, dy: u32| -> [u8; 4] {
            image.get_pixel((2 * x + dx).min(w - 1), (2 * y + dy).min(h - 1)).0
        };
        let block = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
        image::Rgba(std::array::from_fn(|c: usize| {
            let sum: u32 = block.iter().map(|p| u32::from(p[c])).sum();
            ((sum + 2) / 4) as u8
        }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let image = RgbaImage::from_fn(width, height, |x, _| image::Rgba([(x % 2 * 200) as u8, 10, 20, 255]));
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn large_images_are_halved_and_counted() {
        let limits = Limits { texture_side: 4, ..Limits::default() };
        let mut scene = Scene::default();
        let index = Textures::new(&limits).add("t", &png(8, 3), [Wrap::Repeat; 2], &mut scene).unwrap();
        assert_eq!((index, scene.report.shrunk_textures), (Some(0), 1));
        let t = &scene.textures[0];
        assert_eq!((t.width, t.height, t.pixels.len()), (4, 1, 16));
        assert_eq!(t.pixels[..4], [100, 10, 20, 255]);
    }

    #[test]
    fn broken_and_oversized_images_are_left_out_with_a_reason() {
        let limits = Limits { image_pixels: 4, ..Limits::default() };
        let mut scene = Scene::default();
        let mut textures = Textures::new(&limits);
        for bytes in [png(8, 8), b"no image".to_vec(), png(1, 1)[..40].to_vec()] {
            assert_eq!(textures.add("t", &bytes, [Wrap::Repeat; 2], &mut scene), Ok(None));
        }
        assert_eq!(scene.report.missing_textures.len(), 3);
        assert!(scene.report.warnings[0].contains("8 x 8"));
    }
}
