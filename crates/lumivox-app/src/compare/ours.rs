//! What our renderer sees of the scene, layer by layer.

use anyhow::{Result, bail};
use glam::{UVec2, Vec3};
use lumivox::gpu::Gpu;
use lumivox_oracle::picture::Picture;
use lumivox_render::{Layer, Renderer, Settings};
use lumivox_scene::{Camera, Scene};

use crate::args::Size;
use crate::clock;
use crate::render::{self, Work};

/// Most points along a side of the rendered picture.
const MAX_SIDE: u32 = 8192;

/// Our pictures of one settled still.
pub(crate) struct Ours {
    pub(crate) direct: Picture,
    pub(crate) indirect: Picture,
    pub(crate) albedo: Picture,
    /// Pixels that show surfaces and nothing else.
    pub(crate) drawn: Vec<bool>,
    pub(crate) work: Work,
    pub(crate) millis: f64,
    pub(crate) renderer: Renderer,
}

/// How a pixel comes of the rendered ones, of which there are as many a side.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pixels {
    /// Their mean.
    Mean(u32),
    /// The one in the middle: what would be there in a smaller picture, of a volume that a larger one fills. An odd number.
    Middle(u32),
}

/// Renders a still as `lumivox render` does, as many times as wide and high as the settings say as `pixels` has a side, and reads its
/// layers. `steps` of propagation at a time go on until its light has settled.
pub(crate) fn render(
    gpu: &Gpu,
    scene: &Scene,
    settings: Settings,
    (pixels, steps): (Pixels, u32),
    camera: &Camera,
) -> Result<Ours> {
    let start = clock::millis();
    let (Pixels::Mean(points) | Pixels::Middle(points)) = pixels;
    let size = Size(settings.size.x, settings.size.y);
    let fine = Size(size.0 * points, size.1 * points);
    if fine.0.max(fine.1) > MAX_SIDE {
        bail!(
            "{}x{} pixels with --antialias {points} are more than {MAX_SIDE} points a side",
            size.0,
            size.1
        );
    }
    // The path tracer looks textures up at a point.
    let settings = Settings { size: UVec2::new(fine.0, fine.1), filtered_textures: false, ..settings };
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    let mut work = Work::default();
    render::still(&mut renderer, steps, camera, Some(clock::millis), &mut work)?;
    let millis = clock::millis() - start;
    let mut read = |layer| -> Result<Picture> {
        renderer.set_layer(layer);
        renderer.settle(0, None)?;
        Ok(Picture { width: fine.0, height: fine.1, pixels: renderer.read_picture()? })
    };
    let [direct, indirect] = [read(Layer::Direct)?, read(Layer::Indirect)?].map(|p| pixels.of(&p));
    let albedo = pixels.of(&read(Layer::Albedo)?);
    // Shown as 0..1 a normal is never zero in all of its components; the background is.
    let mut normal = read(Layer::Normal)?;
    normal.pixels.iter_mut().for_each(|n| *n = if *n == Vec3::ZERO { Vec3::ZERO } else { Vec3::ONE });
    let drawn = pixels.of(&normal).pixels.iter().map(|share| share.x > 0.999).collect();
    Ok(Ours { direct, indirect, albedo, drawn, work, millis, renderer })
}

impl Pixels {
    fn of(self, fine: &Picture) -> Picture {
        let (Self::Mean(points) | Self::Middle(points)) = self;
        let size = (fine.width / points, fine.height / points);
        if let Self::Middle(_) = self {
            return Picture::from_fn(size.0, size.1, |x, y| {
                fine.at(points * x + points / 2, points * y + points / 2)
            });
        }
        let weight = 1.0 / (points * points) as f32;
        Picture::from_fn(size.0, size.1, |x, y| {
            let square = (0..points).flat_map(|j| (0..points).map(move |i| (points * x + i, points * y + j)));
            weight * square.map(|(x, y)| fine.at(x, y)).sum::<Vec3>()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_the_means_or_the_middles_of_their_points() {
        let fine = Picture::from_fn(6, 4, |x, y| Vec3::new(x as f32, y as f32, 1.0));
        let coarse = Pixels::Mean(2).of(&fine);
        assert_eq!((coarse.width, coarse.height), (3, 2));
        assert_eq!(coarse.at(2, 1), Vec3::new(4.5, 2.5, 1.0));
        assert_eq!(Pixels::Mean(1).of(&fine), fine);
        let fine = Picture::from_fn(6, 3, |x, y| Vec3::new(x as f32, y as f32, 1.0));
        let coarse = Pixels::Middle(3).of(&fine);
        assert_eq!((coarse.width, coarse.height), (2, 1));
        assert_eq!(coarse.at(1, 0), Vec3::new(4.0, 1.0, 1.0));
    }
}
