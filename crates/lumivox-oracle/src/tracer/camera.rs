//! Camera rays that see what a rasterizer with the same camera sees.

use glam::{Vec2, Vec3};

use crate::scene::{Camera, SceneError};

/// A camera's eye and the plane at distance one before it.
pub(crate) struct Pinhole {
    pub(crate) eye: Vec3,
    forward: Vec3,
    right: Vec3,
    down: Vec3,
    size: Vec2,
}

impl Pinhole {
    /// `size` of the picture in pixels; pixels are square.
    pub(crate) fn new(camera: &Camera, size: Vec2) -> Result<Self, SceneError> {
        let forward = (camera.target - camera.eye).try_normalize().ok_or(SceneError::BadCamera)?;
        let up = camera.up.normalize_or_zero();
        // Looking along the up vector, any picture is as upright as another; this one is that of `View`.
        let up = if forward.dot(up).abs() > 0.999 || up == Vec3::ZERO {
            forward.any_orthogonal_vector()
        } else {
            up
        };
        let right = forward.cross(up).normalize_or_zero();
        let finite = camera.eye.is_finite() && forward.is_finite() && camera.up.is_finite();
        if !(finite && camera.fov_y > 0.0 && camera.fov_y < std::f32::consts::PI) {
            return Err(SceneError::BadCamera);
        }
        let half_height = (0.5 * camera.fov_y).tan();
        let half_width = half_height * size.x / size.y;
        Ok(Self {
            eye: camera.eye,
            forward,
            right: half_width * right,
            down: half_height * forward.cross(right),
            size,
        })
    }

    /// The unit direction through a point of the picture in pixels: `(0, 0)` is the upper left corner of the upper
    /// left pixel, whose centre is `(0.5, 0.5)`.
    pub(crate) fn direction(&self, pixel: Vec2) -> Vec3 {
        let p = 2.0 * pixel / self.size - 1.0;
        (self.forward + p.x * self.right + p.y * self.down).normalize_or_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_core::View;

    #[test]
    fn rays_pass_through_the_pixels_that_the_view_projects_to() {
        let size = Vec2::new(160.0, 90.0);
        for (eye, target) in [(Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0)), (Vec3::Y, Vec3::ZERO)] {
            let camera = Camera { eye, target, up: Vec3::Y, fov_y: 0.9 };
            let pinhole = Pinhole::new(&camera, size).unwrap();
            let view = View::perspective(eye, target, Vec3::Y, 0.9, size.x / size.y, 0.1, 50.0);
            for pixel in [Vec2::new(0.5, 0.5), Vec2::new(159.5, 0.5), Vec2::new(20.5, 77.5), size / 2.0] {
                let point = eye + 3.0 * pinhole.direction(pixel);
                let (uv, _) = view.uv_from_world(point).unwrap();
                assert!((uv * size - pixel).abs().max_element() < 1e-3, "{pixel} {}", uv * size);
            }
        }
    }

    #[test]
    fn refuses_a_camera_that_looks_nowhere() {
        let camera = Camera { eye: Vec3::ONE, target: Vec3::ONE, up: Vec3::Y, fov_y: 1.0 };
        assert!(Pinhole::new(&camera, Vec2::ONE).is_err());
        let wide = Camera { target: Vec3::ZERO, fov_y: 3.2, ..camera };
        assert!(Pinhole::new(&wide, Vec2::ONE).is_err());
    }
}
