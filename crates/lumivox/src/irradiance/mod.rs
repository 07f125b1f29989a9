//! The light in the space of a volume, for every other shader of a host: forward-shaded and transparent surfaces, particles, fog.
//!
//! [`IrradianceVolume`] is three 3D textures, one for each colour, that hold the light that arrives from all around at points of a
//! coarse lattice, as spherical harmonics of bands 0 and 1. Any [`IrradianceSource`] fills it. A host
//! puts [`irradiance_wgsl`] before its own shader and binds the volume beside its own resources; nothing else of this crate is
//! needed there:
//!
//! ```wgsl
//! let diffuse = albedo / 3.14159 * lumivox_irradiance(position, normal);
//! let fog_color = lumivox_mean_radiance(position);
//! ```
//!
//! Pixels of a G-buffer are better served by
//! [`record_reconstruction`](crate::gather::GatheredLight::record_reconstruction), which knows each surface of each cell. Here light is smooth
//! over the spacing of the lattice, and of two bands: from a single bright direction a surface that faces it gets the right
//! irradiance within a quarter, one that faces away a little where there should be none (clamped at zero).
//!
//! **Walls.** A surface asks one spacing before itself, where all points of the lattice that are blended lie on its own side. So walls
//! leak no light however thin they are, and what is nearer to the surface than a spacing does not shade it. Points without
//! a normal blend what is around them; within a spacing of a thin wall that is light from both of its sides.
//!
//! Memory: 24 bytes for each point of the lattice; at 64 cells and a spacing of 2 cells, 0.8 MB.

mod from_cells;

use std::num::NonZero;

use glam::{UVec3, Vec3};
use lumivox_core::Grid;

use crate::gpu::{Bindings, Gpu, GpuError, Sampler, Shader, Texture, Uniform, renumbered};
use crate::volume::VolumeBuffer;

pub(crate) use from_cells::{FromCells, LPV, PROPAGATED};

/// What a host's shader calls, with its bindings in group 0 from 0 on.
pub const QUERIES: &str = include_str!("irradiance.wgsl");
/// Bindings that the queries take.
pub const BINDING_COUNT: u32 = 5;
/// Format of the textures: constant, x, y, z.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The shared shader part of passes that fill volumes of light.
pub(crate) const LATTICE: &str = include_str!("lattice.wgsl");

/// For validation.
const SHADER: Shader = Shader { name: "irradiance/queries", parts: &[QUERIES] };

crate::gpu_struct! {
    /// Where the lattice lies.
    pub struct LumivoxIrradianceUniform {
        /// Lowest corner in metres.
        pub origin: Vec3,
        /// Metres between points.
        pub spacing: f32,
        /// Size of the lattice in metres.
        pub extent: Vec3,
        /// Unused.
        pub reserved: f32,
    }
}

crate::gpu_struct! {
    /// Which points of a volume of light are filled, and how.
    pub struct LatticeUniform {
        /// Points along x, y, z.
        pub dims: UVec3,
        /// Cells between points.
        pub spacing: u32,
        /// The first point of this frame.
        pub first: u32,
        /// How many follow.
        pub count: u32,
        /// Rays of a point.
        pub rays: u32,
        /// Unused.
        pub reserved: u32,
    }
}

/// A way of light that fills an [`IrradianceVolume`]: [`IndirectLight`](crate::light::IndirectLight),
/// [`LightPropagationVolume`](crate::lpv::LightPropagationVolume) and [`GatheredLight`](crate::gather::GatheredLight). All hold the same
/// there, radiance from surfaces and sky without the light that comes straight from lamps, so that a host's shaders need not know
/// which it was.
pub trait IrradianceSource {
    /// Fills the `slice`-th of `slices` parts of an irradiance volume over this volume's grid. `rays` of each point, 1 to 1024, are
    /// for the ways that trace some.
    ///
    /// # Errors
    /// What the device refuses, and [`IndirectLight`](crate::light::IndirectLight) that keeps no light in free space.
    fn record_irradiance_volume(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        volume: &VolumeBuffer,
        target: &mut IrradianceVolume,
        part: (u32, u32, u32),
    ) -> Result<(), GpuError>;
}

/// Light at the points of a lattice over a grid.
#[derive(Debug)]
pub struct IrradianceVolume {
    /// Radiance from all around, for red, green and blue: constant, x, y, z.
    pub(crate) textures: [Texture; 3],
    /// Points along x, y, z.
    pub(crate) dims: UVec3,
    /// Cells between points.
    pub(crate) spacing: u32,
    uniform: Uniform<LumivoxIrradianceUniform>,
    sampler: Sampler,
}

