//! Lights: what they send to a point, the samples that area lights are cut into, and the views of each.
//!
//! | light | samples | views of a sample |
//! | --- | --- | --- |
//! | directional | itself | one, orthographic |
//! | point | itself | six of 90 degrees |
//! | spot | itself | one over its cone |
//! | rect | points spread over it | the five of six that face the light's side |
//! | sky | directions spread over the sphere | one, orthographic |
//!
//! An area light is the sum of its samples, each with a hard shadow of its own. More samples give smoother penumbras; with
//! `n` samples a shadow's edge has steps of `1/n` of the light.

mod panels;
mod samples;
mod sky;
mod views;

use glam::Vec3;
use lumivox::core::Bounds;
use lumivox_scene::{Light, SpotFalloff};

pub use panels::panels;
pub use samples::{LightSample, area_samples, light_samples, sky_samples};
pub use sky::Sky;
pub use views::{ViewShape, light_views, visible_part};

lumivox::gpu_struct! {
    /// A light, or a sample of one, as shaders see it.
    pub struct LightUniform {
        /// Where it stands; unused by directional lights and the sky.
        pub position: Vec3,
        /// One of the `LIGHT_` constants of the shader module.
        pub kind: u32,
        /// The way its light travels, unit length.
        pub direction: Vec3,
        /// Angle from the axis up to which a spot is full, radians.
        pub beam: f32,
        /// W/sr (on the axis), or W/m2 for directional lights and the sky.
        pub intensity: Vec3,
        /// Angle from the axis where a spot ends, radians.
        pub cutoff: f32,
    }
}

pub(crate) const LIGHT_DIRECTIONAL: u32 = 0;
const LIGHT_POINT: u32 = 1;
const LIGHT_SPOT: u32 = 2;
const LIGHT_SPOT_GLTF: u32 = 3;
pub(crate) const LIGHT_SKY: u32 = 4;
pub(crate) const LIGHT_RECT: u32 = 5;

/// The shared shader module of lights.
pub const LIGHTS: &str = include_str!("lights.wgsl");

impl LightUniform {
    /// No light at all.
    pub const NONE: Self = Self {
        position: Vec3::ZERO,
        kind: LIGHT_DIRECTIONAL,
        direction: Vec3::NEG_Y,
        beam: 0.0,
        intensity: Vec3::ZERO,
        cutoff: 0.0,
    };
}

/// A light without extent for shaders; `None` for area lights.
pub(crate) fn point_like(light: &Light) -> Option<LightUniform> {
    match *light {
        Light::Directional { direction, irradiance } => {
            Some(LightUniform { direction: unit(direction), intensity: irradiance, ..LightUniform::NONE })
        }
        Light::Point { position, intensity } => {
            Some(LightUniform { position, kind: LIGHT_POINT, intensity, ..LightUniform::NONE })
        }
        Light::Spot { position, direction, intensity, beam, cutoff, falloff } => Some(LightUniform {
            position,
            kind: if falloff == SpotFalloff::Gltf { LIGHT_SPOT_GLTF } else { LIGHT_SPOT },
            direction: unit(direction),
            beam,
            intensity,
            cutoff,
        }),
        Light::Rect { .. } => None,
    }
}

/// A bound for the radiance that white surfaces reflect, W/(m2 sr): a fiftieth of the scene's diagonal from the brightest
/// sample, and an eighth of it from all others at once. It is for ranges of numbers, and closer surfaces may exceed it.
pub fn radiance_bound<'a>(samples: impl IntoIterator<Item = &'a LightUniform>, bounds: &Bounds) -> f32 {
    let diagonal = bounds.size().length();
    let (mut brightest, mut together) = (0.0_f32, 0.0);
    for sample in samples {
        let parallel = sample.kind == LIGHT_DIRECTIONAL || sample.kind == LIGHT_SKY;
        let at = |distance: f32| {
            let attenuation = if parallel { 1.0 } else { distance.max(1e-15).powi(-2) };
            attenuation * sample.intensity.max_element() / std::f32::consts::PI
        };
        brightest = brightest.max(at(diagonal / 50.0));
        together += at(diagonal / 8.0);
    }
    brightest + together
}

pub(crate) fn unit(direction: Vec3) -> Vec3 {
    direction.try_normalize().unwrap_or(Vec3::NEG_Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_have_the_same_numbers_in_the_shader() {
        for (name, number) in [
            ("LIGHT_DIRECTIONAL", LIGHT_DIRECTIONAL),
            ("LIGHT_POINT", LIGHT_POINT),
            ("LIGHT_SPOT", LIGHT_SPOT),
            ("LIGHT_SPOT_GLTF", LIGHT_SPOT_GLTF),
            ("LIGHT_SKY", LIGHT_SKY),
            ("LIGHT_RECT", LIGHT_RECT),
        ] {
            let line = format!("const {name}: u32 = {number}u;");
            assert!(LIGHTS.lines().any(|l| l == line), "{line}");
        }
    }
}
