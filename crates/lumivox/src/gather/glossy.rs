//! Glossy reflections (dissertation 8.2 names them as future work): from each pixel, rays about the mirrored view through the sub-cells.
//!
//! Half vectors follow the GGX distribution, and each ray weighs as much as the cosine under which it leaves: the usual estimate of
//! what an environment looks like in a rough surface, here with the scene itself for the environment.

use crate::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform};
use crate::light::IRRADIANCE_FORMAT;
use crate::progressive::ViewInput;
use crate::volume::VolumeBuffer;
use crate::wgsl::{FACE, FULLSCREEN, GRID, OCTAHEDRON, PACK, VIEW};

use super::{FREE_POINT, MARCH, MET, SEEN, SURFEL, Store};

pub(super) const SHADER: Shader = Shader {
    name: "gather/glossy",
    parts: &[
        GRID,
        VIEW,
        PACK,
        FACE,
        OCTAHEDRON,
        SURFEL,
        MARCH,
        FREE_POINT,
        MET,
        SEEN,
        FULLSCREEN,
        include_str!("glossy.wgsl"),
    ],
};

/// Smoother surfaces are treated as this rough.
pub const MIN_ROUGHNESS: f32 = 0.3;

crate::gpu_struct! {
    /// How rough surfaces are.
    pub struct GlossyUniform {
        /// Width of the GGX distribution.
        pub alpha: f32,
        /// Rays of a pixel.
        pub rays: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
    }
}

#[derive(Debug)]
pub(super) struct Glossy {
    pass: FullscreenPass,
    uniform: Uniform<GlossyUniform>,
}

impl Glossy {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            pass: FullscreenPass::new(gpu, &SHADER, IRRADIANCE_FORMAT, false),
            uniform: Uniform::new(gpu, "gather/glossy", &bytemuck::Zeroable::zeroed()),
        }
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (volume, store): (&VolumeBuffer, &Store),
        view: &ViewInput,
        target: &mut Texture,
        (roughness, rays): (f32, u32),
    ) -> Result<(), GpuError> {
        let alpha = roughness.clamp(MIN_ROUGHNESS, 1.0).powi(2);
        let rays = rays.clamp(1, 64);
        self.uniform.write(gpu, &GlossyUniform { alpha, rays, reserved_0: 0, reserved_1: 0 });
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &view.uniform)
            .read("glossy", &self.uniform)
            .read("depth", &view.textures.depth)
            .read("normal", &view.textures.normal)
            .read("table", &store.table)
            .read("surfels", &store.surfels)
            .read("shown", &store.shown)
            .read("mask", &store.mask)
            .read("blocks", &store.blocks)
            .read("sky", &store.sky);
        self.pass.record(gpu, encoder, &bindings, target, false)
    }
}
