//! Area lights as sums of samples.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use lumivox_scene::Light;

use super::{LIGHT_RECT, LIGHT_SKY, LightUniform, ViewShape, point_like, unit};

/// The step of a spiral or lattice whose points never line up: the golden section, of 2^32.
const GOLDEN_STEP: u32 = 0x9e37_79b9;

/// A whole light without extent, or one sample of an area light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// What it sends.
    pub uniform: LightUniform,
    /// The views that see what it lights.
    pub shape: ViewShape,
    /// Whether it is one of many.
    pub is_area: bool,
}

/// The samples of a light; area lights are cut into `count`.
pub fn light_samples(light: &Light, count: u32) -> Vec<LightSample> {
    if let Light::Rect { origin, u, v, radiance } = *light {
        return rect_samples(origin, u, v, radiance, count);
    }
    let shape = match *light {
        Light::Point { .. } => ViewShape::All,
        Light::Spot { cutoff, .. } => ViewShape::Cone { half_angle: cutoff },
        _ => ViewShape::Parallel,
    };
    point_like(light).map(|uniform| LightSample { uniform, shape, is_area: false }).into_iter().collect()
}

/// The samples of all lights and of a constant sky, which has none where it is black. The sky is cut into `count`, a rect light
/// into a quarter of that, since it needs five views a sample.
pub fn area_samples(lights: &[Light], sky: Vec3, count: u32) -> Vec<LightSample> {
    let sky = if sky.max_element() > 0.0 { sky_samples(sky, count) } else { Vec::new() };
    lights.iter().flat_map(|l| light_samples(l, count.div_ceil(4))).chain(sky).collect()
}

/// What is left of `start` and `n` golden sections without whole turns. In integers: a float of 32 bits has room for three
/// digits of it when `n` is a few ten thousand, and with 65,536 samples light came out worse than with half as many.
fn golden_turn(n: u32, start: f32) -> f32 {
    let turns = n.wrapping_mul(GOLDEN_STEP) as f32 / (u32::MAX as f32 + 1.0);
    (start + turns).fract()
}

/// Points of equal weight: a Fibonacci lattice, whose points lie evenly along both edges and across.
fn rect_samples(origin: Vec3, u: Vec3, v: Vec3, radiance: Vec3, count: u32) -> Vec<LightSample> {
    let area_normal = u.cross(v);
    // Of a number, however large: infinity times a black channel would be none.
    let intensity = radiance * (area_normal.length().min(f32::MAX) / count.max(1) as f32);
    (0..count)
        .map(|n| {
            let st = Vec2::new((n as f32 + 0.5) / count as f32, golden_turn(n, 0.5));
            LightSample {
                uniform: LightUniform {
                    position: origin + st.x * u + st.y * v,
                    kind: LIGHT_RECT,
                    direction: unit(area_normal),
                    intensity,
                    ..LightUniform::NONE
                },
                shape: ViewShape::Half,
                is_area: true,
            }
        })
        .collect()
}

/// Share of the sky's samples that lie below the horizon, where floors and the ground hide it in most scenes.
const BELOW_HORIZON: f32 = 0.25;

/// Directions on a Fibonacci spiral over the whole sphere, each with the solid angle around it. Above the horizon half of
/// them are spread evenly and half by the cosine that a floor sees them with, so that overhead they are 2.3 times as dense as if
/// all were spread evenly, at the horizon 0.75 times, and below it half as dense.
pub fn sky_samples(radiance: Vec3, count: u32) -> Vec<LightSample> {
    (0..count)
        .map(|n| {
            let from_top = (n as f32 + 0.5) / count as f32;
            let above = 1.0 - BELOW_HORIZON;
            let (y, share) = if from_top < above {
                // The density is (y + 1/2) dy, so y (y + 1) / 2 of the samples lie between the horizon and y.
                let y = 0.5 * ((9.0 - 8.0 * from_top / above).sqrt() - 1.0);
                (y, above * (y + 0.5))
            } else {
                ((above - from_top) / BELOW_HORIZON, BELOW_HORIZON)
            };
            let radius = (1.0 - y * y).max(0.0).sqrt();
            let (sin, cos) = (TAU * golden_turn(n, 0.0)).sin_cos();
            let solid_angle = TAU / (share * count as f32);
            LightSample {
                uniform: LightUniform {
                    kind: LIGHT_SKY,
                    direction: -Vec3::new(radius * cos, y, radius * sin),
                    intensity: (radiance * solid_angle).min(Vec3::MAX),
                    ..LightUniform::NONE
                },
                shape: ViewShape::Parallel,
                is_area: true,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::*;

    #[test]
    fn an_open_sky_gives_pi_times_its_radiance_whichever_way_a_surface_faces() {
        let samples = sky_samples(Vec3::new(1.0, 2.0, 0.5), 256);
        for n in [Vec3::Y, Vec3::X, Vec3::new(0.6, -0.8, 0.0), Vec3::new(0.48, 0.6, -0.64)] {
            let sum: Vec3 =
                samples.iter().map(|s| s.uniform.intensity * n.dot(-s.uniform.direction).max(0.0)).sum();
            let expected = PI * Vec3::new(1.0, 2.0, 0.5);
            assert!((sum - expected).abs().cmple(0.005 * expected).all(), "{n}: {sum} {expected}");
        }
    }

    /// Between neighbours of a golden lattice there are at most three distances, and none is many times another.
    #[test]
    fn many_steps_stay_evenly_spread() {
        for count in [1024, 65_536] {
            let mut turns: Vec<f64> = (0..count).map(|n| f64::from(golden_turn(n, 0.0))).collect();
            turns.sort_by(f64::total_cmp);
            let gaps = turns.windows(2).map(|pair| f64::from(count) * (pair[1] - pair[0]));
            let (least, most) = gaps.fold((f64::MAX, 0.0_f64), |(l, m), gap| (l.min(gap), m.max(gap)));
            assert!(least > 0.3 && most < 2.0, "{count}: {least} {most}");
        }
    }

    /// The form factor of a square plate of side `a` for a parallel element at distance `c` on its axis, in closed form.
    #[test]
    fn a_square_above_a_surface_gives_its_form_factor() {
        let (a, c, radiance) = (1.2_f32, 1.5_f32, 4.0_f32);
        let half = 0.5 * a;
        let root = (half * half + c * c).sqrt();
        let factor = 4.0 / (2.0 * PI) * 2.0 * half / root * (half / root).atan();
        let irradiance = |u: Vec3, v: Vec3| -> f32 {
            let origin = Vec3::new(-half, c, -half);
            let light = Light::Rect { origin, u, v, radiance: Vec3::splat(radiance) };
            let samples = light_samples(&light, 64);
            let received = samples.iter().map(|LightSample { uniform, .. }| {
                let (way, distance) = (uniform.position, uniform.position.length());
                let cosines = way.y / distance * uniform.direction.dot(-way / distance).max(0.0);
                uniform.intensity.x * cosines / way.length_squared()
            });
            received.sum()
        };
        let (u, v) = (a * Vec3::X, a * Vec3::Z);
        let expected = PI * radiance * factor;
        assert!((irradiance(u, v) - expected).abs() < 0.003 * expected, "{} {expected}", irradiance(u, v));
        assert_eq!(irradiance(v, u), 0.0, "its back is dark");
    }
}
