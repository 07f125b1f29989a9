//! Direct light: one full-screen pass per batch of shadow views adds what reaches each pixel through their maps.
//!
//! The shadow test looks up 3 x 3 bilinear comparisons half a texel apart, which reach 1.5 texels. The point is moved 1.6
//! shadow texels along its normal first: just beyond that reach, a surface cannot shadow itself, and no depth bias is needed.
//! Samples of area lights take one comparison, which reaches one texel, and 1.1 texels of distance: their number
//! blurs the edges.
//!
//! Radiance is summed in 32-bit floats, from one texture into another: core WebGPU cannot blend these, and half floats would
//! round away the samples of many batches.

use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Sampler, Shader, Texture};
use lumivox::{wgpu, wgsl};

use crate::lights::LIGHTS;
use crate::renderer::{ShadowBatch, ShadowedLights};
use crate::surface::{RADIANCE_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/direct",
    parts: &[wgsl::VIEW, LIGHTS, wgsl::FULLSCREEN, include_str!("direct.wgsl")],
};

/// The pass.
#[derive(Debug)]
pub struct DirectPass {
    pass: FullscreenPass,
    comparison: Sampler,
}

impl DirectPass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let comparison = Sampler::new(
            gpu,
            &wgpu::SamplerDescriptor {
                label: Some("render/shadow comparison"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                compare: Some(wgpu::CompareFunction::LessEqual),
                ..Default::default()
            },
        );
        Self { pass: FullscreenPass::new(gpu, &SHADER, RADIANCE_FORMAT, false), comparison }
    }

    /// Adds what a batch of views lets the camera's surfaces reflect to the camera's radiance. `spare` is a texture like the
    /// camera's radiance, with which it changes places.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        lights: &ShadowedLights,
        batch: &ShadowBatch,
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
            .read("shadow_atlas", &lights.atlas)
            .read("shadow_comparison", &self.comparison)
            .read("radiance_before", &gbuffer.radiance);
        self.pass.record(gpu, encoder, &bindings, spare, false)?;
        std::mem::swap(&mut gbuffer.radiance, spare);
        Ok(())
    }
}
