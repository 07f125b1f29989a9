//! The smallest sphere around a mesh.

use glam::{DVec3, Vec3};

/// A sphere in the object's space, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: Vec3,
    /// Its radius, positive.
    pub radius: f32,
}

/// By how much a field's sphere is larger than the smallest one. Where the object touches the smallest one, rays start
/// so far from it that rounding, some 1e-7, turns them by no more than 1e-3 as seen from there.
const MARGIN: f64 = 1e-4;

/// Each round finds a point further out, and few are needed; should they run out, the sphere is still around everything.
const ROUNDS: usize = 64;

impl Sphere {
    /// The smallest sphere around all points, but for rounding and a margin of 1e-4 of its radius. Points are finite;
    /// the radius may be zero or too large for its type.
    pub(crate) fn around(points: &[DVec3]) -> Self {
        // Relative to one of them: far from the origin, squares would lose their digits.
        let origin = points.first().copied().unwrap_or_default();
        let mut support = vec![DVec3::ZERO];
        let mut ball = Ball { center: DVec3::ZERO, radius: 0.0 };
        for _ in 0..ROUNDS {
            let Some(far) = farthest(points, origin + ball.center).map(|p| p - origin) else { break };
            if far.distance(ball.center) <= ball.radius * (1.0 + 1e-7) {
                break;
            }
            support.push(far);
            let grown = smallest(&mut support);
            // In exact arithmetic the ball grows in every round.
            if grown.radius <= ball.radius {
                break;
            }
            ball = grown;
        }
        let center = (origin + ball.center).as_vec3();
        // From the rounded centre: far from the origin, rounding moves it by more than the margin.
        let radius = farthest(points, center.as_dvec3()).map_or(0.0, |p| p.distance(center.as_dvec3()));
        Self { center, radius: (radius * (1.0 + MARGIN)) as f32 }
    }
}

#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

fn farthest(points: &[DVec3], from: DVec3) -> Option<DVec3> {
    points.iter().copied().max_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)))
}

/// The smallest ball around at most five points, which are thinned to those on its surface.
fn smallest(support: &mut Vec<DVec3>) -> Ball {
    let mut best: Option<(Ball, Vec<DVec3>)> = None;
    for chosen in 1u32..1 << support.len() {
        if chosen.count_ones() > 4 {
            continue;
        }
        let points: Vec<_> =
            (0..support.len()).filter(|n| chosen >> n & 1 == 1).map(|n| support[n]).collect();
        let Some(ball) = through(&points) else { continue };
        let reach = ball.radius * (1.0 + 1e-9);
        if support.iter().all(|p| p.distance(ball.center) <= reach)
            && best.as_ref().is_none_or(|(b, _)| ball.radius < b.radius)
        {
            best = Some((ball, points));
        }
    }
    match best {
        Some((ball, points)) => {
            *support = points;
            ball
        }
        None => Ball { center: support[0], radius: 0.0 },
    }
}

/// The smallest ball with all of one to four points on its surface, unless they are too nearly dependent.
fn through(points: &[DVec3]) -> Option<Ball> {
    let origin = points[0];
    let edges: Vec<_> = points[1..].iter().map(|p| *p - origin).collect();
    let center = match edges[..] {
        [] => DVec3::ZERO,
        [a] => 0.5 * a,
        [a, b] => {
            let normal = a.cross(b);
            let double = 2.0 * normal.length_squared();
            (a.length_squared() * b.cross(normal) + b.length_squared() * normal.cross(a)) / double
        }
        [a, b, c] => {
            let sum = a.length_squared() * b.cross(c)
                + b.length_squared() * c.cross(a)
                + c.length_squared() * a.cross(b);
            sum / (2.0 * a.dot(b.cross(c)))
        }
        _ => return None,
    };
    center.is_finite().then(|| Ball { center: origin + center, radius: center.length() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(count: u32) -> Vec<DVec3> {
        // Golden angles; radii from a sequence without a pattern.
        (0..count)
            .map(|n| {
                let n = f64::from(n);
                let z = 1.0 - 2.0 * (n + 0.5) / f64::from(count);
                let r = (1.0 - z * z).sqrt();
                let direction = DVec3::new(r * (2.399963 * n).cos(), r * (2.399963 * n).sin(), z);
                direction * (0.3 + 0.7 * (n * 0.618034).fract())
            })
            .collect()
    }

    #[test]
    fn known_spheres() {
        let corner = |n: u32| DVec3::new(f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2));
        let cube: Vec<_> = (0..8).map(corner).collect();
        let sphere = Sphere::around(&cube);
        assert!((sphere.center - Vec3::splat(0.5)).length() < 1e-6);
        assert!((sphere.radius - 0.75f32.sqrt() * 1.0001).abs() < 1e-6);
        let triangle = [DVec3::ZERO, 4.0 * DVec3::X, DVec3::new(2.0, 0.1, 0.0)];
        let sphere = Sphere::around(&triangle);
        assert!((sphere.center - Vec3::new(2.0, 0.0, 0.0)).length() < 1e-6, "obtuse: two points carry it");
        assert_eq!(Sphere::around(&[DVec3::ONE; 9]).radius, 0.0);
        assert_eq!(Sphere::around(&[]).radius, 0.0);
    }

    #[test]
    fn all_points_lie_inside_and_no_smaller_sphere_holds_them() {
        for (points, shift, scale) in [
            (cloud(2000), DVec3::ZERO, 1.0),
            (cloud(50), DVec3::new(5.0, -3.0, 2.0), 0.01),
            (cloud(300), DVec3::splat(1e6), 2.0),
            (cloud(300), DVec3::ZERO, 1e-25),
            (cloud(300), DVec3::ZERO, 1e25),
        ] {
            let points: Vec<_> = points.iter().map(|p| shift + scale * *p).collect();
            let sphere = Sphere::around(&points);
            let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
            assert!(points.iter().all(|p| p.distance(center) <= radius));
            // Moving the centre anywhere must push a point out of a sphere of the same size, less margin and rounding.
            let step = 0.01 * radius + 2e-7 * center.length();
            for n in 0..50 {
                let moved = center + step * cloud(50)[n].normalize_or_zero();
                let reach = points.iter().map(|p| p.distance(moved)).fold(0.0, f64::max);
                assert!(
                    reach > radius * (1.0 - 1.1 * MARGIN) - 2e-7 * center.length(),
                    "{n} {reach} {radius}"
                );
            }
        }
    }
}
