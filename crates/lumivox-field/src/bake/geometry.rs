//! Rays against triangles: an eight-wide tree of `obvhs` around a triangle test without gaps.
//!
//! The test is the scalar triple product in edge coordinates: a ray passes an edge `p q` (relative to its origin) on the
//! side of the sign of `d . ((q - p) x (q + p))`, which is exactly opposite for the edge `q p` of the neighbour, so no
//! ray slips between two triangles that share their corners. Both sides count, and so do edges. Sample points and
//! directions are symmetric, and so are many objects: rays through edges are common here.

use std::collections::HashSet;
use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray, RayHit};
use obvhs::{BvhBuildParams, triangle::Triangle};

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// Distance in lengths of the direction.
    pub(crate) distance: f32,
    /// Place of the triangle in the tree's order.
    leaf: u32,
    /// Weights of its corners.
    weights: Vec3,
}

/// Triangles ready for rays, and their normals.
pub(crate) struct Geometry {
    bvh: CwBvh,
    /// In the order of the tree's leaves.
    corners: Vec<[Vec3A; 3]>,
    /// The same for unit normals at the corners; empty when the faces' are to be used.
    normals: Vec<[Vec3; 3]>,
}

impl Geometry {
    /// `normals` is empty or has the normals at the corners of each triangle.
    pub(crate) fn new(triangles: &[[Vec3; 3]], normals: &[[Vec3; 3]]) -> Self {
        // No ray meets a triangle without area, nor copies of one apart. Many of either in one place make the tree deeper than
        // its traversal goes.
        let mut known = HashSet::new();
        let kept: Vec<usize> = (0..triangles.len())
            .filter(|&n| {
                let [a, b, c] = triangles[n];
                let is_new = known.insert(triangles[n].map(|p| p.to_array().map(f32::to_bits)));
                is_new && (b - a).cross(c - a) != Vec3::ZERO
            })
            .collect();
        let boxed: Vec<_> = kept
            .iter()
            .map(|&n| triangles[n].map(Vec3A::from))
            .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
            .collect();
        let bvh = build_cwbvh_from_tris(&boxed, BvhBuildParams::medium_build(), &mut Duration::default());
        let order = bvh.primitive_indices.iter().map(|&n| kept[n as usize]);
        let corners = order.clone().map(|n| triangles[n].map(Vec3A::from)).collect();
        let normals = order.filter_map(|n| normals.get(n).copied()).collect();
        Self { bvh, corners, normals }
    }

    /// The nearest hit up to `reach` lengths of `direction` away.
    #[inline]
    pub(crate) fn nearest(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, reach);
        let mut found = RayHit::none();
        let mut weights = Vec3::ZERO;
        let hit = self.bvh.ray_traverse(ray, &mut found, |ray, leaf| match self.meet(ray, leaf) {
            Some((t, at)) if t < ray.tmax => {
                weights = at;
                t
            }
            _ => f32::INFINITY,
        });
        hit.then_some(Hit { distance: found.t, leaf: found.primitive_id, weights })
    }

    /// The unit normal where a ray with this direction was met, on the side that it came from.
    pub(crate) fn normal(&self, hit: &Hit, direction: Vec3) -> Vec3 {
        let [a, b, c] = self.corners[hit.leaf as usize].map(Vec3::from);
        let face = (b - a).cross(c - a);
        let scaled = face / face.abs().max_element().max(f32::MIN_POSITIVE);
        let face = scaled.normalize_or(-direction);
        let face = if face.dot(direction) > 0.0 { -face } else { face };
        let Some(corners) = self.normals.get(hit.leaf as usize) else { return face };
        let w = hit.weights;
        let smooth = (w.x * corners[0] + w.y * corners[1] + w.z * corners[2]).normalize_or(face);
        if smooth.dot(face) < 0.0 { -smooth } else { smooth }
    }

    #[inline]
    fn meet(&self, ray: &Ray, leaf: usize) -> Option<(f32, Vec3)> {
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
        (t > 0.0 && t.is_finite()).then(|| (t, Vec3::new(of_a, of_b, of_c) / sum))
    }
}