impl IrradianceVolume {
    /// A dark lattice with a point in the middle of every `spacing` x `spacing` x `spacing` cells, 1 to 8.
    ///
    /// # Errors
    /// When a side has more points than a 3D texture may have texels.
    pub fn new(gpu: &Gpu, grid: &Grid, spacing: u32) -> Result<Self, GpuError> {
        let spacing = spacing.clamp(1, 8);
        let dims = (grid.dims + spacing - 1) / spacing;
        let limit = gpu.device.limits().max_texture_dimension_3d;
        if dims.max_element() > limit {
            let reason = format!(
                "an irradiance volume of {dims} points; at most {limit} a side are possible, with a larger spacing"
            );
            return Err(GpuError::Validation(reason));
        }
        let texture = |label| {
            let size = wgpu::Extent3d { width: dims.x, height: dims.y, depth_or_array_layers: dims.z };
            let usage = wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC;
            let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: FORMAT,
                usage,
                view_formats: &[],
            });
            Texture::from_raw(gpu, raw)
        };
        let metres = spacing as f32 * grid.cell_size;
        let place = LumivoxIrradianceUniform {
            origin: grid.origin,
            spacing: metres,
            extent: metres * dims.as_vec3(),
            reserved: 0.0,
        };
        let linear = wgpu::SamplerDescriptor {
            label: Some("irradiance"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        };
        Ok(Self {
            textures: ["irradiance/red", "irradiance/green", "irradiance/blue"].map(texture),
            dims,
            spacing,
            uniform: Uniform::new(gpu, "irradiance", &place),
            sampler: Sampler::new(gpu, &linear),
        })
    }

    /// Points of the lattice along x, y, z.
    pub fn dims(&self) -> UVec3 {
        self.dims
    }

    /// The textures of red, green and blue: the light from all around in W/(m2 sr) as spherical harmonics, constant, x, y, z.
    pub fn textures(&self) -> &[Texture; 3] {
        &self.textures
    }

    /// The `slice`-th of `slices` parts, with `rays` of each point.
    pub(crate) fn part(&self, (rays, slice, slices): (u32, u32, u32)) -> LatticeUniform {
        let points = self.dims.element_product();
        let part = points.div_ceil(slices.max(1));
        let first = slice.saturating_mul(part).min(points);
        let count = part.min(points - first);
        LatticeUniform { dims: self.dims, spacing: self.spacing, first, count, rays, reserved: 0 }
    }

    /// Binds it for a pass of [`crate::gpu`] whose shader has [`QUERIES`] among its parts.
    pub fn bind<'a>(&'a self, bindings: Bindings<'a>) -> Bindings<'a> {
        let [red, green, blue] = &self.textures;
        bindings
            .read("lumivox_lattice", &self.uniform)
            .read("lumivox_sampler", &self.sampler)
            .read("lumivox_red", red)
            .read("lumivox_green", green)
            .read("lumivox_blue", blue)
    }

    /// What a host's bind group takes, from binding `first` on.
    pub fn bind_group_entries(&self, first: u32) -> [wgpu::BindGroupEntry<'_>; BINDING_COUNT as usize] {
        let resource = |n: usize| match n {
            0 => self.uniform.binding(),
            1 => wgpu::BindingResource::Sampler(&self.sampler.raw),
            n => wgpu::BindingResource::TextureView(&self.textures[n - 2].view),
        };
        std::array::from_fn(|n| wgpu::BindGroupEntry { binding: first + n as u32, resource: resource(n) })
    }
}

/// The functions `lumivox_irradiance`, `lumivox_irradiance_at` and `lumivox_mean_radiance` with their bindings, in `group` from binding
/// `first` on: one uniform, one sampler and three textures. Plain WGSL for any stage; all names begin with `lumivox_` or
/// `Lumivox`.
pub fn irradiance_wgsl(group: u32, first: u32) -> String {
    renumbered(QUERIES, group, first)
}

/// The layout of those bindings.
pub fn layout_entries(
    first: u32,
    visibility: wgpu::ShaderStages,
) -> [wgpu::BindGroupLayoutEntry; BINDING_COUNT as usize] {
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D3,
        multisampled: false,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZero::new(size_of::<LumivoxIrradianceUniform>() as u64),
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let kinds = [uniform, sampler, texture, texture, texture];
    std::array::from_fn(|n| wgpu::BindGroupLayoutEntry {
        binding: first + n as u32,
        visibility,
        ty: kinds[n],
        count: None,
    })
}

pub(crate) fn shaders() -> Vec<Shader> {
    vec![SHADER, from_cells::PROPAGATED, from_cells::LPV]
}
