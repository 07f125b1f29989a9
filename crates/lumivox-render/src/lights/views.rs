//! The views that a light sees the scene from.

use std::f32::consts::FRAC_PI_2;

use glam::{Vec2, Vec3};
use lumivox::core::{Bounds, View};

use super::{LightSample, unit};

/// Diagonal of the smallest box that views are made for, metres.
const MIN_REACH: f32 = 1e-15;

/// Which way a light's views look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewShape {
    /// Along the light, orthographic.
    Parallel,
    /// Along the axis of a cone.
    Cone {
        /// Angle from the axis to the cone's edge, radians.
        half_angle: f32,
    },
    /// All the way round on one side of a plane: forward and four to the sides.
    Half,
    /// All the way round: the faces of a cube.
    All,
}

impl ViewShape {
    /// How many views there are.
    pub fn count(self) -> usize {
        match self {
            Self::Parallel | Self::Cone { .. } => 1,
            Self::Half => 5,
            Self::All => 6,
        }
    }
}

/// The views of a light or a sample over a scene. Parallel light sees only what shades `receivers`: the corners of the part of the
/// scene that matters, such as [`visible_part`] of a camera. Its window moves in whole texels (`texels` a side), so that shadows
/// stand still when the camera moves.
pub fn light_views(sample: &LightSample, bounds: &Bounds, receivers: &[Vec3], texels: u32) -> Vec<View> {
    let light = &sample.uniform;
    let (position, forward) = (light.position, light.direction);
    let far = bounds.corners().iter().map(|c| c.distance(position)).fold(0.0, f32::max);
    let reach = bounds.size().length().max(MIN_REACH);
    let planes = (1e-3 * reach, far.max(2e-3 * reach));
    let look = |axis: Vec3, up: Vec3, fov: f32| {
        View::perspective_along(position, axis, up, fov, 1.0, planes.0, planes.1)
    };
    match sample.shape {
        ViewShape::Parallel => vec![parallel_view(unit(forward), bounds, receivers, texels)],
        // A cone wider than 170 degrees would leave no resolution for its middle.
        ViewShape::Cone { half_angle } => {
            vec![look(unit(forward), Vec3::Y, (2.0 * half_angle).clamp(0.02, 2.97))]
        }
        ViewShape::Half => {
            let (side, up) = unit(forward).any_orthonormal_pair();
            [(forward, up), (side, forward), (-side, forward), (up, forward), (-up, forward)]
                .map(|(axis, up)| look(axis, up, FRAC_PI_2))
                .to_vec()
        }
        ViewShape::All => [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]
            .map(|axis| look(axis, Vec3::Y, FRAC_PI_2))
            .to_vec(),
    }
}

/// The rectangle that points fill in a view's picture plane, in metres.
fn window(view: &View, points: &[Vec3]) -> (Vec2, Vec2) {
    let flat = points.iter().map(|p| view.eye_from_world.transform_point3(*p).truncate());
    flat.fold((Vec2::MAX, Vec2::MIN), |(low, high), p| (low.min(p), high.max(p)))
}

/// Which way is up in the map of parallel light: along the axis with which the scene's box fills the map best. A long box that
/// lies askew in its map leaves more than half of it empty.
fn parallel_up(direction: Vec3, bounds: &Bounds) -> Vec3 {
    let area = |up: &Vec3| {
        let probe = View::orthographic_along(Vec3::ZERO, direction, *up, Vec2::ONE, 1.0);
        let (low, high) = window(&probe, &bounds.corners());
        ((high - low) / bounds.size().length().max(MIN_REACH)).element_product()
    };
    let ups = [Vec3::Y, Vec3::X, Vec3::Z];
    ups.into_iter().min_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(Vec3::Y)
}

