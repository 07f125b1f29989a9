//! Where the ray of a pixel goes, worked out from the camera's definition and nothing of the renderer.

use glam::{UVec2, Vec3};
use lumivox_scene::Camera;

/// A ray from the eye; `direction` is of unit length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
}

impl Ray {
    /// Distance to a parallelogram `corner + s u + t v` with `u` at right angles to `v`, and how far the ray passes
    /// inside its border in metres (negative: outside). None if the ray runs away from its plane.
    pub(crate) fn meets(&self, corner: Vec3, u: Vec3, v: Vec3) -> Option<(f32, f32)> {
        let normal = u.cross(v);
        let distance = (corner - self.origin).dot(normal) / self.direction.dot(normal);
        if !(distance.is_finite() && distance > 1e-4) {
            return None;
        }
        let at = self.origin + distance * self.direction - corner;
        let inside = [u, v].map(|edge| {
            let along = at.dot(edge) / edge.length();
            along.min(edge.length() - along)
        });
        Some((distance, inside[0].min(inside[1])))
    }
}

/// The rays through the middles of all pixels, row by row from the top.
pub(crate) fn rays(camera: &Camera, size: UVec2) -> Vec<Ray> {
    let forward = (camera.target - camera.eye).normalize_or_zero();
    let right = forward.cross(camera.up).normalize_or_zero();
    let up = right.cross(forward);
    let half_height = (0.5 * camera.fov_y).tan();
    let half_width = half_height * size.x as f32 / size.y as f32;
    let pixels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| (x, y)));
    let ray = |(x, y): (u32, u32)| {
        let across = 2.0 * (x as f32 + 0.5) / size.x as f32 - 1.0;
        let upwards = 1.0 - 2.0 * (y as f32 + 0.5) / size.y as f32;
        let direction = forward + across * half_width * right + upwards * half_height * up;
        Ray { origin: camera.eye, direction: direction.normalize_or_zero() }
    };
    pixels.map(ray).collect()
}
