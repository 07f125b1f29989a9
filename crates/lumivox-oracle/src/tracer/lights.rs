//! Light that reaches a surface straight from its source, as irradiance.

use glam::{Vec3, Vec3Swizzles};
use std::f32::consts::PI;

use super::geometry::{Hit, lifted};
use super::random::triangle_weights;
use super::world::{Surface, World, unit_normal};
use crate::scene::Light;

/// Emissive triangles, picked in proportion to area times strength.
pub(crate) struct Emitters {
    triangles: Vec<usize>,
    /// Running sum of the shares, the last one 1.
    shares: Vec<f64>,
    /// Per triangle of the world: how likely a point of it is picked, per m2.
    densities: Vec<f32>,
}

impl Emitters {
    /// From the corners and the strength of all triangles; strength zero does not emit.
    pub(crate) fn new(all: impl Iterator<Item = ([Vec3; 3], f32)>) -> Self {
        let (mut triangles, mut shares, mut densities) = (Vec::new(), Vec::new(), Vec::new());
        let mut total = 0.0;
        for (n, ([a, b, c], strength)) in all.enumerate() {
            let strength = f64::from(strength);
            let area = 0.5 * (b - a).as_dvec3().cross((c - a).as_dvec3()).length();
            densities.push(strength);
            if strength * area > 0.0 {
                total += strength * area;
                triangles.push(n);
                shares.push(total);
            }
        }
        shares.iter_mut().for_each(|share| *share /= total);
        let density = |strength: f64| if total > 0.0 { (strength / total) as f32 } else { 0.0 };
        Self { triangles, shares, densities: densities.into_iter().map(density).collect() }
    }

    pub(crate) fn density(&self, triangle: usize) -> f32 {
        self.densities[triangle]
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The triangle that a number in 0..1 stands for.
    fn pick(&self, at: f32) -> Option<usize> {
        let at = f64::from(at);
        let n = self.shares.partition_point(|&share| share <= at);
        self.triangles.get(n.min(self.triangles.len().wrapping_sub(1))).copied()
    }
}

/// The share of an estimate by a density when another one samples the same light (power heuristic, Veach 1995).
pub(crate) fn share(own: f32, other: f32) -> f32 {
    let (own, other) = (own * own, other * other);
    if own > 0.0 { own / (own + other) } else { 0.0 }
}

/// Cosine at a surface towards a unit direction; zero below the triangle as well as below the normal.
fn cosine(surface: &Surface, direction: Vec3) -> f32 {
    if surface.face.dot(direction) > 0.0 { surface.normal.dot(direction).max(0.0) } else { 0.0 }
}

/// Irradiance from all directional, point and spot lights.
pub(crate) fn punctual(world: &World<'_>, at: &Surface) -> Vec3 {
    world.scene.lights.iter().map(|light| punctual_light(world, at, light)).sum()
}

fn punctual_light(world: &World<'_>, at: &Surface, light: &Light) -> Vec3 {
    let (position, intensity) = match *light {
        Light::Directional { direction, irradiance } => {
            let to_light = -direction.normalize_or_zero();
            let cosine = cosine(at, to_light);
            let lit = cosine > 0.0 && world.sees(at, to_light, f32::INFINITY, None);
            return if lit { cosine * irradiance } else { Vec3::ZERO };
        }
        Light::Point { position, intensity } => (position, intensity),
        Light::Spot { position, direction, intensity, falloff } => {
            let away = (at.position - position).normalize_or_zero();
            (position, intensity * falloff.at(away.dot(direction.normalize_or_zero())))
        }
        Light::Rect { .. } | Light::Constant { .. } => return Vec3::ZERO,
    };
    let offset = position - at.position;
    let cosine = cosine(at, offset.normalize_or_zero());
    if cosine <= 0.0 || intensity == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let from = lifted(at.position, at.face);
    let lit = world.sees(at, position - from, 1.0, None);
    if lit { cosine / offset.length_squared() * intensity } else { Vec3::ZERO }
}

/// Irradiance from emissive triangles and rectangles, estimated from the point of them that a point of the
/// unit cube stands for; weighted against the chance that [`super::path`] meets the same point by following a random direction.
pub(crate) fn emitted(world: &World<'_>, at: &Surface, sample: Vec3) -> Vec3 {
    let Some(triangle) = world.emitters.pick(sample.x) else { return Vec3::ZERO };
    let hit = Hit { triangle, weights: triangle_weights(sample.yz()) };
    let corners = world.corners(triangle);
    let w = hit.weights;
    let point = w.x * corners[0] + w.y * corners[1] + w.z * corners[2];
    let front = unit_normal(corners);
    let offset = point - at.position;
    let direction = offset.normalize_or_zero();
    let from_front = front.dot(direction) < 0.0;
    let (near, far) = (cosine(at, direction), front.dot(direction).abs());
    let emission = world.emission(hit, from_front);
    if near <= 0.0 || far <= 0.0 || emission == Vec3::ZERO || !world.is_there(hit) {
        return Vec3::ZERO;
    }
    let facing = if from_front { front } else { -front };
    let offset_lifted = lifted(point, facing) - lifted(at.position, at.face);
    if !world.sees(at, offset_lifted, 1.0, Some(triangle)) {
        return Vec3::ZERO;
    }
    let density = world.emitters.density(triangle) * offset.length_squared() / far;
    share(density, near / PI) * near / density * emission
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    #[test]
    fn emitters_are_picked_by_power_and_their_density_integrates_to_one() {
        let triangle = |size: f32| [Vec3::ZERO, size * Vec3::X, size * Vec3::Y];
        let all = [(triangle(1.0), 3.0), (triangle(2.0), 0.0), (triangle(2.0), 1.0)];
        let emitters = Emitters::new(all.into_iter());
        let integral = emitters.density(0) * 0.5 + emitters.density(2) * 2.0;
        assert!((integral - 1.0).abs() < 1e-6 && emitters.density(1) == 0.0);
        let mut random = Random::new(0, 0);
        let first = (0..20_000).filter(|_| emitters.pick(random.unit()) == Some(0)).count();
        // 3 * 0.5 of 3 * 0.5 + 1 * 2; four standard errors are 0.014.
        assert!((first as f64 / 20_000.0 - 1.5 / 3.5).abs() < 0.014, "{first}");
        assert_eq!(Emitters::new(std::iter::empty()).pick(random.unit()), None);
    }
}
