//! Draws the occupied cells of a volume as cubes, by walking each pixel's ray from cell to cell.
//!
//! A cell shows its albedo under a soft headlight, or the light that leaves it.

use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform};
use lumivox::progressive::DirectLight;
use lumivox::volume::{ALBEDO, EMISSION, NORMAL};
use lumivox::{VolumeBuffer, wgpu, wgsl};

use crate::surface::{HDR_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/voxel_view",
    parts: &[wgsl::GRID, wgsl::VIEW, wgsl::PACK, wgsl::SH, wgsl::FULLSCREEN, include_str!("voxel_view.wgsl")],
};

lumivox::gpu_struct! {
    /// How cells are shown.
    pub struct VoxelViewUniform {
        /// Brightness of the headlight on the albedo.
        pub headlight: f32,
        /// Share of the direct light that leaves a cell.
        pub light: f32,
        /// Cells above this height (world y) are left out, to look under roofs.
        pub cut_height: f32,
        /// Unused.
        pub reserved: f32,
    }
}

/// The pass.
#[derive(Debug)]
pub struct VoxelView {
    pass: FullscreenPass,
    uniform: Uniform<VoxelViewUniform>,
}

impl VoxelView {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let uniform = Uniform::new(gpu, "render/voxel view", &shown(f32::MAX));
        Self { pass: FullscreenPass::new(gpu, &SHADER, HDR_FORMAT, false), uniform }
    }

    /// Leaves out the cells above a height, from the next submission on.
    pub fn cut(&self, gpu: &Gpu, height: f32) {
        self.uniform.write(gpu, &shown(height));
    }

    /// Draws the cells as the camera would see them.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        camera: &SurfaceView,
        (volume, light): (&VolumeBuffer, &DirectLight),
        picture: &mut Texture,
    ) -> Result<(), GpuError> {
        let missing = || GpuError::Validation("the voxel view needs normal, albedo and emission".to_owned());
        let bindings = Bindings::new()
            .read("grid", volume.grid_uniform())
            .read("view", &camera.input.uniform)
            .read("voxel_view", &self.uniform)
            .read("normal", volume.channel(NORMAL).ok_or_else(missing)?)
            .read("albedo", volume.channel(ALBEDO).ok_or_else(missing)?)
            .read("emission", volume.channel(EMISSION).ok_or_else(missing)?)
            .read("light", light.coefficients());
        self.pass.record(gpu, encoder, &bindings, picture, false)
    }
}

fn shown(cut_height: f32) -> VoxelViewUniform {
    VoxelViewUniform { headlight: 0.6, light: 0.8, cut_height, reserved: 0.0 }
}
