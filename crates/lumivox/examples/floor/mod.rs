//! What a host draws, in small: a floor at height 0 as a camera sees it, worked out on the CPU.

use lumivox::core::View;
use lumivox::glam::{UVec2, Vec2};
use lumivox::gpu::{Gpu, GpuError, Texture, TextureOptions};
use lumivox::wgpu::{self, TextureFormat, TextureUsages};

/// Depth of the floor at each pixel, and which pixels show it.
pub(crate) struct Floor {
    pub(crate) depth: Texture,
    pub(crate) is_floor: Vec<bool>,
}

impl Floor {
    pub(crate) fn new(gpu: &Gpu, view: &View, size: UVec2) -> Result<Self, GpuError> {
        let world_from_clip = view.clip_from_world.inverse();
        let far = if view.reversed_depth { 0.0 } else { 1.0 };
        let depth_at = |n: u32| {
            let uv = (Vec2::new((n % size.x) as f32, (n / size.x) as f32) + 0.5) / size.as_vec2();
            let ndc = Vec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
            let [a, b] = [0.25, 0.75].map(|depth| world_from_clip.project_point3(ndc.extend(depth)));
            // Away from the eye; a floor behind it is not seen.
            let way = if view.reversed_depth { a - b } else { b - a };
            let reach = -a.y / way.y;
            let place = a + reach * way;
            let clip = view.clip_from_world * place.extend(1.0);
            let depth = clip.z / clip.w;
            if way.y < 0.0 && clip.w > 0.0 && (0.0..=1.0).contains(&depth) { depth } else { far }
        };
        let depths: Vec<f32> = (0..size.x * size.y).map(depth_at).collect();
        let bytes = lumivox::bytemuck::cast_slice(&depths);
        let depth = uploaded(gpu, size, TextureFormat::R32Float, bytes)?;
        Ok(Self { depth, is_floor: depths.iter().map(|d| *d != far).collect() })
    }
}

/// A texture of such texels.
pub(crate) fn uploaded(
    gpu: &Gpu,
    size: UVec2,
    format: TextureFormat,
    texels: &[u8],
) -> Result<Texture, GpuError> {
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let texture =
        Texture::new(gpu, "host", TextureOptions { size: size.to_array(), format, usage, mips: 1 })?;
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texels.len() as u32 / size.y),
        rows_per_image: None,
    };
    gpu.queue.write_texture(texture.raw.as_image_copy(), texels, layout, texture.raw.size());
    Ok(texture)
}
