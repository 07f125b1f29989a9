//! Denoising: the mean over the 16 patterns of a block, on the pixel's own surface.

use glam::UVec2;

use super::tiled_pass::TiledPass;
use super::tiles::Tiles;
use super::{Receiver, TILE, TILE_QUAD};
use crate::gpu::{Bindings, Gpu, GpuError, Shader, Texture};
use crate::wgsl::VIEW;

pub(super) const SHADER: Shader =
    Shader { name: "visibility/denoise", parts: &[VIEW, TILE, TILE_QUAD, include_str!("denoise.wgsl")] };

#[derive(Debug)]
pub(super) struct Denoise {
    pass: TiledPass,
    /// What a first turn leaves, where there are two.
    between: Option<Texture>,
}

impl Denoise {
    pub(super) fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self { pass: TiledPass::new(gpu, &SHADER, format, &[]), between: None }
    }

    /// In two turns: a pattern comes back every four pixels, and the mean of means goes from one to the next without a step.
    ///
    /// # Errors
    /// A size that the device refuses.
    pub(super) fn twice(gpu: &Gpu, format: wgpu::TextureFormat, size: UVec2) -> Result<Self, GpuError> {
        let between = Texture::target(gpu, "visibility/denoise", size.to_array(), format)?;
        Ok(Self { between: Some(between), ..Self::new(gpu, format) })
    }

    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        receiver: &Receiver<'_>,
        tiles: &Tiles,
        noisy: &Texture,
        (target, rest): (&mut Texture, wgpu::Color),
    ) -> Result<(), GpuError> {
        let bindings = || {
            Bindings::new()
                .read("view", receiver.uniform)
                .read("tiles", &tiles.uniform)
                .read("depth", receiver.depth)
                .read("normal", receiver.normal)
                .read("tile_list", &tiles.list)
        };
        let Some(between) = &mut self.between else {
            return self.pass.record(gpu, encoder, &bindings().read("noisy", noisy), tiles, (target, rest));
        };
        self.pass.record(gpu, encoder, &bindings().read("noisy", noisy), tiles, (&mut *between, rest))?;
        self.pass.record(gpu, encoder, &bindings().read("noisy", &*between), tiles, (target, rest))
    }
}
