//! Files the program writes: pictures, animations and text. Each is whole or not there; see [`crate::part_file`].

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glam::Vec3;
use image::RgbImage;
use lumivox_render::{Layer, tone};

use crate::part_file::PartFile;

/// A picture in memory: linear values, row 0 on top.
#[derive(Clone, Debug)]
pub(crate) struct Picture {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<Vec3>,
}

impl Picture {
    /// Bytes for a screen: radiance through the tone curve, other layers as they are.
    pub(crate) fn srgb(&self, layer: Layer, exposure_ev: f32) -> RgbImage {
        let farthest = self.pixels.iter().map(|p| p.x).fold(1e-6, f32::max);
        let bytes = self.pixels.iter().flat_map(|p| match layer {
            Layer::Final
            | Layer::Direct
            | Layer::Indirect
            | Layer::Voxels
            | Layer::Lobes
            | Layer::Glossy
            | Layer::Reflections => tone::tone_mapped(*p, exposure_ev),
            Layer::Albedo | Layer::Normal | Layer::Leaks | Layer::Occlusion | Layer::Transmittance => {
                tone::srgb_bytes(*p)
            }
            Layer::Thickness => [(255.0 * (p.x / farthest).clamp(0.0, 1.0)) as u8; 3],
            Layer::Depth => [(255.0 * (1.0 - p.x / farthest).clamp(0.0, 1.0)) as u8; 3],
        });
        let mut image = RgbImage::new(self.width, self.height);
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

/// Makes sure that a file can be written, before any work is done for it: makes its folder and tries.
pub(crate) fn prepare(path: &Path) -> Result<()> {
    if let Some(folder) = folder_of(path) {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot write {}: its folder cannot be made", path.display()))?;
    }
    if path.is_dir() {
        bail!("cannot write {}: a folder of that name is in the way", path.display());
    }
    PartFile::check(path).with_context(|| format!("cannot write {}", path.display()))
}

/// Refuses to write two of the outputs into one file, or any of them over a scene that is read.
pub(crate) fn check_apart(scenes: &[&str], outputs: &[&Path]) -> Result<()> {
    let scenes: Vec<PathBuf> = scenes.iter().map(|scene| place(Path::new(scene))).collect();
    let mut taken = Vec::new();
    for output in outputs {
        let place = place(output);
        if scenes.contains(&place) {
            bail!("{}: the scene would be overwritten", output.display());
        }
        if taken.contains(&place) {
            bail!("{}: two outputs cannot be one file", output.display());
        }
        taken.push(place);
    }
    Ok(())
}

/// Where a path leads, whichever way it is written.
fn place(path: &Path) -> PathBuf {
    let folder = || std::fs::canonicalize(folder_of(path).unwrap_or(Path::new("."))).ok();
    let unborn =
        || folder().map_or_else(|| path.to_owned(), |f| f.join(path.file_name().unwrap_or_default()));
    std::fs::canonicalize(path).unwrap_or_else(|_| unborn())
}

fn folder_of(path: &Path) -> Option<&Path> {
    path.parent().filter(|folder| !folder.as_os_str().is_empty())
}

/// Writes a picture in the format of its name.
pub(crate) fn write_picture(path: &Path, picture: &Picture, layer: Layer, exposure_ev: f32) -> Result<()> {
    use exr::prelude::WritableImage;
    match format_of(path)? {
        Format::Png => write_png(path, &picture.srgb(layer, exposure_ev)),
        Format::Gif => write_gif(path, 0, |show| show(picture.srgb(layer, exposure_ev))),
        Format::Exr => write_with(path, |file| {
            let (width, height) = (picture.width as usize, picture.height as usize);
            let channels = exr::prelude::SpecificChannels::rgb(|at: exr::prelude::Vec2<usize>| {
                <(f32, f32, f32)>::from(picture.pixels[at.y() * width + at.x()])
            });
            Ok(exr::prelude::Image::from_channels((width, height), channels).write().to_buffered(file)?)
        }),
    }
}

/// Writes a PNG.
pub(crate) fn write_png(path: &Path, image: &RgbImage) -> Result<()> {
    write_with(path, |file| Ok(image.write_to(file, image::ImageFormat::Png)?))
}

/// Writes an endless animation of the pictures that `play` shows, one by one.
pub(crate) fn write_gif(
    path: &Path,
    frame_millis: u32,
    play: impl FnOnce(&mut dyn FnMut(RgbImage) -> Result<()>) -> Result<()>,
) -> Result<()> {
    write_with(path, |file| {
        // 10 of 1 (best) to 30 (fastest): three times quicker than the best, without visible loss here.
        let mut encoder = image::codecs::gif::GifEncoder::new_with_speed(file, 10);
        encoder.set_repeat(image::codecs::gif::Repeat::Infinite)?;
        play(&mut |picture| {
            let rgba = image::DynamicImage::ImageRgb8(picture).into_rgba8();
            let delay = image::Delay::from_numer_denom_ms(frame_millis, 1);
            Ok(encoder.encode_frame(image::Frame::from_parts(rgba, 0, 0, delay))?)
        })
    })
}

/// Writes text.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    write_with(path, |file| Ok(file.write_all(text.as_bytes())?))
}

/// Makes the folder of a file and the file, which appears under its name when `write` has succeeded.
fn write_with(path: &Path, write: impl FnOnce(&mut PartFile) -> Result<()>) -> Result<()> {
    let failed = || format!("cannot write {}", path.display());
    folder_of(path).map_or(Ok(()), std::fs::create_dir_all).with_context(failed)?;
    let mut file = PartFile::create(path).with_context(failed)?;
    let result = write(&mut file);
    match file.failure() {
        Some(failure) => Err(failure).with_context(failed),
        None => result.and_then(|()| Ok(file.finish()?)).with_context(failed),
    }
}

/// Puts a frame's number into a name with one `%d` or `%0Nd`.
pub(crate) fn numbered(path: &Path, number: u32) -> Result<PathBuf> {
    let Some(name) = path.file_name().unwrap_or_default().to_str() else {
        bail!("{}: the name of a series must be Unicode", path.display());
    };
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
