//! Irradiance at each pixel: from the surfels of the eight cells around it, by how near they are and how much they face its
//! way. Those to which the way is blocked do not count: the lit floor behind a thin wall is near, too.

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

/// How pixels find out what stands between them and a surfel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sight {
    /// They do not: whole cells would hide surfels from the pixels of their own surface.
    Blind,
    /// From a sub-cell and a half above the surface, since sub-cells from views are here and there two thick.
    Lifted,
    /// From the surface.
    Exact,
}

/// How much higher than the surface pixels look, in sub-cells, with [`Sight::Lifted`].
const LIFT: f64 = 1.0;

#[derive(Debug)]
pub(super) struct Reconstruction(FullscreenPass);

impl Reconstruction {
    /// Of irradiance, or of the part of it that leaks: that comes from surfels which the pixel cannot see.
    pub(super) fn new(gpu: &Gpu, sight: Sight, leaks: bool) -> Self {
        let flag = |is: bool| f64::from(u8::from(is));
        let constants = [
            ("LOOKS", flag(sight != Sight::Blind)),
            ("LEAKS", flag(leaks)),
            ("LIFT", if sight == Sight::Lifted { LIFT } else { 0.0 }),
        ];
        Self(FullscreenPass::with_constants(gpu, &SHADER, IRRADIANCE_FORMAT, false, &constants))
    }

    /// The passes for each [`Sight`].
    pub(super) fn of_each(gpu: &Gpu, leaks: bool) -> [Self; 3] {
        [Sight::Blind, Sight::Lifted, Sight::Exact].map(|sight| Self::new(gpu, sight, leaks))
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
