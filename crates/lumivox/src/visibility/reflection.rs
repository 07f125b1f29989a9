//! Polished reflections (dissertation 4.5.2 and 4.7.2, Figures 46 and 47): what a pixel's surface mirrors of the objects, along
//! several rays of its lobe.

use glam::UVec2;

use super::denoise::Denoise;
use super::hit_light::{HitLight, HitLightUniform};
use super::tiled_pass::TiledPass;
use super::tiles::{Cull, Round, Tiles};
use super::{
    CULL, FIELD, Fields, HIT_LIGHT, LOBE, NORMAL, OBJECT, Objects, Receiver, SAMPLING, TILE, TILE_QUAD,
    blending,
};
use crate::gpu::{Gpu, GpuError, Shader, Texture, TextureOptions, Uniform};
use crate::wgsl::{OCTAHEDRON, VIEW};

pub(super) const SHADER: Shader = Shader {
    name: "visibility/reflection",
    parts: &[
        VIEW,
        OBJECT,
        FIELD,
        OCTAHEDRON,
        NORMAL,
        SAMPLING,
        LOBE,
        TILE,
        TILE_QUAD,
        HIT_LIGHT,
        include_str!("reflection.wgsl"),
    ],
};
pub(super) const CULL_SHADER: Shader = Shader {
    name: "visibility/cull mirrored",
    parts: &[VIEW, OBJECT, TILE, SAMPLING, LOBE, CULL, include_str!("cull_mirrored.wgsl")],
};

/// Format of reflections.
pub const REFLECTION_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// What reflections are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReflectionSettings {
    /// Rays per pixel, 1 to 64. With denoising 16 times as many count.
    pub rays: u32,
    /// Roughness of every surface, 0 to 1, unless a texture says it per pixel: the square root of GGX's width. Surfaces of 1 are
    /// matt and cost nothing. With a texture, about that of most.
    pub roughness: f32,
    /// Whether three maps answer for a ray.
    pub blended: bool,
    /// Whether the patterns of neighbouring pixels are put together. Mirrors are sharper without.
    pub denoise: bool,
}

impl ReflectionSettings {
    /// From this roughness on denoising goes over the picture twice. Lobes as wide meet the rims of objects one ray after the
    /// other, in steps that one mean over a block leaves; narrower ones would be blurred.
    pub const WIDE: f32 = 0.25;
}

impl Default for ReflectionSettings {
    fn default() -> Self {
        Self { rays: 4, roughness: 0.2, blended: false, denoise: true }
    }
}

crate::gpu_struct! {
    /// [`ReflectionSettings`] as shaders see them.
    pub struct ReflectionUniform {
        /// Rays per pixel.
        pub rays: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
        /// Unused.
        pub reserved_2: u32,
    }
}

/// The passes of reflections, for pictures of one size.
///
/// Rays go by the microfacets of GGX's distribution, without its steepest twentieth, and count by Smith's masking; together they
/// count one. A host multiplies [`Reflections::color`] by what its surface reflects (Fresnel's share), and adds what else its
/// surface mirrors to the part that met no object, `1 - alpha`.
#[derive(Debug)]
pub struct Reflections {
    cull: Cull,
    pass: TiledPass,
    denoise: Denoise,
    tiles: Tiles,
    uniform: Uniform<ReflectionUniform>,
    light: Uniform<HitLightUniform>,
    settings: ReflectionSettings,
    /// The roughness of all, where no texture says it.
    roughness: Texture,
    noisy: Texture,
    color: Texture,
}

