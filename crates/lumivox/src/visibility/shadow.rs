//! Soft shadows (dissertation 4.7.2): the share of a light of finite size that each pixel sees past the objects.

use glam::{UVec2, Vec3};

use super::denoise::Denoise;
use super::tiled_pass::TiledPass;
use super::tiles::{self, Cull, Round, Tiles};
use super::{FACTOR_FORMAT, FIELD, Fields, OBJECT, Objects, Receiver, SAMPLING, TILE, TILE_QUAD, blending};
use crate::gpu::{Gpu, GpuError, Shader, Texture, Uniform};
use crate::wgsl::VIEW;

pub(super) const SHADER: Shader = Shader {
    name: "visibility/shadow",
    parts: &[VIEW, OBJECT, FIELD, SAMPLING, TILE, TILE_QUAD, include_str!("shadow.wgsl")],
};

/// A light of finite size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShadowLight {
    /// A point or spot light: a ball. Its pixels see a disk of it.
    Ball {
        /// Its middle.
        position: Vec3,
        /// Its radius in metres; a hard shadow with 0.
        radius: f32,
    },
    /// A parallelogram `origin + s u + t v` that shines along `u x v`.
    Rect {
        /// A corner.
        origin: Vec3,
        /// First edge.
        u: Vec3,
        /// Second edge.
        v: Vec3,
    },
    /// A light so far away that it has a direction alone.
    Sun {
        /// The way its light travels.
        direction: Vec3,
        /// Half of the angle that it is seen under, radians below a quarter turn.
        angle: f32,
    },
}

/// What soft shadows are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowSettings {
    /// Rays per pixel and light, 1 to 1024. With denoising 16 times as many count.
    pub rays: u32,
    /// Whether three maps answer for a ray.
    pub blended: bool,
    /// Whether the patterns of neighbouring pixels are put together.
    pub denoise: bool,
}

impl Default for ShadowSettings {
    fn default() -> Self {
        Self { rays: 16, blended: false, denoise: true }
    }
}

crate::gpu_struct! {
    /// A [`ShadowLight`] and [`ShadowSettings`] as shaders see them.
    pub struct ShadowUniform {
        /// Corner, middle, or the way to a sun.
        pub position: Vec3,
        /// Radius in metres, or the tangent of an angle.
        pub radius: f32,
        /// First edge.
        pub u: Vec3,
        /// Which kind of light.
        pub kind: u32,
        /// Second edge.
        pub v: Vec3,
        /// Rays per pixel.
        pub rays: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_3: u32,
        /// Unused.
        pub reserved_1: u32,
        /// Unused.
        pub reserved_2: u32,
    }
}

/// The passes of soft shadows, for pictures of one size and a number of lights.
#[derive(Debug)]
pub struct SoftShadows {
    cull: Cull,
    pass: TiledPass,
    denoise: Denoise,
    lights: Vec<LightTarget>,
    settings: ShadowSettings,
    noisy: Texture,
}

/// What is kept for each light.
#[derive(Debug)]
struct LightTarget {
    tiles: Tiles,
    uniform: Uniform<ShadowUniform>,
    factor: Texture,
}

impl SoftShadows {
    /// Compiles the passes and makes room for `lights` lights in a picture of `size` texels.
    ///
    /// # Errors
    /// A size that the device refuses.
    pub fn new(
        gpu: &Gpu,
        size: UVec2,
        objects: &Objects,
        lights: usize,
        settings: ShadowSettings,
    ) -> Result<Self, GpuError> {
        let settings = ShadowSettings { rays: settings.rays.clamp(1, 1024), ..settings };
        let target = |name: &str| Texture::target(gpu, name, size.to_array(), FACTOR_FORMAT);
        let light = |_| {
            Ok(LightTarget {
                tiles: Tiles::new(gpu, size, objects.capacity)?,
                uniform: Uniform::new(gpu, "visibility/shadow", &bytemuck::Zeroable::zeroed()),
                factor: target("visibility/shadow")?,
            })
        };
        Ok(Self {
            cull: Cull::new(gpu, &tiles::SHADER),
            pass: TiledPass::new(gpu, &SHADER, FACTOR_FORMAT, &blending(settings.blended)),
            denoise: Denoise::new(gpu, FACTOR_FORMAT),
            lights: (0..lights).map(light).collect::<Result<_, GpuError>>()?,
            settings,
            noisy: target("visibility/shadow, noisy")?,
        })
    }

    /// Says where the lights are in this frame, after [`Objects::update`]. Lights beyond the number that there is room for are
    /// passed over.
    pub fn update(&self, gpu: &Gpu, objects: &Objects, lights: &[ShadowLight]) {
        for (target, light) in self.lights.iter().zip(lights) {
            let (uniform, round) = self.uniform(light);
            target.uniform.write(gpu, &uniform);
            target.tiles.update(gpu, objects, round);
        }
    }

    fn uniform(&self, light: &ShadowLight) -> (ShadowUniform, Round) {
        let mut uniform: ShadowUniform = bytemuck::Zeroable::zeroed();
        uniform.rays = self.settings.rays;
        let round = match *light {
            ShadowLight::Ball { position, radius } => {
                (uniform.position, uniform.radius) = (position, radius.max(0.0));
                Round::Light { middle: position, radius: radius.max(0.0) }
            }
            ShadowLight::Rect { origin, u, v } => {
                (uniform.position, uniform.u, uniform.v, uniform.kind) = (origin, u, v, 1);
                let radius = 0.5 * (u + v).length().max((u - v).length());
                Round::Light { middle: origin + 0.5 * (u + v), radius }
            }
            ShadowLight::Sun { direction, angle } => {
                let way = direction.try_normalize().map_or(Vec3::Y, |d| -d);
                let slope = angle.clamp(0.0, 1.5).tan();
                (uniform.position, uniform.radius, uniform.kind) = (way, slope, 2);
                Round::Sun { way, slope }
            }
        };
        (uniform, round)
    }

    /// Records the passes of all lights for the pixels of a G-buffer of the size that this was made for.
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
        let Self { cull, pass, denoise, lights, settings, noisy } = self;
        for LightTarget { tiles, uniform, factor } in lights {
            receiver.check(tiles.size())?;
            cull.record(gpu, encoder, receiver, objects, None, tiles)?;
            let bindings = fields
                .bind(objects)
                .read("view", receiver.uniform)
                .read("tiles", &tiles.uniform)
                .read("shadow", &*uniform)
                .read("depth", receiver.depth)
                .read("normal", receiver.normal)
                .read("tile_list", &tiles.list)
                .read("tile_masks", &tiles.masks);
            let first = if settings.denoise { &mut *noisy } else { &mut *factor };
            pass.record(gpu, encoder, &bindings, tiles, (first, wgpu::Color::WHITE))?;
            if settings.denoise {
                denoise.record(gpu, encoder, receiver, tiles, noisy, (factor, wgpu::Color::WHITE))?;
            }
        }
        Ok(())
    }

    /// The share of a light that each pixel sees, 0 to 1, in red: what its light is multiplied by. [`FACTOR_FORMAT`]. `None` for
    /// a light that there is no room for.
    pub fn factor(&self, light: usize) -> Option<&Texture> {
        self.lights.get(light).map(|l| &l.factor)
    }

    /// Tiles of 8 x 8 pixels that the last frame drew for a light; none for one that is not there. Waits.
    pub fn read_drawn_tiles(&self, gpu: &Gpu, light: usize) -> Result<u32, GpuError> {
        self.lights.get(light).map_or(Ok(0), |l| l.tiles.read_drawn(gpu))
    }
}
