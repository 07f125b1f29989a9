//! Direct light: one full-screen pass per view of a light adds what reaches each pixel through its shadow map.
//!
//! The shadow test looks up 3 x 3 bilinear comparisons half a texel apart, which reach 1.5 texels. The point is moved 1.6
//! shadow texels along its normal first: just beyond that reach, a surface cannot shadow itself, and no depth bias is needed.

use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Sampler, Shader, Uniform};
use lumivox::{wgpu, wgsl};

use crate::lights::{LIGHTS, LightUniform};
use crate::surface::{HDR_FORMAT, SurfaceView};

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
        Self { pass: FullscreenPass::new(gpu, &SHADER, HDR_FORMAT, true), comparison }
    }

    /// Adds what a light reflects off the camera's surfaces to the camera's radiance, within one of the light's views.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        light: &Uniform<LightUniform>,
        shadow: &SurfaceView,
        camera: &mut SurfaceView,
    ) -> Result<(), GpuError> {
        let uniform = &camera.input.uniform;
        let gbuffer = &mut camera.input.textures;
        let bindings = Bindings::new()
            .read("view", uniform)
            .read("light", light)
            .read("shadow_view", &shadow.input.uniform)
            .read("depth", &gbuffer.depth)
            .read("normal", &gbuffer.normal)
            .read("albedo", &gbuffer.albedo)
            .read("shadow_depth", &shadow.input.textures.depth)
            .read("shadow_comparison", &self.comparison);
        self.pass.record(gpu, encoder, &bindings, &mut gbuffer.radiance, true)
    }
}