impl Reflections {
    /// Compiles the passes and makes room for a picture of `size` texels and the objects that `objects` has room for.
    ///
    /// # Errors
    /// A size that the device refuses.
    pub fn new(
        gpu: &Gpu,
        size: UVec2,
        objects: &Objects,
        settings: ReflectionSettings,
    ) -> Result<Self, GpuError> {
        let rays = settings.rays.clamp(1, 64);
        let settings = ReflectionSettings { rays, roughness: settings.roughness.clamp(0.0, 1.0), ..settings };
        let uniform = ReflectionUniform { rays, reserved_0: 0, reserved_1: 0, reserved_2: 0 };
        let target = |name: &str| Texture::target(gpu, name, size.to_array(), REFLECTION_FORMAT);
        Ok(Self {
            cull: Cull::new(gpu, &CULL_SHADER),
            pass: TiledPass::new(gpu, &SHADER, REFLECTION_FORMAT, &blending(settings.blended)),
            denoise: if settings.denoise && settings.roughness >= ReflectionSettings::WIDE {
                Denoise::twice(gpu, REFLECTION_FORMAT, size)?
            } else {
                Denoise::new(gpu, REFLECTION_FORMAT)
            },
            tiles: Tiles::new(gpu, size, objects.capacity)?,
            uniform: Uniform::new(gpu, "visibility/reflection", &uniform),
            light: Uniform::new(gpu, "visibility/hit light", &bytemuck::Zeroable::zeroed()),
            settings,
            roughness: one_texel(gpu, settings.roughness)?,
            noisy: target("visibility/reflection, noisy")?,
            color: target("visibility/reflection")?,
        })
    }

    /// Begins a frame, after [`Objects::update`], and says what shines on the objects.
    pub fn update(&self, gpu: &Gpu, objects: &Objects, light: &HitLight) {
        self.tiles.update(gpu, objects, Round::Mirrored);
        self.light.write(gpu, &light.uniform());
    }

    /// Records the passes for the pixels of a G-buffer of the size that this was made for. `roughness` says how rough each pixel's
    /// surface is, in red; of any size, its last texels go on.
    ///
    /// # Errors
    /// A G-buffer of another size, and the device's failure.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        fields: &Fields,
        objects: &Objects,
        receiver: &Receiver<'_>,
        roughness: Option<&Texture>,
    ) -> Result<(), GpuError> {
        receiver.check(self.tiles.size())?;
        let Self { cull, pass, denoise, tiles, uniform, light, settings, roughness: all, noisy, color } =
            self;
        let roughness = roughness.unwrap_or(all);
        cull.record(gpu, encoder, receiver, objects, Some(roughness), tiles)?;
        let bindings = fields
            .bind(objects)
            .read("view", receiver.uniform)
            .read("tiles", &tiles.uniform)
            .read("reflection", &*uniform)
            .read("hit_light", &*light)
            .read("depth", receiver.depth)
            .read("normal", receiver.normal)
            .read("roughness", roughness)
            .read("field_normals", &fields.normals)
            .read("tile_list", &tiles.list)
            .read("tile_masks", &tiles.masks);
        let first = if settings.denoise { &mut *noisy } else { &mut *color };
        pass.record(gpu, encoder, &bindings, tiles, (first, wgpu::Color::TRANSPARENT))?;
        if settings.denoise {
            denoise.record(gpu, encoder, receiver, tiles, noisy, (color, wgpu::Color::TRANSPARENT))?;
        }
        Ok(())
    }

    /// What each pixel mirrors of the objects: radiance, and in alpha the part of its rays that met any. [`REFLECTION_FORMAT`].
    pub fn color(&self) -> &Texture {
        &self.color
    }

    /// Tiles of 8 x 8 pixels that the last frame drew. Waits.
    pub fn read_drawn_tiles(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        self.tiles.read_drawn(gpu)
    }
}

fn one_texel(gpu: &Gpu, value: f32) -> Result<Texture, GpuError> {
    let options = TextureOptions {
        size: [1, 1],
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        mips: 1,
    };
    let texture = Texture::new(gpu, "visibility/roughness", options)?;
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: None, rows_per_image: None };
    gpu.queue.write_texture(texture.raw.as_image_copy(), &value.to_le_bytes(), layout, texture.raw.size());
    Ok(texture)
}
