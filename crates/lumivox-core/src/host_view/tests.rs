//! Points are projected by a host's formulas, in double precision, and by the view.

use glam::{DVec2, DVec3, DVec4, Mat4, Vec2, Vec3, Vec4};

use super::*;

/// A camera as a host may have it, with its own formulas.
#[derive(Clone, Copy, Debug)]
struct Camera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Half of the picture's width and height at a distance of 1, or everywhere.
    half: DVec2,
    /// By how much of these the picture is beside the axis.
    aside: DVec2,
    near: f64,
    /// None: infinitely far.
    far: Option<f64>,
    is_parallel: bool,
    conventions: MatrixConventions,
}

impl Camera {
    /// Rows written down one by one, in 32 bits.
    fn matrices(&self) -> (Mat4, Mat4) {
        let z = match self.conventions.looks_along {
            LooksAlong::NegativeZ => -1.0,
            LooksAlong::PositiveZ => 1.0,
        };
        let axis = |a: DVec3| a.extend(-a.dot(self.eye));
        let eye = [axis(self.right), axis(self.up), axis(z * self.forward), DVec4::W];
        let (slope, lift) = self.depth_terms();
        let aside =
            |n: usize| if self.is_parallel { [0.0, -self.aside[n]] } else { [-z * self.aside[n], 0.0] };
        let [c0, d0] = aside(0);
        let [c1, d1] = aside(1);
        let clip = [
            DVec4::new(1.0 / self.half.x, 0.0, c0, d0),
            DVec4::new(0.0, 1.0 / self.half.y, c1, d1),
            DVec4::new(0.0, 0.0, z * slope, lift),
            if self.is_parallel { DVec4::W } else { DVec4::new(0.0, 0.0, z, 0.0) },
        ];
        (of_rows(eye), of_rows(clip))
    }

    /// Clip depth is `slope * distance + lift`.
    fn depth_terms(&self) -> (f64, f64) {
        let (mut at_near, mut at_far) = match self.conventions.clip_depth {
            ClipDepth::ZeroToOne => (0.0, 1.0),
            ClipDepth::MinusOneToOne => (-1.0, 1.0),
        };
        if self.conventions.reversed_depth {
            std::mem::swap(&mut at_near, &mut at_far);
        }
        let near = self.near;
        match self.far {
            Some(far) if self.is_parallel => {
                let slope = (at_far - at_near) / (far - near);
                (slope, at_near - slope * near)
            }
            Some(far) => {
                let slope = (at_far * far - at_near * near) / (far - near);
                (slope, (at_near - slope) * near)
            }
            None => (at_far, (at_near - at_far) * near),
        }
    }

    /// Picture position, what the depth texture holds, and the distance.
    fn seen(&self, world: DVec3) -> (DVec2, f64, f64) {
        let from_eye = world - self.eye;
        let distance = from_eye.dot(self.forward);
        let w = if self.is_parallel { 1.0 } else { distance };
        let flat = DVec2::new(from_eye.dot(self.right), from_eye.dot(self.up));
        let ndc = flat / self.half / w - self.aside;
        let (slope, lift) = self.depth_terms();
        let depth = (slope * distance + lift) / w;
        let held = match self.conventions.clip_depth {
            ClipDepth::ZeroToOne => depth,
            ClipDepth::MinusOneToOne => 0.5 * depth + 0.5,
        };
        (DVec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y), held, distance)
    }
}

fn of_rows(rows: [DVec4; 4]) -> Mat4 {
    DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose().as_mat4()
}

fn all_conventions() -> impl Iterator<Item = MatrixConventions> {
    (0..8).map(|n| MatrixConventions {
        looks_along: [LooksAlong::NegativeZ, LooksAlong::PositiveZ][n & 1],
        clip_depth: [ClipDepth::ZeroToOne, ClipDepth::MinusOneToOne][n >> 1 & 1],
        reversed_depth: n >> 2 == 1,
    })
}

/// One that looks aslant; to the left of a mirrored world the right is.
fn camera(conventions: MatrixConventions, is_mirrored: bool) -> Camera {
    let forward = DVec3::new(-0.4, -0.3, -0.8).normalize();
    let right = forward.cross(DVec3::Y).normalize() * if is_mirrored { -1.0 } else { 1.0 };
    let up = right.cross(forward) * if is_mirrored { -1.0 } else { 1.0 };
    Camera {
        eye: DVec3::new(2.5, 3.0, 7.0),
        right,
        up,
        forward,
        half: DVec2::new(0.9, 0.5),
        aside: DVec2::ZERO,
        near: 0.25,
        far: Some(40.0),
        is_parallel: false,
        conventions,
    }
}

