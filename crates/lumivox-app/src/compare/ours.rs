//! What our renderer sees of the scene, layer by layer.

use anyhow::Result;
use glam::Vec3;
use lumivox::gpu::Gpu;
use lumivox_oracle::picture::Picture;
use lumivox_render::{Layer, Renderer};
use lumivox_scene::{Camera, Scene};

use crate::args::{ShotArgs, Size};
use crate::clock;
use crate::render::{self, Work};

/// Our pictures of one settled still.
pub(crate) struct Ours {
    pub(crate) direct: Picture,
    pub(crate) indirect: Picture,
    pub(crate) albedo: Picture,
    /// Pixels that show a surface.
    pub(crate) drawn: Vec<bool>,
    pub(crate) work: Work,
    pub(crate) millis: f64,
    pub(crate) renderer: Renderer,
}

/// Renders a still as `lumivox render` does, and reads its layers.
pub(crate) fn render(gpu: &Gpu, scene: &Scene, shot: &ShotArgs, size: Size, camera: &Camera) -> Result<Ours> {
    let start = clock::millis();
    let settings = render::settings(shot, size, Layer::Direct, true);
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    let mut work = Work::default();
    render::still(&mut renderer, shot.iterations, camera, Some(clock::millis), &mut work)?;
    let millis = clock::millis() - start;
    let mut read = |layer| -> Result<Picture> {
        renderer.set_layer(layer);
        renderer.settle(0, None)?;
        Ok(Picture { width: size.0, height: size.1, pixels: renderer.read_picture()? })
    };
    let [direct, indirect] = [read(Layer::Direct)?, read(Layer::Indirect)?];
    let [albedo, normal] = [read(Layer::Albedo)?, read(Layer::Normal)?];
    // Shown as 0..1 a normal is never zero in all of its components; the background is.
    let drawn = normal.pixels.iter().map(|n| *n != Vec3::ZERO).collect();
    Ok(Ours { direct, indirect, albedo, drawn, work, millis, renderer })
}
