//! Random numbers that depend on nothing but their seeds.

use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// SplitMix64: a counter through a bijective mix of 64 bits (Steele, Lea, Flood 2014).
pub(crate) struct Random(u64);

/// A bijective mix of 64 bits.
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl Random {
    /// The sequence number `stream` of a seed.
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        Self(mix(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(mix(stream.wrapping_add(1)))))
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Uniform in 0..1, never 1.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / (1 << 24) as f32)
    }

    /// Uniform in the unit square.
    pub(crate) fn square(&mut self) -> Vec2 {
        Vec2::new(self.unit(), self.unit())
    }

    /// Uniform in the unit cube.
    pub(crate) fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// The direction above `normal` that a point of the unit square stands for, with density `cos / pi`.
pub(crate) fn cosine_direction(s: Vec2, normal: Vec3) -> Vec3 {
    let (sin, cos) = (TAU * s.x).sin_cos();
    let radius = s.y.sqrt();
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    radius * (cos * tangent + sin * bitangent) + (1.0 - s.y).sqrt() * normal
}

/// Weights of the corners of a triangle that a point of the unit square stands for, uniform over the triangle's area.
pub(crate) fn triangle_weights(s: Vec2) -> Vec3 {
    let r = s.x.sqrt();
    Vec3::new(1.0 - r, r * (1.0 - s.y), r * s.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_densities() {
        let mut random = Random::new(7, 3);
        let n = 200_000;
        let normal = Vec3::new(0.6, -0.8, 0.0);
        let (mut mean, mut cosine, mut corner) = (0.0, 0.0, Vec3::ZERO);
        for _ in 0..n {
            mean += f64::from(random.unit());
            let d = cosine_direction(random.square(), normal);
            assert!((d.length() - 1.0).abs() < 1e-5 && d.dot(normal) >= -1e-6);
            cosine += f64::from(d.dot(normal));
            corner += triangle_weights(random.square()) / n as f32;
        }
        // E = 1/2, 2/3 and 1/3; four standard errors are below 0.003.
        assert!((mean / f64::from(n) - 0.5).abs() < 0.003);
        assert!((cosine / f64::from(n) - 2.0 / 3.0).abs() < 0.003);
        assert!((corner - Vec3::splat(1.0 / 3.0)).abs().max_element() < 0.003);
    }

    #[test]
    fn streams_and_seeds_differ() {
        let first = |seed, stream| Random::new(seed, stream).bits();
        let all = [first(0, 0), first(0, 1), first(1, 0), first(1, 1)];
        assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])));
    }
}
