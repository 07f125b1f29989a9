//! Ambient occlusion (dissertation 4.5.1, Algorithm 3): the share of the light from above a pixel's surface that objects let
//! through.

use glam::UVec2;

use super::denoise::Denoise;
use super::tiled_pass::TiledPass;
use super::tiles::{self, Cull, Round, Tiles};
use super::{FACTOR_FORMAT, FIELD, Fields, OBJECT, Objects, Receiver, SAMPLING, TILE, TILE_QUAD, blending};
use crate::gpu::{Gpu, GpuError, Shader, Texture, Uniform};
use crate::wgsl::VIEW;

pub(super) const SHADER: Shader = Shader {
    name: "visibility/occlusion",
    parts: &[VIEW, OBJECT, FIELD, SAMPLING, TILE, TILE_QUAD, include_str!("occlusion.wgsl")],
};

/// How objects come together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Combine {
    /// Each ray counts the nearest of its hits.
    #[default]
    Nearest,
    /// Each object takes its part, whatever others took already, as the papers' passes with subtractive blending do. Too dark
    /// where objects stand behind each other.
    Subtract,
}

/// What ambient occlusion is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OcclusionSettings {
    /// Rays per pixel, 1 to 1024. With denoising 16 times as many count.
    pub rays: u32,
    /// Metres beyond which a hit takes no light; infinite for none. `V` of equation 3 is
    /// `1 - (1 - distance / reach)^exponent`.
    pub reach: f32,
    /// Exponent of that. With an infinite reach any hit takes all of a ray.
    pub exponent: f32,
    /// Objects that cover less than this share of a pixel's hemisphere are left out there.
    pub least_share: f32,
    /// How objects come together.
    pub combine: Combine,
    /// Whether three maps answer for a ray: less grain for three times the look-ups.
    pub blended: bool,
    /// Whether the patterns of neighbouring pixels are put together.
    pub denoise: bool,
}

impl Default for OcclusionSettings {
    fn default() -> Self {
        Self {
            rays: 16,
            reach: f32::INFINITY,
            exponent: 1.0,
            least_share: 1.0 / 512.0,
            combine: Combine::Nearest,
            blended: false,
            denoise: true,
        }
    }
}

crate::gpu_struct! {
    /// [`OcclusionSettings`] as shaders see them.
    pub struct OcclusionUniform {
        /// Rays per pixel.
        pub rays: u32,
        /// Whether each caster is subtracted by itself.
        pub subtracts: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_3: u32,
        /// One over the reach.
        pub inverse_reach: f32,
        /// Exponent of the falloff.
        pub exponent: f32,
        /// Unused.
        pub reserved_1: u32,
        /// Unused.
        pub reserved_2: u32,
    }
}

/// The passes of ambient occlusion, for pictures of one size.
#[derive(Debug)]
pub struct Occlusion {
    cull: Cull,
    pass: TiledPass,
    denoise: Denoise,
    tiles: Tiles,
    uniform: Uniform<OcclusionUniform>,
    settings: OcclusionSettings,
    noisy: Texture,
    factor: Texture,
}

impl Occlusion {
    /// Compiles the passes and makes room for a picture of `size` texels and the objects that `objects` has room for.
    ///
    /// # Errors
    /// A size that the device refuses.
    pub fn new(
        gpu: &Gpu,
        size: UVec2,
        objects: &Objects,
        settings: OcclusionSettings,
    ) -> Result<Self, GpuError> {
        let settings = OcclusionSettings {
            rays: settings.rays.clamp(1, 1024),
            reach: if settings.reach > 0.0 { settings.reach } else { f32::INFINITY },
            exponent: settings.exponent.clamp(1e-3, 1e3),
            least_share: settings.least_share.clamp(1e-8, 1.0),
            ..settings
        };
        let uniform = OcclusionUniform {
            rays: settings.rays,
            subtracts: u32::from(settings.combine == Combine::Subtract),
            reserved_0: 0,
            reserved_3: 0,
            inverse_reach: 1.0 / settings.reach,
            exponent: settings.exponent,
            reserved_1: 0,
            reserved_2: 0,
        };
        let target = |name: &str| Texture::target(gpu, name, size.to_array(), FACTOR_FORMAT);
        Ok(Self {
            cull: Cull::new(gpu, &tiles::SHADER),
            pass: TiledPass::new(gpu, &SHADER, FACTOR_FORMAT, &blending(settings.blended)),
            denoise: Denoise::new(gpu, FACTOR_FORMAT),
            tiles: Tiles::new(gpu, size, objects.capacity)?,
            uniform: Uniform::new(gpu, "visibility/occlusion", &uniform),
            settings,
            noisy: target("visibility/occlusion, noisy")?,
            factor: target("visibility/occlusion")?,
        })
    }

    /// Begins a frame, after [`Objects::update`].
    pub fn update(&self, gpu: &Gpu, objects: &Objects) {
        let OcclusionSettings { reach, least_share, .. } = self.settings;
        // A sphere of radius R at the distance D covers (R / D)^2 of a hemisphere at most.
        self.tiles.update(gpu, objects, Round::Surface { reach, radii: least_share.sqrt().recip() });
    }

    /// Records the passes for the pixels of a G-buffer of the size that this was made for.
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
    ) -> Result<(), GpuError> {
        receiver.check(self.tiles.size())?;
        let Self { cull, pass, denoise, tiles, uniform, settings, noisy, factor } = self;
        cull.record(gpu, encoder, receiver, objects, None, tiles)?;
        let bindings = fields
            .bind(objects)
            .read("view", receiver.uniform)
            .read("tiles", &tiles.uniform)
            .read("occlusion", &*uniform)
            .read("depth", receiver.depth)
            .read("normal", receiver.normal)
            .read("tile_list", &tiles.list)
            .read("tile_masks", &tiles.masks);
        let first = if settings.denoise { &mut *noisy } else { &mut *factor };
        pass.record(gpu, encoder, &bindings, tiles, (first, wgpu::Color::WHITE))?;
        if settings.denoise {
            denoise.record(gpu, encoder, receiver, tiles, noisy, (factor, wgpu::Color::WHITE))?;
        }
        Ok(())
    }

    /// The visibility of each pixel, 0 to 1, in red: what ambient light is multiplied by. [`FACTOR_FORMAT`].
    pub fn factor(&self) -> &Texture {
        &self.factor
    }

    /// Tiles of 8 x 8 pixels that the last frame drew. Waits.
    pub fn read_drawn_tiles(&self, gpu: &Gpu) -> Result<u32, GpuError> {
        self.tiles.read_drawn(gpu)
    }
}
