//! Channels of light: radiance that leaves surfaces, shadowed, and its spherical harmonics (the papers' lighting and SH buffers).

use std::sync::Arc;

use glam::{Mat4, Vec3, Vec4};

use super::{Channel, SurfaceFunction};
use crate::gpu::{Bindings, Gpu, Sampler, Texture, Uniform};

/// The most lights at once.
pub const MAX_VOXEL_LIGHTS: usize = 16;

crate::gpu_struct! {
    /// A light with a shadow map.
    pub struct VoxelLight {
        /// World to the clip space of its shadow map, depth from 0 at the light to 1.
        pub clip_from_world: Mat4,
        /// Of a point light its place in metres, of a directional one the way the light travels.
        pub position: Vec3,
        /// 1 for a directional light, 0 for a point light.
        pub is_directional: u32,
        /// W/sr of a point light, W/m2 of a directional one.
        pub color: Vec3,
        /// Subtracted from a point's depth before it is compared: at least the depth of a cell, since a cell's piece of surface lies
        /// anywhere in it.
        pub bias: f32,
        /// Corner and size of the light's tile in the shadow map, 0 to 1; `(0, 0, 1, 1)` for all of it.
        pub tile: Vec4,
    }
}

crate::gpu_struct! {
    /// Lights as shaders see them.
    pub struct VoxelLights {
        /// The lights.
        pub lights: [VoxelLight; MAX_VOXEL_LIGHTS],
        /// How many count.
        pub count: u32,
        /// Nothing.
        pub padding: [u32; 3],
    }
}

/// Lights for channels of light, with the function that computes them. A point light takes one entry for each of its maps, and lights what
/// these show; a point that none shows is lit by all.
#[derive(Debug)]
pub struct LightChannels {
    uniform: Uniform<VoxelLights>,
    shadows: Texture,
    sampler: Sampler,
    function: Arc<SurfaceFunction>,
}

impl LightChannels {
    /// Lights that take their shadows from `shadows`, a depth texture of a single layer.
    pub fn new(gpu: &Gpu, shadows: Texture) -> Self {
        let sampler = wgpu::SamplerDescriptor {
            label: Some("voxelize/shadows"),
            compare: Some(wgpu::CompareFunction::LessEqual),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        };
        let none: VoxelLights = bytemuck::Zeroable::zeroed();
        Self {
            uniform: Uniform::new(gpu, "voxelize/lights", &none),
            shadows,
            sampler: Sampler::new(gpu, &sampler),
            function: Arc::new(function()),
        }
    }

    /// Replaces the lights, from the next submission on; those beyond [`MAX_VOXEL_LIGHTS`] do not count.
    pub fn set(&self, gpu: &Gpu, lights: &[VoxelLight]) {
        let mut value: VoxelLights = bytemuck::Zeroable::zeroed();
        value.count = lights.len().min(MAX_VOXEL_LIGHTS) as u32;
        value.lights.iter_mut().zip(lights).for_each(|(to, from)| *to = *from);
        self.uniform.write(gpu, &value);
    }

    /// What [`Voxelizer::bind`](super::Voxelizer::bind) takes.
    pub fn bindings(&self) -> Bindings<'_> {
        Bindings::new()
            .read("voxel_lights", &self.uniform)
            .read("voxel_shadows", &self.shadows)
            .read("voxel_shadow_sampler", &self.sampler)
    }

    /// `light`: radiance that leaves surfaces, three components, averaged up to `largest` W/(m2 sr).
    pub fn radiance(&self, largest: f32) -> Channel {
        Channel::function("light", 3, &self.function, 0).range(0.0, largest)
    }

    /// `sh`: its spherical harmonics of bands 0 and 1, of the mean over the colours.
    pub fn sh_mono(&self, largest: f32) -> Channel {
        self.sh("sh", 1, largest)
    }

    /// `sh_r`, `sh_g` and `sh_b`: the same of each colour.
    pub fn sh_rgb(&self, largest: f32) -> [Channel; 3] {
        [self.sh("sh_r", 2, largest), self.sh("sh_g", 3, largest), self.sh("sh_b", 4, largest)]
    }

    fn sh(&self, name: &str, output: u32, largest: f32) -> Channel {
        // The largest coefficient of a clamped cosine.
        let most = lumivox_core::sh::COS1 * largest;
        Channel::function(name, 4, &self.function, output).range(-most, most)
    }
}

fn function() -> SurfaceFunction {
    SurfaceFunction {
        name: "lv_direct_light".to_owned(),
        text: include_str!("lights.wgsl").to_owned(),
        outputs: 5,
    }
}

/// A channel of the function, for validation.
pub(super) fn any_channel() -> Channel {
    Channel::function("light", 4, &Arc::new(function()), 1)
}
