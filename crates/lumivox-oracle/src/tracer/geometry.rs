//! Rays against triangles: an eight-wide tree of `obvhs` around a triangle test without gaps.
//!
//! The test is the scalar triple product in edge coordinates: a ray passes an edge `p q` (relative to its origin) on the
//! side of the sign of `d . ((q - p) x (q + p))`, which is exactly opposite for the edge `q p` of the neighbour, so no
//! ray slips between two triangles that share their corners. Both sides count, and so do edges.

use std::collections::HashMap;
use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray, RayHit};
use obvhs::{BvhBuildParams, triangle::Triangle};

/// Copies of a triangle that are kept: their materials may have different holes.
const MOST_COPIES: u32 = 4;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// Number of the triangle, as given to [`Geometry::new`].
    pub(crate) triangle: usize,
    /// Weights of its corners.
    pub(crate) weights: Vec3,
}

/// Triangles ready for rays.
pub(crate) struct Geometry {
    bvh: CwBvh,
    /// In the order of the tree's leaves.
    corners: Vec<[Vec3A; 3]>,
    numbers: Vec<u32>,
}

impl Geometry {
    pub(crate) fn new(triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        // No ray meets a triangle without area, nor many copies of one apart. Many of either in one place make the tree deeper
        // than its traversal goes.
        let mut copies: HashMap<[[u32; 3]; 3], u32> = HashMap::new();
        let (kept, triangles): (Vec<u32>, Vec<_>) = (0..)
            .zip(triangles)
            .filter(|(_, corners)| {
                let [a, b, c] = *corners;
                let count = copies.entry(corners.map(|p| p.to_array().map(f32::to_bits))).or_default();
                *count += 1;
                *count <= MOST_COPIES && (b - a).cross(c - a) != Vec3::ZERO
            })
            .map(|(n, [a, b, c])| (n, Triangle { v0: a.into(), v1: b.into(), v2: c.into() }))
            .unzip();
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let order = || bvh.primitive_indices.iter().map(|&n| n as usize);
        let corners = order().map(|n| &triangles[n]).map(|t| [t.v0, t.v1, t.v2]).collect();
        let numbers = order().map(|n| kept[n]).collect();
        Self { bvh, corners, numbers }
    }

    /// The nearest hit at a distance up to `reach` (in lengths of `direction`) that `keeps` accepts.
    pub(crate) fn nearest(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        keeps: impl Fn(Hit) -> bool,
    ) -> Option<Hit> {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, reach);
        let mut found = RayHit::none();
        let mut best = None;
        self.bvh.ray_traverse(ray, &mut found, |ray, leaf| match self.meet(ray, leaf) {
            Some((t, hit)) if t < ray.tmax && keeps(hit) => {
                best = Some(hit);
                t
            }
            _ => f32::INFINITY,
        });
        best
    }

    /// Whether anything that `keeps` accepts lies within `reach` (in lengths of `direction`).
    pub(crate) fn is_blocked(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        keeps: impl Fn(Hit) -> bool,
    ) -> bool {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, reach);
        !self.bvh.ray_traverse_miss(ray, |ray, leaf| match self.meet(ray, leaf) {
            Some((t, hit)) if keeps(hit) => t,
            _ => f32::INFINITY,
        })
    }

    fn meet(&self, ray: &Ray, leaf: usize) -> Option<(f32, Hit)> {
        let [a, b, c] = self.corners[leaf].map(|corner| corner - ray.origin);
        let d = ray.direction;
        let (e0, e1, e2) = (c - a, a - b, b - c);
        // Each belongs to the corner that its edge does not touch.
        let of_b = e0.cross(c + a).dot(d);
        let of_c = e1.cross(a + b).dot(d);
        let of_a = e2.cross(b + c).dot(d);
        let sum = of_a + of_b + of_c;
        let (low, high) = (of_a.min(of_b).min(of_c), of_a.max(of_b).max(of_c));
        if sum == 0.0 || (low < 0.0 && high > 0.0) {
            return None;
        }
        let normal = e0.cross(e1);
        let t = a.dot(normal) / normal.dot(d);
        let hit = Hit { triangle: self.numbers[leaf] as usize, weights: Vec3::new(of_a, of_b, of_c) / sum };
        (t > 0.0 && t.is_finite()).then_some((t, hit))
    }
}

