//! Files the program writes: each under a temporary name first, then renamed, so that an interrupt leaves no half file.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glam::Vec3;
use lumivox_render::{Layer, tone};

/// A picture in memory: linear values, row 0 on top.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<Vec3>,
}

impl Picture {
    /// Bytes for a screen: radiance through the tone curve, other layers as they are.
    pub(crate) fn srgb(&self, layer: Layer, exposure_ev: f32) -> image::RgbImage {
        let farthest = self.pixels.iter().map(|p| p.x).fold(1e-6, f32::max);
        let bytes = self.pixels.iter().flat_map(|p| match layer {
            Layer::Final | Layer::Direct | Layer::Indirect | Layer::Voxels => {
                tone::tone_mapped(*p, exposure_ev)
            }
            Layer::Albedo | Layer::Normal => tone::srgb_bytes(*p),
            Layer::Depth => [(255.0 * (1.0 - p.x / farthest).clamp(0.0, 1.0)) as u8; 3],
        });
        let mut image = image::RgbImage::new(self.width, self.height);
        image.iter_mut().zip(bytes).for_each(|(to, byte)| *to = byte);
        image
    }
}

/// What a picture is written as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Format {
    Png,
    Exr,
    /// An animation.
    Gif,
}

/// The format of a file name.
pub(crate) fn format_of(path: &Path) -> Result<Format> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_lowercase).as_deref() {
        Some("png") => Ok(Format::Png),
        Some("exr") => Ok(Format::Exr),
        Some("gif") => Ok(Format::Gif),
        _ => bail!("{}: pictures are written as .png or .exr, series also as .gif", path.display()),
    }
}

/// Makes the folder that a file will be written into, before any work is done for it.
pub(crate) fn prepare_folder(path: &Path) -> Result<()> {
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot write {}: its folder cannot be made", path.display()))?;
    }
    if path.is_dir() {
        bail!("cannot write {}: a folder of that name is in the way", path.display());
    }
    Ok(())
}

/// Writes a picture in the format of its name.
pub(crate) fn write_picture(path: &Path, picture: &Picture, layer: Layer, exposure_ev: f32) -> Result<()> {
    match format_of(path)? {
        Format::Png => write_png(path, &picture.srgb(layer, exposure_ev)),
        Format::Gif => write_gif(path, &[picture.srgb(layer, exposure_ev)], 0),
        Format::Exr => write_with(path, |temporary| {
            let pixel = |x: usize, y: usize| picture.pixels[y * picture.width as usize + x].into();
            exr::prelude::write_rgb_file(temporary, picture.width as usize, picture.height as usize, pixel)
                .map_err(anyhow::Error::from)
        }),
    }
}

/// Writes a PNG.
pub(crate) fn write_png(path: &Path, image: &image::RgbImage) -> Result<()> {
    write_with(path, |temporary| Ok(image.save_with_format(temporary, image::ImageFormat::Png)?))
}

/// Writes an endless animation.
pub(crate) fn write_gif(path: &Path, frames: &[image::RgbImage], frame_millis: u32) -> Result<()> {
    write_with(path, |temporary| {
        let file = std::io::BufWriter::new(std::fs::File::create(temporary)?);
        // 10 of 1 (best) to 30 (fastest): three times quicker than the best, without visible loss here.
        let mut encoder = image::codecs::gif::GifEncoder::new_with_speed(file, 10);
        encoder.set_repeat(image::codecs::gif::Repeat::Infinite)?;
        for frame in frames {
            let rgba = image::DynamicImage::ImageRgb8(frame.clone()).into_rgba8();
            let delay = image::Delay::from_numer_denom_ms(frame_millis, 1);
            encoder.encode_frame(image::Frame::from_parts(rgba, 0, 0, delay))?;
        }
        Ok(())
    })
}

/// Writes text.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    write_with(path, |temporary| Ok(std::fs::write(temporary, text)?))
}

/// Makes the folder of a file, calls `write` with a temporary name beside it and renames the result.
fn write_with(path: &Path, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let failed = || format!("cannot write {}", path.display());
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).with_context(failed)?;
    }
    let temporary = temporary_name(path);
    let result = write(&temporary).and_then(|()| Ok(std::fs::rename(&temporary, path)?));
    if result.is_err() {
        // Whatever was written is of no use; that it cannot be removed either changes nothing.
        let _ = std::fs::remove_file(&temporary);
    }
    result.with_context(failed)
}

fn temporary_name(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}

/// Puts a frame's number into a name with one `%d` or `%0Nd`.
pub(crate) fn numbered(path: &Path, number: u32) -> Result<PathBuf> {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
    let pattern = || format!("{}: a series needs a name like picture_%04d.png", path.display());
    let (before, rest) = name.split_once('%').with_context(pattern)?;
    let (digits, after) = rest.split_once('d').with_context(pattern)?;
    let width: usize = if digits.is_empty() { 0 } else { digits.parse().ok().with_context(pattern)? };
    if after.contains('%') || width > 9 {
        bail!(pattern());
    }
    Ok(path.with_file_name(format!("{before}{number:0width$}{after}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_numbered() {
        assert_eq!(numbered(Path::new("a/x_%04d.png"), 7).unwrap(), Path::new("a/x_0007.png"));
        assert_eq!(numbered(Path::new("x%d.exr"), 12).unwrap(), Path::new("x12.exr"));
        for bad in ["x.png", "x%s.png", "x%d%d.png", "x%99999d.png"] {
            assert!(numbered(Path::new(bad), 1).is_err(), "{bad}");
        }
    }

    #[test]
    fn unknown_formats_are_refused() {
        assert_eq!(format_of(Path::new("a.PNG")).unwrap(), Format::Png);
        assert!(format_of(Path::new("a.bmp")).is_err());
        assert!(format_of(Path::new("a")).is_err());
    }

    #[test]
    fn a_folder_in_the_way_is_an_error_and_leaves_nothing_behind() {
        let folder = std::env::temp_dir().join(format!("lumivox-output-{}", std::process::id()));
        let target = folder.join("taken");
        std::fs::create_dir_all(target.join("inside")).unwrap();
        assert!(write_text(&target, "x").is_err());
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
