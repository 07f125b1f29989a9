//! Draws the light in free space: a ball at each point of an irradiance volume.
//!
//! Each side of a ball shows what arrives from there and all around it as a white surface would reflect it, that is, the two bands
//! of spherical harmonics that the point holds.

use lumivox::core::Grid;
use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture};
use lumivox::irradiance::{self, IrradianceVolume};
use lumivox::{wgpu, wgsl};

use crate::surface::{HDR_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/lobes",
    parts: &[irradiance::QUERIES, wgsl::VIEW, wgsl::PACK, wgsl::FULLSCREEN, include_str!("lobes.wgsl")],
};

/// Cells between balls.
const SPACING: u32 = 4;

/// The pass and its lattice.
#[derive(Debug)]
pub struct Lobes {
    pass: FullscreenPass,
    lattice: IrradianceVolume,
}

impl Lobes {
    /// Compiles the pass and makes a dark lattice.
    pub fn new(gpu: &Gpu, grid: &Grid) -> Result<Self, GpuError> {
        let pass = FullscreenPass::new(gpu, &SHADER, HDR_FORMAT, false);
        Ok(Self { pass, lattice: IrradianceVolume::new(gpu, grid, SPACING)? })
    }

    /// The lattice, to be filled.
    pub fn lattice_mut(&mut self) -> &mut IrradianceVolume {
        &mut self.lattice
    }

    /// Draws the balls that the camera sees before its surfaces, and these dimly.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        camera: &SurfaceView,
        picture: &mut Texture,
    ) -> Result<(), GpuError> {
        let gbuffer = &camera.input.textures;
        let bindings = self
            .lattice
            .bind(Bindings::new())
            .read("view", &camera.input.uniform)
            .read("depth", &gbuffer.depth)
            .read("radiance", &gbuffer.radiance);
        self.pass.record(gpu, encoder, &bindings, picture, false)
    }
}