/// A point moved off a surface along `normal`, by as little as the rounding of its coordinates asks for: 256 steps of
/// the last bit, and at least 1/65536 m near zero (Waechter and Binder, *Ray Tracing Gems*, chapter 6).
pub(crate) fn lifted(point: Vec3, normal: Vec3) -> Vec3 {
    let lift = |p: f32, n: f32| {
        if p.abs() < 1.0 / 32.0 {
            return p + n / 65536.0;
        }
        let steps = (256.0 * n) as i32;
        f32::from_bits(p.to_bits().wrapping_add_signed(if p < 0.0 { -steps } else { steps }))
    };
    Vec3::new(lift(point.x, normal.x), lift(point.y, normal.y), lift(point.z, normal.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use crate::tracer::random::{Random, cosine_direction};

    #[test]
    fn the_nearest_hit_is_that_of_trying_all() {
        let mesh = shapes::sphere(1.0, 3);
        let triangles: Vec<_> = mesh.view().iter().collect();
        let tree = Geometry::new(triangles.iter().copied());
        let single: Vec<_> = triangles.iter().map(|&t| Geometry::new([t].into_iter())).collect();
        let mut random = Random::new(1, 1);
        let mut hits = 0;
        for _ in 0..300 {
            let mut cube = || 4.0 * Vec3::new(random.unit(), random.unit(), random.unit()) - 2.0;
            let (origin, toward) = (cube(), 0.5 * cube());
            let direction = toward - origin;
            let place = |hit: Hit, n: usize| {
                let w = hit.weights;
                let t = triangles[n];
                (w.x * t[0] + w.y * t[1] + w.z * t[2] - origin).length()
            };
            let all = single.iter().enumerate().filter_map(|(n, g)| {
                g.nearest(origin, direction, f32::MAX, |_| true).map(|hit| place(hit, n))
            });
            let expected = all.fold(f32::INFINITY, f32::min);
            let found = tree.nearest(origin, direction, f32::MAX, |_| true);
            let found = found.map_or(f32::INFINITY, |hit| place(hit, hit.triangle));
            hits += usize::from(found.is_finite());
            assert!(found == expected || (found - expected).abs() < 1e-5, "{found} {expected}");
            assert_eq!(tree.is_blocked(origin, direction, f32::MAX, |_| true), found.is_finite());
        }
        assert!(hits > 50, "{hits}");
    }

    #[test]
    fn nothing_escapes_from_a_closed_mesh() {
        let sphere = shapes::sphere(3.0, 4);
        let view = sphere.view();
        let moved = view.iter().map(|t| t.map(|p| p + Vec3::new(20.0, 3.0, -7.0)));
        let cases = [
            (
                Geometry::new(shapes::cuboid(Vec3::ZERO, Vec3::new(2.0, 1.0, 3.0)).into_iter()),
                Vec3::new(1.0, 0.5, 1.0),
            ),
            (
                Geometry::new(shapes::cuboid(Vec3::splat(-7.77), Vec3::splat(-7.47)).into_iter()),
                Vec3::splat(-7.6),
            ),
            (Geometry::new(moved), Vec3::new(20.0, 3.0, -7.0)),
        ];
        for (case, (geometry, inside)) in cases.iter().enumerate() {
            let mut random = Random::new(5, case as u64);
            for n in 0..200_000 {
                let sphere = cosine_direction(random.square(), Vec3::Y);
                let up = if n % 2 == 0 { sphere } else { -sphere };
                let origin = *inside + 0.05 * up;
                // Every tenth ray lies in an axis-aligned plane.
                let direction = if n % 10 == 0 { Vec3::new(up.x, 0.0, up.z) } else { up };
                assert!(
                    geometry.nearest(origin, direction, f32::MAX, |_| true).is_some(),
                    "{case} {origin} {direction}"
                );
            }
        }
    }

    #[test]
    fn a_lifted_point_lies_on_the_right_side_of_its_surface_and_close() {
        let mut random = Random::new(2, 9);
        for scale in [0.01, 1.0, 1000.0] {
            for _ in 0..1000 {
                let normal = cosine_direction(random.square(), Vec3::Y);
                let point = scale * (2.0 * Vec3::new(random.unit(), random.unit(), random.unit()) - 1.0);
                let height = (lifted(point, normal) - point).as_dvec3().dot(normal.as_dvec3());
                assert!(height > 0.0 && height < f64::from(scale) * 1e-4 + 3e-5, "{height} at {scale}");
            }
        }
    }
}
