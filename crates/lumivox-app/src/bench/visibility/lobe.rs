//! Rays of polished surfaces for references on the CPU.

use glam::Vec3;

/// The part of the microfacets that rays go by, as the device has it.
const SHARE: f32 = 0.95;

/// Points of the unit square, evenly spread and turned for each pixel.
pub(super) fn square(count: u32, turned: u32) -> impl Iterator<Item = [f32; 2]> {
    let shift = 0.618_034 * turned as f32;
    (0..count).map(move |n| {
        let [s, t] = [(n as f32 + 0.5) / count as f32, 0.754_877_7 * n as f32 + shift];
        [s, t.fract()]
    })
}

/// A ray that a surface mirrors by a microfacet of GGX's distribution, and what it counts. `way` looks at the surface.
pub(super) fn ray(normal: Vec3, way: Vec3, roughness: f32, [s, t]: [f32; 2]) -> (Vec3, f32) {
    let alpha = roughness * roughness;
    let (x, y) = normal.any_orthonormal_pair();
    let slope = alpha * (SHARE * s / (1.0 - SHARE * s)).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * t).sin_cos();
    let facet = (normal + slope * (cos * x + sin * y)).normalize_or(normal);
    let out = way - 2.0 * way.dot(facet) * facet;
    let (up, seen) = (out.dot(normal), -way.dot(facet));
    if up <= 0.0 || seen <= 0.0 {
        return (out, 0.0);
    }
    let masking = 2.0 * up / (up + (alpha * alpha + (1.0 - alpha * alpha) * up * up).sqrt());
    (out, masking * seen / facet.dot(normal))
}
