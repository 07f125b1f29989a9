//! The geometry of one rendered image: where it was taken from and what each pixel sees.

use glam::camera::rh::{proj::directx as proj, view};
use glam::{Mat4, Vec2, Vec3};

/// How a view projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays meet in the eye.
    Perspective,
    /// All rays run parallel.
    Orthographic,
}

/// A camera or a light's camera: world to clip space and back. Depth runs from 0 (near) to 1 (far), or the other
/// way round when `reversed_depth` is set. One of a host's own matrices is [`Self::from_matrices`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World to clip space (wgpu's: x right, y up, depth 0..1).
    pub clip_from_world: Mat4,
    /// World to eye space: right-handed, the view looks along -z.
    pub eye_from_world: Mat4,
    /// How it projects.
    pub projection: Projection,
    /// Near plane at depth 1, far plane at depth 0.
    pub reversed_depth: bool,
}

impl View {
    /// A perspective view. `fov_y` in radians, the planes in metres.
    pub fn perspective(
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        fov_y: f32,
        aspect: f32,
        near: f32,
        far: f32,
    ) -> Self {
        Self::perspective_along(eye, target - eye, up, fov_y, aspect, near, far)
    }

    /// As [`Self::perspective`], with a direction of any length to look along. A target near an eye that is far from the
    /// origin would be rounded to the eye.
    pub fn perspective_along(
        eye: Vec3,
        forward: Vec3,
        up: Vec3,
        fov_y: f32,
        aspect: f32,
        near: f32,
        far: f32,
    ) -> Self {
        let eye_from_world = eye_from_world(eye, forward, up);
        let clip_from_eye = proj::perspective(fov_y, aspect, near, far);
        Self {
            clip_from_world: clip_from_eye * eye_from_world,
            eye_from_world,
            projection: Projection::Perspective,
            reversed_depth: false,
        }
    }

    /// An orthographic view from `eye` towards `target`, `size` metres wide and high, that sees from 0 to `far` metres.
    pub fn orthographic(eye: Vec3, target: Vec3, up: Vec3, size: Vec2, far: f32) -> Self {
        Self::orthographic_along(eye, target - eye, up, size, far)
    }

    /// As [`Self::orthographic`], with a direction of any length to look along.
    pub fn orthographic_along(eye: Vec3, forward: Vec3, up: Vec3, size: Vec2, far: f32) -> Self {
        let eye_from_world = eye_from_world(eye, forward, up);
        let half = 0.5 * size;
        let clip_from_eye = proj::orthographic(-half.x, half.x, -half.y, half.y, 0.0, far);
        Self {
            clip_from_world: clip_from_eye * eye_from_world,
            eye_from_world,
            projection: Projection::Orthographic,
            reversed_depth: false,
        }
    }

    /// The same view with near at depth 1 and far at depth 0.
    #[must_use]
    pub fn with_reversed_depth(mut self) -> Self {
        let flip = Mat4::from_cols_array_2d(&[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0, 1.0],
        ]);
        self.clip_from_world = flip * self.clip_from_world;
        self.reversed_depth = !self.reversed_depth;
        self
    }

    /// Clip space to world.
    pub fn world_from_clip(&self) -> Mat4 {
        self.clip_from_world.inverse()
    }

    /// Where the view looks from. For an orthographic view a point on its near plane.
    pub fn eye(&self) -> Vec3 {
        self.eye_from_world.inverse().w_axis.truncate()
    }

    /// The unit direction it looks along.
    pub fn forward(&self) -> Vec3 {
        -Vec3::new(self.eye_from_world.x_axis.z, self.eye_from_world.y_axis.z, self.eye_from_world.z_axis.z)
    }

    /// The world point of a picture position (`uv`: 0..1, row 0 on top) at a depth value.
    pub fn world_from_uv(&self, uv: Vec2, depth: f32) -> Vec3 {
        self.world_from_clip().project_point3(Vec3::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, depth))
    }

    /// Picture position and depth of a world point; `None` behind the eye.
    pub fn uv_from_world(&self, world: Vec3) -> Option<(Vec2, f32)> {
        let clip = self.clip_from_world * world.extend(1.0);
        (clip.w > 0.0).then(|| {
            let ndc = clip.truncate() / clip.w;
            (Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y), ndc.z)
        })
    }
}

fn eye_from_world(eye: Vec3, forward: Vec3, up: Vec3) -> Mat4 {
    // Scaled first, for the shortest and longest do not survive being squared; along -z if there is no direction.
    let forward = (forward / forward.abs().max_element()).try_normalize().unwrap_or(Vec3::NEG_Z);
    view::look_to_mat4(eye, forward, steady_up(forward, up))
}

/// An up vector that is never parallel to the view direction.
fn steady_up(forward: Vec3, up: Vec3) -> Vec3 {
    let along = forward.normalize_or_zero().dot(up.normalize_or_zero()).abs();
    if along > 0.999 || up.length_squared() == 0.0 { forward.any_orthogonal_vector() } else { up }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn views() -> [View; 3] {
        let (eye, target) = (Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0));
        let perspective = View::perspective(eye, target, Vec3::Y, 1.0, 1.5, 0.1, 20.0);
        [
            perspective,
            perspective.with_reversed_depth(),
            View::orthographic(eye, target, Vec3::Y, Vec2::splat(8.0), 20.0),
        ]
    }

    #[test]
    fn a_point_comes_back_from_its_picture_position() {
        let point = Vec3::new(0.3, 0.8, -0.4);
        for view in views() {
            let (uv, depth) = view.uv_from_world(point).unwrap();
            assert!((view.world_from_uv(uv, depth) - point).length() < 1e-4, "{view:?}");
        }
    }

    #[test]
    fn up_is_up_and_depth_runs_the_way_it_says() {
        for view in views() {
            let above = view.uv_from_world(Vec3::new(0.0, 1.5, 0.0)).unwrap().0;
            let below = view.uv_from_world(Vec3::new(0.0, -0.5, 0.0)).unwrap().0;
            assert!(above.y < below.y);
            let near = view.uv_from_world(view.eye() + view.forward()).unwrap().1;
            let far = view.uv_from_world(view.eye() + 9.0 * view.forward()).unwrap().1;
            assert_eq!(near < far, !view.reversed_depth);
        }
    }

    #[test]
    fn any_direction_of_any_length_is_looked_along() {
        let far_away = Vec3::new(3e8, -2e9, 1e7);
        for forward in [Vec3::X, Vec3::new(0.1, -0.7, 0.3)] {
            for length in [1e-30, 1.0, 1e30] {
                let views = [
                    View::perspective_along(far_away, length * forward, Vec3::Y, 1.0, 1.0, 0.1, 10.0),
                    View::orthographic_along(far_away, length * forward, Vec3::Y, Vec2::ONE, 10.0),
                ];
                for view in views {
                    let error = view.forward().distance(forward.normalize_or_zero());
                    assert!(error < 1e-6, "{forward} times {length}: {error}");
                }
            }
        }
        for nowhere in [Vec3::ZERO, Vec3::NAN] {
            let view = View::perspective_along(Vec3::ONE, nowhere, Vec3::Y, 1.0, 1.0, 0.1, 10.0);
            assert!(view.clip_from_world.is_finite() && view.forward() == Vec3::NEG_Z);
        }
    }

    #[test]
    fn looks_straight_down_without_losing_its_way() {
        let view = View::perspective(Vec3::Y, Vec3::ZERO, Vec3::Y, 1.0, 1.0, 0.1, 10.0);
        assert!(view.clip_from_world.is_finite());
        assert!((view.forward() + Vec3::Y).length() < 1e-5);
    }
}
