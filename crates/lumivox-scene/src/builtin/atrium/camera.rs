//! Where to look at the atrium from: fixed views and a walk.

use glam::Vec3;

use crate::Camera;

/// The hero shot first: along the court in the sun, past curtains, to the arcades in the shade.
pub(super) fn views() -> Vec<Camera> {
    vec![
        Camera::look("court", Vec3::new(-8.3, 1.7, -1.5), Vec3::new(0.5, 2.5, 0.6), 60.0),
        Camera::look("shaded arcade", Vec3::new(-8.2, 1.7, -4.8), Vec3::new(0.0, 1.9, -4.3), 60.0),
        Camera::look("gallery", Vec3::new(-7.2, 6.4, -4.3), Vec3::new(1.5, 3.6, 0.8), 60.0),
        Camera::look("sunny side", Vec3::new(6.6, 1.7, -4.2), Vec3::new(-1.5, 2.0, 3.0), 60.0),
    ]
}

/// Eyes of the walk: along the shaded arcade, out through the open bay, round the fountain and down the court.
const EYES: [[f32; 3]; 8] = [
    [-8.4, 1.7, -4.8],
    [-6.2, 1.7, -4.8],
    [-4.0, 1.7, -4.8],
    [-2.2, 1.7, -4.65],
    [-1.2, 1.7, -3.6],
    [-0.6, 1.7, -2.2],
    [2.0, 1.7, -1.5],
    [5.0, 1.7, -1.0],
];

/// What the walk looks at, at the same times.
const TARGETS: [[f32; 3]; 8] = [
    [-2.0, 1.8, -4.7],
    [0.0, 1.8, -4.5],
    [1.5, 1.8, -4.1],
    [2.2, 1.9, -2.4],
    [2.0, 2.1, 0.6],
    [3.5, 2.4, 2.4],
    [6.5, 2.6, 2.2],
    [10.5, 2.9, 0.6],
];

/// A walk through the [`atrium`](super::atrium): `t` from 0, in the shaded arcade, to 1, in the court. Smooth, at eye
/// height, and clear of walls, columns and curtains; `t` outside of 0..1 stays at the ends.
pub fn atrium_camera_path(t: f32) -> Camera {
    // Eases in and out, so that an animation starts and ends at rest.
    let t = t.clamp(0.0, 1.0);
    let eased = t * t * (3.0 - 2.0 * t);
    Camera::look("walk", along(&EYES, eased), along(&TARGETS, eased), 60.0)
}

/// A Catmull-Rom curve through the points, `t` in 0..1.
fn along(points: &[[f32; 3]], t: f32) -> Vec3 {
    let last = points.len() - 1;
    let position = t * last as f32;
    let i = (position as usize).min(last - 1);
    let u = position - i as f32;
    let at = |k: usize| Vec3::from(points[k]);
    let (p1, p2) = (at(i), at(i + 1));
    let p0 = if i > 0 { at(i - 1) } else { 2.0 * p1 - p2 };
    let p3 = if i + 2 <= last { at(i + 2) } else { 2.0 * p2 - p1 };
    let (m1, m2) = (0.5 * (p2 - p0), 0.5 * (p3 - p1));
    let (u2, u3) = (u * u, u * u * u);
    (2.0 * u3 - 3.0 * u2 + 1.0) * p1 + (u3 - 2.0 * u2 + u) * m1 + (3.0 * u2 - 2.0 * u3) * p2 + (u3 - u2) * m2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin::atrium;

    /// Distance from a point to a triangle, by sampling it finely: enough for a clearance.
    fn distance(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        if (p - a).length() > longest + 1.0 {
            return f32::INFINITY;
        }
        let n = (longest / 0.1).ceil().clamp(1.0, 64.0) as u32;
        let steps =
            (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i as f32 / n as f32, j as f32 / n as f32)));
        steps.map(|(u, v)| (a + u * (b - a) + v * (c - a)).distance(p)).fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn the_walk_and_the_views_keep_clear_of_everything() {
        let scene = atrium(1);
        let mut triangles = Vec::new();
        for i in &scene.instances {
            let mesh = &scene.meshes[i.mesh];
            let at = |v: u32| i.world_from_local.transform_point3(mesh.positions[v as usize].into());
            triangles.extend(mesh.indices.iter().map(|t| t.map(at)));
        }
        let walk = (0..=40).map(|i| atrium_camera_path(i as f32 / 40.0));
        for camera in walk.chain(scene.cameras.iter().cloned()) {
            let nearest = triangles.iter().map(|t| distance(camera.eye, *t)).fold(f32::INFINITY, f32::min);
            assert!(nearest > 0.5, "{camera:?} is {nearest} m from something");
        }
    }

    #[test]
    fn the_walk_has_no_jumps() {
        let cameras: Vec<_> = (0..=300).map(|i| atrium_camera_path(i as f32 / 300.0)).collect();
        let ahead = |c: &Camera| (c.target - c.eye).normalize_or_zero();
        for pair in cameras.windows(2) {
            assert!(pair[0].eye.distance(pair[1].eye) < 0.15);
            assert!(ahead(&pair[0]).angle_between(ahead(&pair[1])) < 0.035);
            assert!((pair[0].target - pair[0].eye).length() > 1.5);
        }
        assert_eq!(atrium_camera_path(-1.0), cameras[0]);
        assert_eq!(atrium_camera_path(2.0).eye, Vec3::new(5.0, 1.7, -1.0));
    }
}
