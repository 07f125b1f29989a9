//! Irradiance at each pixel: from the surfels of the eight cells around it, by how near they are and how much they face its
//! way. Those to which the way is blocked do not count: the lit floor behind a thin wall is near, too. That asks
//! for sub-cells from triangles; those from views are too thick for it.

use crate::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture};
use crate::light::IRRADIANCE_FORMAT;
use crate::progressive::ViewInput;
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, FULLSCREEN, GRID, OCTAHEDRON, PACK, VIEW};

use super::{FREE_POINT, MARCH, SURFEL, Store};

pub(super) const SHADER: Shader = Shader {
    name: "gather/reconstruction",
    parts: &[
        GRID,
        VIEW,
        PACK,
        FACE,
        OCTAHEDRON,
        SURFEL,
        MARCH,
        FREE_POINT,
        FULLSCREEN,
        include_str!("reconstruction.wgsl"),
    ],
};

#[derive(Debug)]
pub(super) struct Reconstruction(FullscreenPass);

impl Reconstruction {
    /// Whether pixels look for what stands between them and a surfel.
    pub(super) fn new(gpu: &Gpu, looks: bool) -> Self {
        Self::with(gpu, looks, false)
    }

    /// Of what light would leak if pixels did not look.
    pub(super) fn of_leaks(gpu: &Gpu) -> Self {
        Self::with(gpu, true, true)
    }

    fn with(gpu: &Gpu, looks: bool, leaks: bool) -> Self {
        let constants = [("LOOKS", f64::from(u8::from(looks))), ("LEAKS", f64::from(u8::from(leaks)))];
        Self(FullscreenPass::with_constants(gpu, &SHADER, IRRADIANCE_FORMAT, false, &constants))
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
            .read("shown", &store.shown)
            .read("mask", &store.mask)
            .read("blocks", &store.blocks);
        self.0.record(gpu, encoder, &bindings, target, false)
    }
}