/// An orthographic view that holds the receivers and, before them, all that may shade them.
fn parallel_view(direction: Vec3, bounds: &Bounds, receivers: &[Vec3], texels: u32) -> View {
    let reach = bounds.size().length().max(MIN_REACH);
    let up = parallel_up(direction, bounds);
    let probe = View::orthographic_along(Vec3::ZERO, direction, up, Vec2::ONE, 1.0);
    let whole = window(&probe, &bounds.corners());
    let wanted = if receivers.is_empty() { whole } else { window(&probe, receivers) };
    let (low, high) = (wanted.0.max(whole.0), wanted.1.min(whole.1));
    // Sizes grow in eighths of the whole and the window moves in whole texels.
    let step = (whole.1 - whole.0).max(Vec2::splat(1e-3 * reach)) / 8.0;
    let size = 1.01 * ((high - low).max(Vec2::ZERO) / step).ceil().max(Vec2::ONE) * step;
    // Two texels more leave room for the rounding of the centre.
    let texel = size / texels.saturating_sub(2).max(1) as f32;
    let center = ((0.5 * (low + high)) / texel).round() * texel;
    let world_from_eye = probe.eye_from_world.inverse();
    let middle = world_from_eye.transform_point3(center.extend(0.0));
    // Along the light the eye lies a whole diagonal before the scene's middle.
    let along = direction.dot(bounds.center() - middle) - reach;
    let eye = middle + along * direction;
    View::orthographic_along(eye, direction, up, texels.max(1) as f32 * texel, 2.0 * reach)
}

/// Corners of the part of a box that a perspective camera can see; their convex hull holds it. Empty if it sees none.
pub fn visible_part(camera: &View, bounds: &Bounds) -> Vec<Vec3> {
    let m = camera.clip_from_world.transpose();
    // Left, right, bottom, top: a point is inside where the product with its homogeneous coordinates is positive.
    let planes =
        [m.w_axis + m.x_axis, m.w_axis - m.x_axis, m.w_axis + m.y_axis, m.w_axis - m.y_axis, m.w_axis];
    let (low, high) = (bounds.min, bounds.max);
    let at = |x: bool, y: bool, z: bool| {
        Vec3::new(
            if x { high.x } else { low.x },
            if y { high.y } else { low.y },
            if z { high.z } else { low.z },
        )
    };
    let faces = [false, true].into_iter().flat_map(|s| {
        let ring = [(false, false), (true, false), (true, true), (false, true)];
        [ring.map(|(a, b)| at(s, a, b)), ring.map(|(a, b)| at(a, s, b)), ring.map(|(a, b)| at(a, b, s))]
    });
    let mut points: Vec<Vec3> = faces
        .flat_map(|face| planes.iter().fold(face.to_vec(), |polygon, plane| clip(&polygon, *plane)))
        .collect();
    let eye = camera.eye();
    if eye.clamp(low, high) == eye {
        points.push(eye);
    }
    points
}

