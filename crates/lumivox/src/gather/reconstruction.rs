//! Irradiance at each pixel: from the surfels of the eight cells around it, by how near they are and how much they face its
//! way. Those to which the way is blocked do not count: the lit floor behind a thin wall is near, too.

use crate::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture};
use crate::light::IRRADIANCE_FORMAT;
use crate::progressive::ViewInput;
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, FULLSCREEN, GRID, PACK, VIEW};

use super::{MARCH, SURFEL, Store};

pub(super) const SHADER: Shader = Shader {
    name: "gather/reconstruction",
    parts: &[GRID, VIEW, PACK, FACE, SURFEL, MARCH, FULLSCREEN, include_str!("reconstruction.wgsl")],
};

#[derive(Debug)]
pub(super) struct Reconstruction(FullscreenPass);

impl Reconstruction {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self(FullscreenPass::new(gpu, &SHADER, IRRADIANCE_FORMAT, false))
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        store: &Store,
        view: &ViewInput,
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("table", &store.table)
            .read("surfels", &store.surfels)
            .read("shine", &store.shine)
            .read("mask", &store.mask)
            .read("blocks", &store.blocks);
        self.0.record(gpu, encoder, &bindings, target, false)
    }
}