/// Perspective, infinitely far, off its axis, mirrored, parallel from before and from behind the eye.
fn cameras() -> Vec<Camera> {
    let of = |conventions| {
        let plain = camera(conventions, false);
        let parallel = Camera { is_parallel: true, half: DVec2::new(6.0, 4.0), ..plain };
        [
            plain,
            Camera { far: None, ..plain },
            Camera { aside: DVec2::new(0.3, -0.004), far: None, ..plain },
            Camera { far: None, ..camera(conventions, true) },
            parallel,
            Camera { near: -8.0, far: Some(30.0), aside: DVec2::new(-0.2, 0.01), ..parallel },
        ]
    };
    all_conventions().flat_map(of).collect()
}

#[test]
fn every_host_and_its_view_see_points_at_the_same_places() {
    for camera in cameras() {
        let (eye, clip) = camera.matrices();
        let view = View::from_matrices(eye, clip, camera.conventions).unwrap();
        assert_eq!(view.reversed_depth, camera.conventions.reversed_depth);
        assert_eq!(view.projection == Projection::Orthographic, camera.is_parallel);
        assert!(view.forward().abs_diff_eq(camera.forward.as_vec3(), 1e-5), "{camera:?}");
        for n in 0..60 {
            let at = |step: f64| (f64::from(n) * step).fract() - 0.5;
            let aside = 3.0 * (at(0.618) * camera.right + at(0.414) * camera.up);
            let point = camera.eye + (2.0 + 0.5 * f64::from(n)) * camera.forward + aside;
            let (uv, depth, distance) = camera.seen(point);
            let world = point.as_vec3();
            let (found, found_depth) = view.uv_from_world(world).unwrap();
            assert!(found.abs_diff_eq(uv.as_vec2(), 1e-5), "{camera:?}: {found} for {uv}");
            assert!((f64::from(found_depth) - depth).abs() < 1e-5, "{camera:?}: {found_depth} for {depth}");
            let eye_distance = f64::from(-view.eye_from_world.transform_point3(world).z);
            let from_near = if camera.is_parallel { camera.near } else { 0.0 };
            assert!((eye_distance + from_near - distance).abs() < 1e-4, "{camera:?}: {eye_distance}");
            // Depths of 32 bits tell places apart near by.
            let back = view.world_from_uv(found, found_depth);
            let most = if distance < 8.0 { 1e-2 } else { 0.3 };
            assert!(back.distance(world) < most, "{camera:?} at {distance}: {back} for {world}");
        }
        let eye_point =
            camera.eye + if camera.is_parallel { camera.near * camera.forward } else { DVec3::ZERO };
        if camera.aside == DVec2::ZERO {
            assert!(view.eye().abs_diff_eq(eye_point.as_vec3(), 1e-4), "{camera:?}: {}", view.eye());
        }
    }
}

#[test]
fn a_view_s_own_matrices_give_that_view() {
    let (eye, target) = (Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0));
    let perspective = View::perspective(eye, target, Vec3::Y, 1.0, 1.5, 0.1, 20.0);
    let parallel = View::orthographic(eye, target, Vec3::Y, Vec2::new(8.0, 5.0), 20.0);
    for view in [perspective, perspective.with_reversed_depth(), parallel, parallel.with_reversed_depth()] {
        let clip_from_eye = view.clip_from_world * view.eye_from_world.inverse();
        let conventions =
            MatrixConventions { reversed_depth: view.reversed_depth, ..MatrixConventions::default() };
        let again = View::from_matrices(view.eye_from_world, clip_from_eye, conventions).unwrap();
        assert!(again.clip_from_world.abs_diff_eq(view.clip_from_world, 1e-4), "{again:?} for {view:?}");
        assert!(again.eye_from_world.abs_diff_eq(view.eye_from_world, 1e-4), "{again:?} for {view:?}");
        assert_eq!(again.projection, view.projection);
    }
}

