//! What the cells of a dense volume lie in.

use glam::Vec4;
use half::f16;
use lumivox_core::{Grid, HostVolume};

use crate::VolumeBuffer;
use crate::gpu::{Gpu, GpuError, Texture, Uniform, read_texture};
use crate::progressive::AttributeChannel;
use crate::volume::ChannelFormat;
use crate::wgsl::GridUniform;

use super::Storage;

#[derive(Debug)]
pub(super) enum Store {
    Buffers(VolumeBuffer),
    /// A texture of each channel, and those that cleanup writes next.
    Textures {
        grid: Uniform<GridUniform>,
        current: Vec<Texture>,
        other: Vec<Texture>,
    },
}

impl Store {
    pub(super) fn new(
        gpu: &Gpu,
        grid: Grid,
        channels: &[AttributeChannel],
        storage: Storage,
    ) -> Result<Self, GpuError> {
        if storage == Storage::Buffers {
            let formats: Vec<_> = channels.iter().map(|c| ChannelFormat::half4(&c.name)).collect();
            return Ok(Self::Buffers(VolumeBuffer::with_formats(gpu, grid, &formats)?));
        }
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
        let format = wgpu::TextureFormat::Rgba16Float;
        let make = |state: &str| -> Result<Vec<Texture>, GpuError> {
            let of = |c: &AttributeChannel| {
                let label = format!("dense/{}, {state}", c.name);
                Texture::volume(gpu, &label, grid.dims.to_array(), format, usage)
            };
            channels.iter().map(of).collect()
        };
        let (current, other) = (make("one")?, make("other")?);
        let grid = Uniform::new(gpu, "dense/grid", &GridUniform::from(&grid));
        Ok(Self::Textures { grid, current, other })
    }

    pub(super) fn grid_uniform(&self) -> &Uniform<GridUniform> {
        match self {
            Self::Buffers(volume) => volume.grid_uniform(),
            Self::Textures { grid, .. } => grid,
        }
    }

    pub(super) fn read_back(
        &self,
        gpu: &Gpu,
        grid: &Grid,
        channels: &[AttributeChannel],
    ) -> Result<HostVolume, GpuError> {
        let textures = match self {
            Self::Buffers(volume) => return volume.read_back(gpu),
            Self::Textures { current, .. } => current,
        };
        let mut volume = HostVolume::new(*grid);
        for (channel, texture) in channels.iter().zip(textures) {
            let texels: Vec<[f16; 4]> = read_texture(gpu, texture)?;
            let values = texels.into_iter().map(|v| Vec4::from_array(v.map(f16::to_f32)));
            volume.insert(&channel.name, values.collect());
        }
        Ok(volume)
    }
}
