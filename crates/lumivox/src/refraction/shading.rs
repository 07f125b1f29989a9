//! What is seen through glass: a bent, blurred and weakened look at what is behind.

use glam::{UVec2, Vec3};
use lumivox_core::View;

use super::surface::Surface;
use super::{Backdrop, Glass, GlassUniform, PICTURE_FORMAT, Pyramid, RefractionSettings, RefractionUniform};
use crate::gpu::{Bindings, FullscreenPass, Gpu, GpuError, Shader, Texture, Uniform};
use crate::slicemap::MAX_KINDS;
use crate::wgsl::{FULLSCREEN, PACK, VIEW};

pub(super) const SHADER: Shader =
    Shader { name: "refraction/shading", parts: &[VIEW, PACK, FULLSCREEN, include_str!("shading.wgsl")] };

#[derive(Debug)]
pub(super) struct Shading {
    pass: FullscreenPass,
    uniform: Uniform<RefractionUniform>,
    value: RefractionUniform,
    size: UVec2,
}

impl Shading {
    pub(super) fn new(gpu: &Gpu, settings: &RefractionSettings) -> Self {
        let value = RefractionUniform {
            kinds: [GlassUniform::from(&Glass::default()); MAX_KINDS as usize],
            pixel_angle: 1e-3,
            uses_picture: u32::from(settings.uses_picture),
            kind_count: settings.kinds,
            reserved: 0,
        };
        let uniform = Uniform::new(gpu, "refraction/shading", &value);
        let pass = FullscreenPass::new(gpu, &SHADER, PICTURE_FORMAT, false);
        Self { pass, uniform, value, size: settings.size }
    }

    pub(super) fn set_view(&mut self, gpu: &Gpu, view: &View) {
        self.value.pixel_angle = pixel_angle(view, self.size);
        self.uniform.write(gpu, &self.value);
    }

    pub(super) fn set_glass(&mut self, gpu: &Gpu, kinds: &[Glass; MAX_KINDS as usize]) {
        self.value.kinds = kinds.each_ref().map(GlassUniform::from);
        self.uniform.write(gpu, &self.value);
    }

    /// Whether a kind has no thickness; not for kinds that there are not.
    pub(super) fn is_thin(&self, kind: u32) -> bool {
        self.value.kinds.get(kind as usize).is_some_and(|glass| glass.is_thin != 0)
    }

    pub(super) fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (surface, thickness): (&Surface, &Texture),
        backdrop: &Backdrop<'_>,
        [background, environment]: [&Pyramid; 2],
        target: &mut Texture,
    ) -> Result<(), GpuError> {
        let bindings = Bindings::new()
            .read("view", backdrop.uniform)
            .read("refraction", &self.uniform)
            .read("depth", backdrop.depth)
            .read("picture", backdrop.picture)
            .read("glass_normal", &surface.normal)
            .read("glass_depth", &surface.depth)
            .read("thickness", thickness)
            .read("background", background.texture())
            .read("background_sampler", &background.sampler)
            .read("environment", environment.texture())
            .read("environment_sampler", &environment.sampler);
        self.pass.record(gpu, encoder, &bindings, target, false)
    }
}

/// Between the middle of a picture and the pixel beside it; of parallel views, which look the same way everywhere, that of a
/// camera of 45 degrees.
fn pixel_angle(view: &View, size: UVec2) -> f32 {
    let clip = view.clip_from_world.inverse();
    let way = |y: f32| {
        let [near, far] = [0.25, 0.75].map(|depth| clip.project_point3(Vec3::new(0.0, y, depth)));
        (near - far).normalize_or_zero()
    };
    let step = 2.0 / size.y.max(1) as f32;
    let angle = way(0.0).cross(way(step)).length();
    if angle > 1e-6 { angle } else { std::f32::consts::FRAC_PI_4 / size.y.max(1) as f32 }
}
