//! A picture in ever coarser levels, each half as large: what blurred rays look at. Also environments: all directions around in one picture.

use glam::{UVec2, Vec2, Vec3};

use super::PICTURE_FORMAT;
use crate::gpu::{
    Bindings, FullscreenPass, Gpu, GpuError, Sampler, Shader, Texture, TextureOptions, Uniform,
};
use crate::wgsl::{FULLSCREEN, HALF_MAX};

pub(super) const SHADER: Shader =
    Shader { name: "refraction/pyramid", parts: &[FULLSCREEN, include_str!("pyramid.wgsl")] };

/// What lies beyond the left and the right edge of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Its last column goes on.
    Ends,
    /// The other edge: environments.
    Wraps,
}

/// The levels of a picture.
#[derive(Debug)]
pub struct Pyramid {
    pass: FullscreenPass,
    pub(super) sampler: Sampler,
    whole: Texture,
    /// Each level as a texture of its own, which passes draw into, with its size.
    levels: Vec<(Texture, Uniform<PyramidUniform>)>,
}

crate::gpu_struct! {
    /// A level of a [`Pyramid`] as the pass sees it.
    pub struct PyramidUniform {
        /// Its texels.
        pub size: Vec2,
        /// How far look-ups lie from the middle of a pixel, in pixels: none for a copy.
        pub reach: f32,
        /// Unused.
        pub reserved: f32,
    }
}

impl Pyramid {
    /// Levels of a picture of a size, down to a texel.
    ///
    /// # Errors
    /// A size that the device does not have.
    pub fn new(gpu: &Gpu, size: UVec2, edge: Edge) -> Result<Self, GpuError> {
        let mips = 32 - size.max_element().max(1).leading_zeros();
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST;
        let options = TextureOptions { size: size.to_array(), format: PICTURE_FORMAT, usage, mips };
        let whole = Texture::new(gpu, "refraction/pyramid", options)?;
        let level = |n: u32| {
            let size = (size >> UVec2::splat(n)).max(UVec2::ONE).as_vec2();
            let value = PyramidUniform { size, reach: if n == 0 { 0.0 } else { 0.25 }, reserved: 0.0 };
            (whole.level(gpu, n), Uniform::new(gpu, "refraction/level", &value))
        };
        let levels = (0..mips).map(level).collect();
        let address_mode_u = match edge {
            Edge::Ends => wgpu::AddressMode::ClampToEdge,
            Edge::Wraps => wgpu::AddressMode::Repeat,
        };
        let descriptor = wgpu::SamplerDescriptor {
            label: Some("refraction/pyramid"),
            address_mode_u,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        };
        Ok(Self {
            pass: FullscreenPass::new(gpu, &SHADER, PICTURE_FORMAT, false),
            sampler: Sampler::new(gpu, &descriptor),
            whole,
            levels,
        })
    }

    /// All directions around: radiance in W/(m2 sr), row by row from straight up to straight down, the middle column towards -z and
    /// +x to the right of it.
    ///
    /// # Errors
    /// Another number of pixels than `size` says, or a size that the device does not have.
    pub fn environment(gpu: &Gpu, size: UVec2, pixels: &[Vec3]) -> Result<Self, GpuError> {
        if pixels.len() as u64 != u64::from(size.x) * u64::from(size.y) {
            let count = pixels.len();
            return Err(GpuError::Validation(format!(
                "an environment of {} x {} pixels with {count} colours",
                size.x, size.y
            )));
        }
        let mut pyramid = Self::new(gpu, size, Edge::Wraps)?;
        let half = |c: f32| half::f16::from_f32(c.clamp(0.0, HALF_MAX));
        let texels: Vec<[half::f16; 4]> =
            pixels.iter().map(|p| [half(p.x), half(p.y), half(p.z), half::f16::ONE]).collect();
        gpu.queue.write_texture(
            pyramid.whole.raw.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * size.x), rows_per_image: None },
            wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        );
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        pyramid.record_levels(gpu, &mut encoder)?;
        gpu.queue.submit([encoder.finish()]);
        Ok(pyramid)
    }

    /// Takes a picture over, and makes its levels.
    ///
    /// # Errors
    /// The device's.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Texture,
    ) -> Result<(), GpuError> {
        if let Some((first, uniform)) = self.levels.first_mut() {
            let bindings = Bindings::new()
                .read("finer", picture)
                .read("linear", &self.sampler)
                .read("pyramid", &*uniform);
            self.pass.record(gpu, encoder, &bindings, first, false)?;
        }
        self.record_levels(gpu, encoder)
    }

    /// Makes all levels of the first.
    fn record_levels(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), GpuError> {
        for level in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            let (Some((finer, _)), Some((coarser, uniform))) = (finer.last(), coarser.first_mut()) else {
                continue;
            };
            let bindings =
                Bindings::new().read("finer", finer).read("linear", &self.sampler).read("pyramid", &*uniform);
            self.pass.record(gpu, encoder, &bindings, coarser, false)?;
        }
        Ok(())
    }

    /// The levels as one texture.
    pub fn texture(&self) -> &Texture {
        &self.whole
    }

    /// One of its levels, for reading.
    pub fn level(&self, level: usize) -> Option<&Texture> {
        self.levels.get(level).map(|(texture, _)| texture)
    }
}
