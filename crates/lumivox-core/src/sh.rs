//! Real spherical harmonics of bands 0 and 1: the four coefficients that the papers call second order
//! (dissertation 5.4.1, equations 4 to 7).
//!
//! Order of the coefficients everywhere: `[Y00, Y1x, Y1y, Y1z]`, that is constant, x, y, z. Literature often writes
//! `l, m` as y, z, x; the order here makes coefficients 1 to 3 a vector that mirrors and rotates like one.

use std::f32::consts::PI;

use glam::{Vec3, Vec4};

/// `Y00`, the constant basis function: `1 / (2 sqrt(pi))`.
pub const Y0: f32 = 0.282_094_8;
/// Factor of the linear basis functions: `Y1a(d) = Y1 * d.a`, `sqrt(3 / (4 pi))`.
pub const Y1: f32 = 0.488_602_5;
/// Band-0 coefficient of the clamped cosine `max(0, n.d)`: `sqrt(pi) / 2`.
pub const COS0: f32 = 0.886_226_9;
/// Band-1 factor of the clamped cosine, times `n`: `sqrt(pi / 3)`.
pub const COS1: f32 = 1.023_326_7;

/// The basis functions in direction `d` (unit length).
pub fn basis(d: Vec3) -> Vec4 {
    Vec4::new(Y0, Y1 * d.x, Y1 * d.y, Y1 * d.z)
}

/// Value of the function with coefficients `sh` in direction `d`.
pub fn eval(sh: Vec4, d: Vec3) -> f32 {
    sh.dot(basis(d))
}

/// Projection of the clamped cosine lobe about `n` (unit length): equation 15's `T`.
pub fn cosine_lobe(n: Vec3) -> Vec4 {
    Vec4::new(COS0, COS1 * n.x, COS1 * n.y, COS1 * n.z)
}

/// Integral over the sphere.
pub fn integral(sh: Vec4) -> f32 {
    sh.x * (4.0 * PI).sqrt()
}

/// Irradiance on a surface with normal `n` under incident radiance `sh`: the dot product of equations 7 and 14.
pub fn irradiance(sh: Vec4, n: Vec3) -> f32 {
    sh.dot(cosine_lobe(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions and solid angles of a fine latitude-longitude grid.
    fn sphere() -> impl Iterator<Item = (Vec3, f32)> {
        let (rows, columns) = (200, 400);
        (0..rows).flat_map(move |r| {
            let theta = PI * (r as f32 + 0.5) / rows as f32;
            let weight = theta.sin() * (PI / rows as f32) * (2.0 * PI / columns as f32);
            (0..columns).map(move |c| {
                let phi = 2.0 * PI * (c as f32 + 0.5) / columns as f32;
                (Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()), weight)
            })
        })
    }

    fn project(f: impl Fn(Vec3) -> f32) -> Vec4 {
        sphere().fold(Vec4::ZERO, |sum, (d, w)| sum + w * f(d) * basis(d))
    }

    #[test]
    fn basis_is_orthonormal() {
        for i in 0..4 {
            let coefficients = project(|d| basis(d)[i]);
            let mut unit = Vec4::ZERO;
            unit[i] = 1.0;
            assert!((coefficients - unit).abs().max_element() < 1e-3, "basis {i}: {coefficients}");
        }
    }

    #[test]
    fn cosine_lobe_is_the_projection_of_the_clamped_cosine() {
        let n = Vec3::new(0.36, -0.48, 0.8);
        let projected = project(|d| d.dot(n).max(0.0));
        assert!((projected - cosine_lobe(n)).abs().max_element() < 1e-3, "{projected}");
        assert!((integral(cosine_lobe(n)) - PI).abs() < 1e-5);
    }

    #[test]
    fn constant_radiance_gives_pi_times_itself() {
        let sh = project(|_| 2.5);
        assert!((irradiance(sh, Vec3::Y) - 2.5 * PI).abs() < 1e-2);
        assert!((eval(sh, Vec3::X) - 2.5).abs() < 1e-2);
    }
}
