//! Light transport with known answers. Radiance `L` in W/(m2 sr), irradiance `E` in W/m2, lengths in metres.
//!
//! Form factors are those of Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*: the share of the light
//! leaving one diffuse surface that arrives at the other.

use std::f64::consts::PI;

/// Radiance anywhere in a closed box whose walls emit `emission` and reflect `albedo` < 1:
/// `L = emission / (1 - albedo)`.
pub fn furnace(albedo: f64, emission: f64) -> f64 {
    emission / (1.0 - albedo)
}

/// What of [`furnace`] leaves a wall after exactly `reflections` reflections: `emission albedo^reflections`.
pub fn furnace_part(albedo: f64, emission: f64, reflections: i32) -> f64 {
    emission * albedo.powi(reflections)
}

/// Radiance that leaves the inside of a sphere around a point light of `intensity` W/sr:
/// `L = albedo / pi * intensity / radius^2 / (1 - albedo)`. It is 1 for the analytic scene of the pbrt tests: radius 1,
/// albedo 1/2, intensity pi.
pub fn lit_sphere(radius: f64, albedo: f64, intensity: f64) -> f64 {
    albedo / PI * intensity / (radius * radius) / (1.0 - albedo)
}

/// Form factor between equal, directly opposed rectangles of sides `a`, `b` at a `distance` (Howell C-11).
pub fn facing_rectangles(a: f64, b: f64, distance: f64) -> f64 {
    let (x, y) = (a / distance, b / distance);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let log = (rx * ry / (1.0 + x * x + y * y).sqrt()).ln();
    let sum = log + x * ry * (x / ry).atan() + y * rx * (y / rx).atan() - x * x.atan() - y * y.atan();
    2.0 / (PI * x * y) * sum
}

/// Form factor from a rectangle of depth `from` to one of height `to` at a right angle, which share an edge of length
/// `edge` (Howell C-14).
pub fn perpendicular_rectangles(edge: f64, from: f64, to: f64) -> f64 {
    let (w, h) = (from / edge, to / edge);
    let (w2, h2) = (w * w, h * h);
    let s = w2 + h2;
    let first = (1.0 + w2) * (1.0 + h2) / (1.0 + s);
    let second = w2 * (1.0 + s) / ((1.0 + w2) * s);
    let third = h2 * (1.0 + s) / ((1.0 + h2) * s);
    let logs = first.ln() + w2 * second.ln() + h2 * third.ln();
    let angles = w * (1.0 / w).atan() + h * (1.0 / h).atan() - s.sqrt() * (1.0 / s.sqrt()).atan();
    (angles + 0.25 * logs) / (PI * w)
}

/// Share of the light of a small flat element that a parallel rectangle of sides `a`, `b` gets whose corner lies straight
/// above it at a `distance` (Howell B-4). Rectangles elsewhere are sums and differences of such.
pub fn element_below_corner(a: f64, b: f64, distance: f64) -> f64 {
    let (x, y) = (a / distance, b / distance);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / rx * (y / rx).atan() + y / ry * (x / ry).atan()) / (2.0 * PI)
}

/// Share of a small flat element's cosine-weighted hemisphere that a sphere covers, for a sphere that lies wholly above
/// the element's plane: `cos (radius / distance)^2`, `distance` to its centre and `cos` of the angle of that from the
/// normal. The rest is the element's ambient visibility.
pub fn sphere_occlusion(radius: f64, distance: f64, cos: f64) -> f64 {
    cos * (radius / distance).powi(2)
}

/// What a stack of absorbing layers lets through: `product of (1 - opacity)`, whatever their order.
pub fn stack_transmittance(opacities: impl IntoIterator<Item = f64>) -> f64 {
    opacities.into_iter().map(|opacity| 1.0 - opacity).product()
}

/// What an absorber of coefficient `sigma` per metre lets through over a `length`: `exp(-sigma length)`.
pub fn beer_lambert(sigma: f64, length: f64) -> f64 {
    (-sigma * length).exp()
}