/// The eyes of a stereo pair, moved by their projections; and a projection that is a multiple of another.
#[test]
fn the_eye_is_where_rays_meet() {
    let conventions = MatrixConventions { reversed_depth: true, ..MatrixConventions::default() };
    let camera = Camera { far: None, ..camera(conventions, false) };
    let (eye, clip) = camera.matrices();
    let plain = View::from_matrices(eye, clip, conventions).unwrap();
    for aside in [-0.0325f32, 0.0325] {
        let moved = clip * Mat4::from_translation(Vec3::new(-aside, 0.0, 0.0));
        let view = View::from_matrices(eye, moved, conventions).unwrap();
        let expected = camera.eye.as_vec3() + aside * camera.right.as_vec3();
        assert!(view.eye().abs_diff_eq(expected, 1e-4), "{} for {expected}", view.eye());
    }
    let twice = View::from_matrices(eye, clip * 2.0, conventions).unwrap();
    assert!(twice.clip_from_world.abs_diff_eq(plain.clip_from_world, 1e-5));
}

/// A near plane that stands aslant, as of mirrors: depth is no function of distance alone, and the eye stays where it is.
#[test]
fn a_near_plane_may_be_oblique() {
    let conventions = MatrixConventions::default();
    let (eye, clip) = camera(conventions, false).matrices();
    let plain = View::from_matrices(eye, clip, conventions).unwrap();
    let mut rows = [0, 1, 2, 3].map(|n| clip.row(n).as_dvec4());
    rows[2] = DVec4::new(0.1, 0.3, -0.6, -0.5);
    let view = View::from_matrices(eye, of_rows(rows), conventions).unwrap();
    assert!(view.eye_from_world.abs_diff_eq(plain.eye_from_world, 1e-5));
    let point = Vec3::new(0.3, 0.8, -0.4);
    let (uv, depth) = view.uv_from_world(point).unwrap();
    let (plain_uv, plain_depth) = plain.uv_from_world(point).unwrap();
    assert!(uv.abs_diff_eq(plain_uv, 1e-6) && (depth - plain_depth).abs() > 0.01, "{depth}, {plain_depth}");
    assert!(view.world_from_uv(uv, depth).distance(point) < 1e-3);
}

#[test]
fn what_cannot_be_a_view_is_refused() {
    let conventions = MatrixConventions { reversed_depth: true, ..MatrixConventions::default() };
    let perspective = Camera { far: None, ..camera(conventions, false) };
    let parallel = Camera { is_parallel: true, far: Some(30.0), ..perspective };
    let refused = |eye, clip, conventions| View::from_matrices(eye, clip, conventions).unwrap_err();
    for camera in [perspective, parallel] {
        let (eye, clip) = camera.matrices();
        assert!(View::from_matrices(eye, clip, conventions).is_ok());
        for number in [f32::NAN, f32::INFINITY] {
            let mut bad = eye;
            bad.w_axis.x = number;
            assert_eq!(refused(bad, clip, conventions), ViewError::NotFinite);
            let mut bad = clip;
            bad.z_axis.z = number;
            assert_eq!(refused(eye, bad, conventions), ViewError::NotFinite);
        }
        assert_eq!(refused(eye.transpose(), clip, conventions), ViewError::NotAffine);
        assert_eq!(
            refused(clip, clip, conventions),
            if camera.is_parallel { ViewError::NotRigid } else { ViewError::NotAffine }
        );
        assert_eq!(
            refused(Mat4::from_scale(Vec3::splat(0.01)) * eye, clip, conventions),
            ViewError::NotRigid
        );
        assert_eq!(refused(eye, Mat4::ZERO, conventions), ViewError::Singular);
        let flat = Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0));
        assert_eq!(refused(eye, flat * clip, conventions), ViewError::Singular);
        let deep = Mat4::from_scale(Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(refused(eye, deep * clip, conventions), ViewError::Singular);
        // What is said of them is not so.
        let standard = MatrixConventions { reversed_depth: false, ..conventions };
        assert_eq!(refused(eye, clip, standard), ViewError::DepthRunsTheOtherWay);
        let other = MatrixConventions { looks_along: LooksAlong::PositiveZ, ..conventions };
        let expected =
            if camera.is_parallel { ViewError::DepthRunsTheOtherWay } else { ViewError::LooksTheOtherWay };
        assert_eq!(refused(eye, clip, other), expected);
        assert_eq!(refused(eye, -1.0 * clip, conventions), ViewError::LooksTheOtherWay);
        // The eye turned behind the projection.
        let turned = clip * Mat4::from_rotation_y(0.3);
        assert_eq!(refused(eye, turned, conventions), ViewError::Slanted);
        // Numbers that are finite and whose product is not.
        let far_away = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::Z, Vec4::new(3e38, 3e38, 3e38, 1.0)) * eye;
        let wide = Mat4::from_scale(Vec3::new(1e3, 1e3, 1.0)) * clip;
        assert_eq!(refused(far_away, wide, conventions), ViewError::NotFinite);
    }
}
