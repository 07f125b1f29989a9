//! Denoising: the mean over the 16 patterns of a block, on the pixel's own surface.

use super::tiled_pass::TiledPass;
use super::tiles::Tiles;
use super::{Receiver, TILE, TILE_QUAD};
use crate::gpu::{Bindings, Gpu, GpuError, Shader, Texture};
use crate::wgsl::VIEW;

pub(super) const SHADER: Shader =
    Shader { name: "visibility/denoise", parts: &[VIEW, TILE, TILE_QUAD, include_str!("denoise.wgsl")] };

#[derive(Debug)]
pub(super) struct Denoise(TiledPass);

impl Denoise {
    pub(super) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self(TiledPass::new(gpu, &SHADER, format, &[]))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        receiver: &Receiver<'_>,
        tiles: &Tiles,
        noisy: &Texture,
        target: (&mut Texture, wgpu::Color),
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("view", receiver.uniform)
            .read("tiles", &tiles.uniform)
            .read("depth", receiver.depth)
            .read("normal", receiver.normal)
            .read("noisy", noisy)
            .read("tile_list", &tiles.list);
        self.0.record(gpu, encoder, &bindings, tiles, target)
    }
}
