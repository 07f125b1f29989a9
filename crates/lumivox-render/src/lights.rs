//! Lights: the views they see the scene from, and the light they send to a point.
//!
//! A directional light has one orthographic view over the scene's bounds, a spot light one perspective view, a point light six
//! of 90 degrees.

use glam::{Vec2, Vec3};
use lumivox::core::{Bounds, View};
use lumivox_scene::{Light, SpotFalloff};

lumivox::gpu_struct! {
    /// A light as shaders see it.
    pub struct LightUniform {
        /// Where it stands; unused by directional lights.
        pub position: Vec3,
        /// One of `LIGHT_DIRECTIONAL`, `LIGHT_POINT`, `LIGHT_SPOT`, `LIGHT_SPOT_GLTF`.
        pub kind: u32,
        /// The way its light travels, unit length.
        pub direction: Vec3,
        /// Angle from the axis up to which a spot is full, radians.
        pub beam: f32,
        /// W/sr, or W/m2 for directional lights.
        pub intensity: Vec3,
        /// Angle from the axis where a spot ends, radians.
        pub cutoff: f32,
    }
}

const LIGHT_DIRECTIONAL: u32 = 0;
const LIGHT_POINT: u32 = 1;
const LIGHT_SPOT: u32 = 2;
const LIGHT_SPOT_GLTF: u32 = 3;

/// The shared shader module of lights.
pub const LIGHTS: &str = include_str!("lights.wgsl");

/// The light for shaders; `None` for those that have no reflective shadow map yet (rect lights).
pub fn light_uniform(light: &Light) -> Option<LightUniform> {
    let none = LightUniform {
        position: Vec3::ZERO,
        kind: LIGHT_DIRECTIONAL,
        direction: Vec3::NEG_Y,
        beam: 0.0,
        intensity: Vec3::ZERO,
        cutoff: 0.0,
    };
    match *light {
        Light::Directional { direction, irradiance } => {
            Some(LightUniform { direction: unit(direction), intensity: irradiance, ..none })
        }
        Light::Point { position, intensity } => {
            Some(LightUniform { position, kind: LIGHT_POINT, intensity, ..none })
        }
        Light::Spot { position, direction, intensity, beam, cutoff, falloff } => Some(LightUniform {
            position,
            kind: if falloff == SpotFalloff::Gltf { LIGHT_SPOT_GLTF } else { LIGHT_SPOT },
            direction: unit(direction),
            beam,
            intensity,
            cutoff,
        }),
        _ => None,
    }
}

/// The views that a light sees the scene from.
pub fn light_views(light: &Light, bounds: &Bounds) -> Vec<View> {
    let reach = bounds.size().length().max(1e-3);
    match *light {
        Light::Directional { direction, .. } => vec![directional_view(unit(direction), bounds)],
        Light::Point { position, .. } => {
            let (near, far) = planes(position, bounds, reach);
            let quarter = std::f32::consts::FRAC_PI_2;
            [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]
                .map(|axis| View::perspective(position, position + axis, Vec3::Y, quarter, 1.0, near, far))
                .to_vec()
        }
        Light::Spot { position, direction, cutoff, .. } => {
            let (near, far) = planes(position, bounds, reach);
            // A cone wider than 170 degrees would leave no resolution for its middle.
            let fov = (2.0 * cutoff).clamp(0.02, 2.97);
            vec![View::perspective(position, position + unit(direction), Vec3::Y, fov, 1.0, near, far)]
        }
        _ => Vec::new(),
    }
}

/// The largest radiance that a surface reflects of this light, W/(m2 sr), for surfaces no nearer than a fiftieth of the
/// scene's diagonal.
pub fn radiance_bound(light: &Light, bounds: &Bounds) -> f32 {
    let nearest = (bounds.size().length() / 50.0).max(1e-3);
    let irradiance = match *light {
        Light::Directional { irradiance, .. } => irradiance,
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => intensity / (nearest * nearest),
        _ => Vec3::ZERO,
    };
    irradiance.max_element() / std::f32::consts::PI
}

fn unit(direction: Vec3) -> Vec3 {
    direction.try_normalize().unwrap_or(Vec3::NEG_Y)
}

fn planes(position: Vec3, bounds: &Bounds, reach: f32) -> (f32, f32) {
    let far = bounds.corners().iter().map(|c| c.distance(position)).fold(0.0, f32::max);
    (1e-3 * reach, far.max(2e-3 * reach))
}

/// An orthographic view that just holds the bounds.
fn directional_view(direction: Vec3, bounds: &Bounds) -> View {
    let center = bounds.center();
    let reach = bounds.size().length().max(1e-3);
    let eye = center - reach * direction;
    let probe = View::orthographic(eye, center, Vec3::Y, Vec2::ONE, 2.0 * reach);
    let extent = bounds
        .corners()
        .map(|c| probe.eye_from_world.transform_point3(c).truncate().abs())
        .into_iter()
        .fold(Vec2::ZERO, Vec2::max);
    View::orthographic(eye, center, Vec3::Y, 2.02 * extent.max(Vec2::splat(1e-3 * reach)), 2.0 * reach)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suns_view_holds_the_whole_box() {
        let bounds = Bounds::new(Vec3::new(-3.0, 0.0, -8.0), Vec3::new(5.0, 4.0, 1.0));
        let sun = Light::Directional { direction: Vec3::new(0.3, -1.0, 0.2), irradiance: Vec3::ONE };
        let views = light_views(&sun, &bounds);
        assert_eq!(views.len(), 1);
        for corner in bounds.corners() {
            let (uv, depth) = views[0].uv_from_world(corner).unwrap();
            assert!(uv.min_element() >= 0.0 && uv.max_element() <= 1.0 && (0.0..=1.0).contains(&depth));
        }
    }

    #[test]
    fn six_views_of_a_point_light_see_all_directions() {
        let bounds = Bounds::new(Vec3::splat(-1.0), Vec3::ONE);
        let lamp = Light::Point { position: Vec3::new(0.2, 0.1, 0.0), intensity: Vec3::ONE };
        let views = light_views(&lamp, &bounds);
        for corner in bounds.corners() {
            let seen = views.iter().filter_map(|v| v.uv_from_world(corner));
            let inside = seen.filter(|(uv, _)| uv.min_element() >= 0.0 && uv.max_element() <= 1.0);
            assert!(inside.count() >= 1, "{corner}");
        }
    }
}
