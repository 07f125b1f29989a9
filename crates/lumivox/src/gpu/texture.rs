//! Textures with an identity, and samplers.

use super::{Gpu, GpuError};

/// A texture with its default view, of two dimensions unless said otherwise. Its identity never repeats on a device; clones are the same texture.
#[derive(Clone, Debug)]
pub struct Texture {
    pub(super) id: u64,
    /// The wgpu texture.
    pub raw: wgpu::Texture,
    /// View of the whole texture.
    pub view: wgpu::TextureView,
}

/// How a texture is made.
#[derive(Clone, Copy, Debug)]
pub struct TextureOptions {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Format.
    pub format: wgpu::TextureFormat,
    /// Usage; copy source is always added.
    pub usage: wgpu::TextureUsages,
    /// Number of mip levels.
    pub mips: u32,
}

impl Texture {
    /// A texture, or an error when a side exceeds the device's limit.
    pub fn new(gpu: &Gpu, label: &str, options: TextureOptions) -> Result<Self, GpuError> {
        let [width, height] = options.size;
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            let reason =
                format!("{label}: a texture of {width} x {height} texels; 1 to {limit} a side are possible");
            return Err(GpuError::Validation(reason));
        }
        let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: options.mips,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: options.format,
            usage: options.usage | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self::from_raw(gpu, raw))
    }

    /// A 3D texture of one level, or an error when a side exceeds the device's limit.
    pub fn volume(
        gpu: &Gpu,
        label: &str,
        [width, height, depth]: [u32; 3],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_3d;
        if [width, height, depth].iter().any(|side| *side == 0 || *side > limit) {
            let reason = format!(
                "{label}: a texture of {width} x {height} x {depth} texels; 1 to {limit} a side are possible"
            );
            return Err(GpuError::Validation(reason));
        }
        let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: depth },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage: usage | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self::from_raw(gpu, raw))
    }

    /// A render target that can also be read in shaders.
    pub fn target(
        gpu: &Gpu,
        label: &str,
        size: [u32; 2],
        format: wgpu::TextureFormat,
    ) -> Result<Self, GpuError> {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        Self::new(gpu, label, TextureOptions { size, format, usage, mips: 1 })
    }

    /// Takes in a texture that the host already has.
    pub fn from_raw(gpu: &Gpu, raw: wgpu::Texture) -> Self {
        let view = raw.create_view(&wgpu::TextureViewDescriptor::default());
        Self { id: gpu.count_created(), raw, view }
    }

    /// One of its mip levels as a texture of its own, to be drawn into or read while others are.
    pub fn level(&self, gpu: &Gpu, level: u32) -> Self {
        let view = self.raw.create_view(&wgpu::TextureViewDescriptor {
            base_mip_level: level,
            mip_level_count: Some(1),
            ..Default::default()
        });
        Self { id: gpu.count_created(), raw: self.raw.clone(), view }
    }

    /// Width and height in texels, of the first level.
    pub fn size(&self) -> [u32; 2] {
        [self.raw.width(), self.raw.height()]
    }
}

/// A sampler with an identity.
#[derive(Debug)]
pub struct Sampler {
    pub(super) id: u64,
    /// The wgpu sampler.
    pub raw: wgpu::Sampler,
}

impl Sampler {
    /// A sampler.
    pub fn new(gpu: &Gpu, descriptor: &wgpu::SamplerDescriptor<'_>) -> Self {
        Self { id: gpu.count_created(), raw: gpu.device.create_sampler(descriptor) }
    }
}
