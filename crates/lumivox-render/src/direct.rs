//! Direct light: one full-screen pass per batch of shadow views adds what reaches each pixel through their maps.
//!
//! The shadow test weighs 3 x 3 texels by a quadratic B-spline, a filter 3 texels wide. Each texel is compared with the depth
//! that the *receiver's plane* has in its middle, so a flat surface never shadows itself, however it is inclined, and
//! a shadow's edge stays where it is. The plane is the triangle's own, moved by 0.15 texels along its normal for what
//! rounding and shallow hollows take. (Moving the point along its normal instead, by the filter's reach, let light through
//! under edges: at a grazing sun 4 to 6 texels of it.) Samples of area lights look up a single texel: their number
//! blurs the edges.
//!
//! Radiance is summed in 32-bit floats, from one texture into another: core WebGPU cannot blend these, and half floats would
//! round away the samples of many batches.

use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture, TextureOptions};
use lumivox::visibility::FACTOR_FORMAT;
use lumivox::{wgpu, wgsl};

use crate::lights::LIGHTS;
use crate::renderer::{ShadowBatch, ShadowedLights};
use crate::surface::{RADIANCE_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/direct",
    parts: &[wgsl::VIEW, LIGHTS, wgsl::OCTAHEDRON, wgsl::FULLSCREEN, include_str!("direct.wgsl")],
};

/// The pass.
#[derive(Debug)]
pub struct DirectPass {
    pass: FullscreenPass,
    /// Stands where no object with a field takes light.
    all: Texture,
}

impl DirectPass {
    /// Compiles it.
    ///
    /// # Errors
    /// Those of the device.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let pass = FullscreenPass::new(gpu, &SHADER, RADIANCE_FORMAT, false);
        Ok(Self { pass, all: all_light(gpu)? })
    }

    /// Adds what a batch of views lets the camera's surfaces reflect to the camera's radiance, times what objects let through where
    /// these are given as a factor for each pixel. `spare` is a texture like the
    /// camera's radiance, with which it changes places.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lights: &ShadowedLights,
        (batch, factor): (&ShadowBatch, Option<&Texture>),
        camera: &mut SurfaceView,
        spare: &mut Texture,
    ) -> Result<(), GpuError> {
        let uniform = &camera.input.uniform;
        let gbuffer = &mut camera.input.textures;
        let bindings = Bindings::new()
            .read("view", uniform)
            .read("batch", &batch.uniform)
            .read("lights", &lights.lights)
            .read("shadow_views", &lights.views)
            .read("depth", &gbuffer.depth)
            .read("normal", &gbuffer.normal)
            .read("albedo", &gbuffer.albedo)
            .read("emission", &gbuffer.emission)
            .read("shadow_atlas", &lights.atlas)
            .read("radiance_before", &gbuffer.radiance)
            .read("object_factor", factor.unwrap_or(&self.all));
        self.pass.record(gpu, encoder, &bindings, spare, false)?;
        std::mem::swap(&mut gbuffer.radiance, spare);
        Ok(())
    }
}

/// A texel of one.
pub(crate) fn all_light(gpu: &Gpu) -> Result<Texture, GpuError> {
    let options = TextureOptions {
        size: [1, 1],
        format: FACTOR_FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        mips: 1,
    };
    let texture = Texture::new(gpu, "direct/all", options)?;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: None, rows_per_image: None };
    let one = half::f16::ONE.to_le_bytes();
    gpu.queue.write_texture(texture.raw.as_image_copy(), &one, layout, texture.raw.size());
    Ok(texture)
}