/// Radiance that leaves each of two endless parallel planes, with the radiance each emits and the share each reflects:
/// `L0 = (e0 + a0 e1) / (1 - a0 a1)`, and the other way round.
pub fn facing_planes(emissions: [f64; 2], albedos: [f64; 2]) -> [f64; 2] {
    let all = 1.0 - albedos[0] * albedos[1];
    let radiance = |one: usize, other: usize| (emissions[one] + albedos[one] * emissions[other]) / all;
    [radiance(0, 1), radiance(1, 0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// `1/A1 integral integral cos cos / (pi r^2)` by the midpoint rule, `place` maps (0..1)^2 to points.
    fn form_factor(
        n: usize,
        from: (impl Fn(f64, f64) -> DVec3, DVec3),
        to: (impl Fn(f64, f64) -> DVec3, DVec3, f64),
    ) -> f64 {
        let grid = || (0..n * n).map(|i| ((i % n) as f64 + 0.5, (i / n) as f64 + 0.5));
        let scale = 1.0 / n as f64;
        let mut sum = 0.0;
        for (s, t) in grid() {
            let p = from.0(s * scale, t * scale);
            for (u, v) in grid() {
                let r = to.0(u * scale, v * scale) - p;
                let r2 = r.length_squared();
                sum += (from.1.dot(r) * -to.1.dot(r)).max(0.0) / (PI * r2 * r2);
            }
        }
        sum * to.2 * scale.powi(4)
    }

    #[test]
    fn form_factors_are_those_of_the_tables() {
        // Howell's tables: unit squares facing at distance 1, and sharing an edge.
        assert!((facing_rectangles(1.0, 1.0, 1.0) - 0.199_825).abs() < 1e-6);
        assert!((perpendicular_rectangles(1.0, 1.0, 1.0) - 0.200_044).abs() < 1e-6);
        // Reciprocity, A1 F12 = A2 F21.
        let there = perpendicular_rectangles(2.0, 3.0, 0.5) * 3.0;
        assert!((there - perpendicular_rectangles(2.0, 0.5, 3.0) * 0.5).abs() < 1e-12);
    }

    #[test]
    fn form_factors_are_their_integrals() {
        let below = (|s: f64, t: f64| DVec3::new(2.0 * s, 0.0, 3.0 * t), DVec3::Y);
        let above = (|s: f64, t: f64| DVec3::new(2.0 * s, 1.5, 3.0 * t), -DVec3::Y, 6.0);
        assert!((form_factor(24, below, above) - facing_rectangles(2.0, 3.0, 1.5)).abs() < 1e-3);
        let floor = (|s: f64, t: f64| DVec3::new(2.0 * s, 0.0, 3.0 * t), DVec3::Y);
        let wall = (|s: f64, t: f64| DVec3::new(2.0 * s, 1.5 * t, 0.0), DVec3::Z, 3.0);
        // The integrand is singular at the shared edge, so the rule is coarse there.
        assert!((form_factor(40, floor, wall) - perpendicular_rectangles(2.0, 3.0, 1.5)).abs() < 5e-3);
        let point = (|_: f64, _: f64| DVec3::ZERO, DVec3::Y);
        let over = (|s: f64, t: f64| DVec3::new(0.7 * s, 0.9, 1.3 * t), -DVec3::Y, 0.91);
        let one = form_factor(30, point, over);
        assert!((one - element_below_corner(0.7, 1.3, 0.9)).abs() < 1e-4);
    }

    #[test]
    fn sphere_occlusion_is_its_solid_angle_integral() {
        let (center, radius) = (DVec3::new(0.5, 1.2, 0.3), 0.8);
        // Directions by cosine-weighted midpoint rule: height^2 and angle are uniform.
        let n = 600;
        let blocked = (0..n * n).filter(|i| {
            let (height, turn) = (((i % n) as f64 + 0.5) / n as f64, ((i / n) as f64 + 0.5) / n as f64);
            let (sin, cos) = (2.0 * PI * turn).sin_cos();
            let d = DVec3::new((1.0 - height).sqrt() * cos, height.sqrt(), (1.0 - height).sqrt() * sin);
            center.cross(d).length() < radius && center.dot(d) > 0.0
        });
        let share = blocked.count() as f64 / (n * n) as f64;
        let cos = center.y / center.length();
        assert!((share - sphere_occlusion(radius, center.length(), cos)).abs() < 1e-3);
    }

    #[test]
    fn series_sum_to_their_closed_forms() {
        let sum: f64 = (0..400).map(|n| furnace_part(0.9, 2.0, n)).sum();
        assert!((sum - furnace(0.9, 2.0)).abs() < 1e-9);
        assert!((lit_sphere(1.0, 0.5, PI) - 1.0).abs() < 1e-12);
        let (mut a, mut b) = (0.0, 0.0);
        for _ in 0..200 {
            (a, b) = (3.0 + 0.8 * b, 1.0 + 0.5 * a);
        }
        let [left, right] = facing_planes([3.0, 1.0], [0.8, 0.5]);
        assert!((left - a).abs() < 1e-9 && (right - b).abs() < 1e-9);
        assert!((facing_planes([1.0; 2], [0.75; 2])[0] - furnace(0.75, 1.0)).abs() < 1e-12);
    }

    #[test]
    fn thin_layers_absorb_as_a_medium_does() {
        let layers = stack_transmittance((0..10_000).map(|_| 2.0 * 1.5 / 10_000.0));
        assert!((layers - beer_lambert(2.0, 1.5)).abs() < 1e-4);
        assert_eq!(stack_transmittance([0.5, 1.0, 0.2]), 0.0);
        assert!((stack_transmittance([0.5, 0.2]) - 0.4).abs() < 1e-12);
    }
}
