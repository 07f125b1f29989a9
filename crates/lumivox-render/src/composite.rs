//! The picture: direct light + albedo / pi * indirect irradiance + emission, or one layer of it alone.

use glam::Vec3;
use lumivox::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform};
use lumivox::{wgpu, wgsl};

use crate::surface::{HDR_FORMAT, SurfaceView};

/// The shader.
pub const SHADER: Shader = Shader {
    name: "render/composite",
    parts: &[wgsl::VIEW, wgsl::PACK, wgsl::FULLSCREEN, include_str!("composite.wgsl")],
};

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Layer {
    /// Everything, linear radiance.
    #[default]
    Final,
    /// Radiance that light reflects on its first bounce.
    Direct,
    /// Radiance that indirect light adds, albedo included.
    Indirect,
    /// Reflectance.
    Albedo,
    /// World normal, -1..1 shown as 0..1.
    Normal,
    /// Distance along the view direction in metres, at most 65504.
    Depth,
    /// The cells of the volume, lit.
    Voxels,
}

lumivox::gpu_struct! {
    /// What the composition shows.
    pub struct CompositeUniform {
        /// Radiance where nothing was drawn.
        pub sky: Vec3,
        /// A [`Layer`] by number.
        pub layer: u32,
    }
}

/// The pass.
#[derive(Debug)]
pub struct CompositePass {
    pass: FullscreenPass,
    uniform: Uniform<CompositeUniform>,
}

impl CompositePass {
    /// Compiles it.
    pub fn new(gpu: &Gpu) -> Self {
        let nothing = CompositeUniform { sky: Vec3::ZERO, layer: 0 };
        Self {
            pass: FullscreenPass::new(gpu, &SHADER, HDR_FORMAT, false),
            uniform: Uniform::new(gpu, "render/composite", &nothing),
        }
    }

    /// Chooses the layer and the sky's radiance, from the next submission on.
    pub fn update(&self, gpu: &Gpu, layer: Layer, sky: Vec3) {
        let number = match layer {
            Layer::Final | Layer::Voxels => 0,
            Layer::Direct => 1,
            Layer::Indirect => 2,
            Layer::Albedo => 3,
            Layer::Normal => 4,
            Layer::Depth => 5,
        };
        self.uniform.write(gpu, &CompositeUniform { sky, layer: number });
    }

    /// Makes the picture.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        camera: &SurfaceView,
        irradiance: &Texture,
        picture: &mut Texture,
    ) -> Result<(), GpuError> {
        let gbuffer = &camera.input.textures;
        let bindings = Bindings::new()
            .read("view", &camera.input.uniform)
            .read("composite", &self.uniform)
            .read("depth", &gbuffer.depth)
            .read("normal", &gbuffer.normal)
            .read("albedo", &gbuffer.albedo)
            .read("emission", &gbuffer.emission)
            .read("radiance", &gbuffer.radiance)
            .read("irradiance", irradiance);
        self.pass.record(gpu, encoder, &bindings, picture, false)
    }
}
