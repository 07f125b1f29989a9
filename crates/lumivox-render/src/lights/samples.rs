//! Area lights as sums of samples.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use lumivox_scene::Light;

use super::{LIGHT_RECT, LIGHT_SKY, LightUniform, Sky, ViewShape, point_like, unit};

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
    /// Number of the light that it is, or is a sample of; none for the sky.
    pub source: Option<usize>,
}

/// The samples of a light, as light number 0; area lights are cut into `count`.
pub fn light_samples(light: &Light, count: u32) -> Vec<LightSample> {
    if let Light::Rect { origin, u, v, radiance } = *light {
        return rect_samples(origin, u, v, radiance, count);
    }
    let shape = match *light {
        Light::Point { .. } => ViewShape::All,
        Light::Spot { cutoff, .. } => ViewShape::Cone { half_angle: cutoff },
        _ => ViewShape::Parallel,
    };
    point_like(light)
        .map(|uniform| LightSample { uniform, shape, is_area: false, source: Some(0) })
        .into_iter()
        .collect()
}

/// The samples of all lights and of the sky, which has none where it is black. The sky is cut into `of_sky`, a rect light
/// into a quarter of `count`, since it needs five views a sample.
pub fn area_samples(lights: &[Light], sky: &Sky, count: u32, of_sky: u32) -> Vec<LightSample> {
    let sky = if sky.is_black() { Vec::new() } else { sky_samples(sky, of_sky) };
    let of_light = |(n, light)| {
        let samples = light_samples(light, count.div_ceil(4)).into_iter();
        samples.map(move |sample| LightSample { source: Some(n), ..sample })
    };
    lights.iter().enumerate().flat_map(of_light).chain(sky).collect()
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
                source: Some(0),
            }
        })
        .collect()
}

/// Share of the sky's samples that lie below the horizon, where floors and the ground hide it in most scenes.
const BELOW_HORIZON: f32 = 0.25;

/// Directions on a Fibonacci spiral over the whole sphere, each with the solid angle around it. Above the horizon half of
/// them are spread evenly and half by the cosine that a floor sees them with, so that overhead they are 2.3 times as dense as if
/// all were spread evenly, at the horizon 0.75 times, and below it half as dense.
///
/// Of a map each takes the mean over a disc of its solid angle; then all are scaled, for each colour, so that together they
/// send what the map sends.
pub fn sky_samples(sky: &Sky, count: u32) -> Vec<LightSample> {
    let blurred = sky.blurred(16 * count);
    let mut samples: Vec<LightSample> = (0..count)
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
            let direction = Vec3::new(radius * cos, y, radius * sin);
            LightSample {
                uniform: LightUniform {
                    kind: LIGHT_SKY,
                    direction: -direction,
                    intensity: (radiance_around(&blurred, direction, solid_angle) * solid_angle)
                        .min(Vec3::MAX),
                    ..LightUniform::NONE
                },
                shape: ViewShape::Parallel,
                is_area: true,
                source: None,
            }
        })
        .collect();
    if sky.map.is_some() {
        let sent: Vec3 = samples.iter().map(|s| s.uniform.intensity).sum();
        // Nothing was found where there is next to nothing.
        let lit = sent.cmpgt(Vec3::splat(1e-20));
        let scale = Vec3::select(lit, 2.0 * TAU * sky.mean() / sent, Vec3::ZERO);
        for sample in &mut samples {
            sample.uniform.intensity = (scale * sample.uniform.intensity).min(Vec3::MAX);
        }
    }
    samples
}

/// Mean radiance of a disc of directions.
fn radiance_around(sky: &Sky, direction: Vec3, solid_angle: f32) -> Vec3 {
    const POINTS: u32 = 16;
    if sky.map.is_none() {
        return sky.constant;
    }
    let (u, v) = direction.any_orthonormal_pair();
    let around = (0..POINTS).map(|n| {
        let reach = (solid_angle / PI * (n as f32 + 0.5) / POINTS as f32).sqrt();
        let (sin, cos) = (TAU * golden_turn(n, 0.0)).sin_cos();
        sky.radiance((direction + reach * (cos * u + sin * v)).normalize_or_zero())
    });
    around.sum::<Vec3>() / POINTS as f32
}

#[cfg(test)]
mod tests {
    use lumivox_scene::SkyMap;

    use super::*;

    #[test]
    fn an_open_sky_gives_pi_times_its_radiance_whichever_way_a_surface_faces() {
        let sky = Sky { constant: Vec3::new(1.0, 2.0, 0.5), map: None };
        let samples = sky_samples(&sky, 256);
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

    /// Irradiance under a map by integration over its pixels, of samples as many as a still takes and as a volume does.
    #[test]
    fn a_map_sends_its_light_from_where_it_is() {
        let map = SkyMap::gradient(Vec3::new(0.1, 0.2, 0.8), Vec3::new(2.0, 1.0, 0.5), Vec3::splat(0.1));
        let mut wide = SkyMap { width: 128, height: 64, pixels: vec![Vec3::ZERO; 128 * 64] };
        for (n, pixel) in wide.pixels.iter_mut().enumerate() {
            let d = wide_direction(n);
            *pixel = map.radiance(d)
                + if d.dot(Vec3::new(0.6, 0.8, 0.0)) > 0.97 { Vec3::splat(40.0) } else { Vec3::ZERO };
        }
        let sky = Sky { constant: Vec3::ZERO, map: Some(wide.clone()) };
        for count in [64, 1024] {
            let samples = sky_samples(&sky, count);
            for n in [Vec3::Y, Vec3::X, Vec3::NEG_X, Vec3::NEG_Y] {
                let received = |(k, p): (usize, &Vec3)| {
                    wide.solid_angle(k as u32 / wide.width) * n.dot(wide_direction(k)).max(0.0) * *p
                };
                let expected: Vec3 = wide.pixels.iter().enumerate().map(received).sum();
                let sum: Vec3 =
                    samples.iter().map(|s| s.uniform.intensity * n.dot(-s.uniform.direction).max(0.0)).sum();
                let error = ((sum - expected) / PI).abs().max_element();
                assert!(error < if count == 64 { 0.2 } else { 0.04 }, "{count} {n}: {sum} for {expected}");
            }
        }
    }

    fn wide_direction(n: usize) -> Vec3 {
        SkyMap { width: 128, height: 64, pixels: Vec::new() }.direction(n as u32 % 128, n as u32 / 128)
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