/// The part of a convex polygon on the positive side of a plane.
fn clip(polygon: &[Vec3], plane: glam::Vec4) -> Vec<Vec3> {
    let mut kept = Vec::new();
    for (n, &p) in polygon.iter().enumerate() {
        let q = polygon[(n + 1) % polygon.len()];
        let (a, b) = (plane.dot(p.extend(1.0)), plane.dot(q.extend(1.0)));
        if a >= 0.0 {
            kept.push(p);
        }
        if (a >= 0.0) != (b >= 0.0) {
            kept.push(p.lerp(q, a / (a - b)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use lumivox_scene::Light;

    use super::super::light_samples;
    use super::*;

    fn inside(view: &View, p: Vec3) -> bool {
        view.uv_from_world(p).is_some_and(|(uv, depth)| {
            uv.min_element() >= 0.0 && uv.max_element() <= 1.0 && (0.0..=1.0).contains(&depth)
        })
    }

    #[test]
    fn the_suns_view_holds_the_whole_box() {
        let bounds = Bounds::new(Vec3::new(-3.0, 0.0, -8.0), Vec3::new(5.0, 4.0, 1.0));
        let sun = Light::Directional { direction: Vec3::new(0.3, -1.0, 0.2), irradiance: Vec3::ONE };
        let views = light_views(&light_samples(&sun, 1)[0], &bounds, &[], 256);
        assert_eq!(views.len(), 1);
        assert!(bounds.corners().iter().all(|&corner| inside(&views[0], corner)));
    }

    #[test]
    fn a_narrow_camera_narrows_the_suns_view_to_what_it_sees() {
        let bounds = Bounds::new(Vec3::splat(-20.0), Vec3::splat(20.0));
        let sun = Light::Directional { direction: Vec3::new(0.3, -1.0, 0.2), irradiance: Vec3::ONE };
        let sample = light_samples(&sun, 1)[0];
        let camera = View::perspective(Vec3::new(0.0, 1.0, 19.0), Vec3::ZERO, Vec3::Y, 0.3, 1.0, 0.1, 100.0);
        let seen = visible_part(&camera, &bounds);
        let view = &light_views(&sample, &bounds, &seen, 256)[0];
        let whole = &light_views(&sample, &bounds, &[], 256)[0];
        let density = |v: &View| {
            let row = |n: usize| v.clip_from_world.row(n).truncate().length();
            row(0) * row(1)
        };
        assert!(density(view) > 2.0 * density(whole), "{} {}", density(view), density(whole));
        for n in 0..1000 {
            let t = Vec3::new((n % 10) as f32, (n / 10 % 10) as f32, (n / 100) as f32) / 9.0;
            let p = bounds.min + t * bounds.size();
            let in_camera =
                camera.uv_from_world(p).is_some_and(|(uv, _)| uv == uv.clamp(Vec2::ZERO, Vec2::ONE));
            assert!(!in_camera || inside(view, p), "{p}");
            // What shades a seen point lies before it, and in the view too.
            let shading = p + 5.0 * Vec3::new(-0.3, 1.0, -0.2);
            assert!(!in_camera || !bounds.contains(shading) || inside(view, shading), "{p}");
        }
    }

    #[test]
    fn a_small_step_of_the_camera_moves_the_view_by_whole_texels() {
        let bounds = Bounds::new(Vec3::splat(-20.0), Vec3::splat(20.0));
        let sun = Light::Directional { direction: Vec3::new(0.3, -1.0, 0.2), irradiance: Vec3::ONE };
        let sample = light_samples(&sun, 1)[0];
        let texel_of_origin = |x: f32| {
            let eye = Vec3::new(x, 1.0, 15.0);
            let camera = View::perspective(eye, eye - Vec3::Z, Vec3::Y, 0.5, 1.0, 0.1, 100.0);
            let seen = visible_part(&camera, &bounds);
            let view = light_views(&sample, &bounds, &seen, 256)[0];
            view.uv_from_world(Vec3::ZERO).unwrap().0 * 256.0
        };
        let (a, b) = (texel_of_origin(0.0), texel_of_origin(0.37));
        let moved = a - b;
        assert!((moved - moved.round()).abs().max_element() < 1e-2, "{a} {b}");
    }

    #[test]
    fn views_of_a_point_and_of_half_space_see_all_their_directions() {
        let bounds = Bounds::new(Vec3::splat(-1.0), Vec3::ONE);
        let lamp = Light::Point { position: Vec3::new(0.2, 0.1, 0.0), intensity: Vec3::ONE };
        let (u, v) = (Vec3::new(0.0, 0.2, 0.1), Vec3::new(0.1, 0.0, 0.2));
        let panel = Light::Rect { origin: Vec3::ZERO, u, v, radiance: Vec3::ONE };
        for (light, half) in [(lamp, None), (panel, Some(u.cross(v)))] {
            let sample = light_samples(&light, 1)[0];
            let views = light_views(&sample, &bounds, &[], 64);
            assert_eq!(views.len(), sample.shape.count());
            for n in 0..512 {
                let t = Vec3::new((n % 8) as f32, (n / 8 % 8) as f32, (n / 64) as f32) / 7.0;
                let p = bounds.min + t * bounds.size();
                let way = p - sample.uniform.position;
                if half.is_none_or(|normal| way.dot(normal) > 1e-3) && way.length() > 0.01 {
                    assert!(views.iter().any(|view| inside(view, p)), "{p}");
                }
            }
        }
    }
}
