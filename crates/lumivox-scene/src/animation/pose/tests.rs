use glam::{Mat4, Quat, Vec3};

use crate::{Camera, Clip, Instance, Light, Mesh, Scene, Track, Transform};

/// A forearm of one triangle at (2 0 0) on an elbow at (1 0 0) on a shoulder at the origin, with a lamp at its end.
fn arm() -> Scene {
    let mut scene = Scene::default();
    let forearm = vec![[2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 1.0]];
    scene.meshes.push(Mesh::flat("forearm", forearm, vec![[0, 1, 2]], 0));
    scene.instances.push(Instance { mesh: 0, world_from_local: Mat4::IDENTITY });
    scene.instances.push(Instance { mesh: 0, world_from_local: Mat4::from_translation(Vec3::Z) });
    scene.lights.push(Light::Point { position: Vec3::new(3.0, 0.0, 0.0), intensity: Vec3::ONE });
    scene.lights.push(Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE });
    scene.cameras.push(Camera::look("c", Vec3::new(3.0, 1.0, 0.0), Vec3::new(4.0, 1.0, 0.0), 40.0));
    let shoulder = scene.animation.add_node(None, Transform::default());
    let elbow = scene.animation.add_node(Some(shoulder), Transform::at(Vec3::X));
    scene.hang_instance(0, elbow);
    scene.hang_light(0, elbow);
    scene.hang_light(1, shoulder);
    scene.hang_camera(0, elbow);
    let quarter = |q: Quat| Track::rotation([(0.0, Quat::IDENTITY), (1.0, q), (2.0, Quat::IDENTITY)]);
    let turn = quarter(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let clip = Clip::new("bend").with(shoulder, turn.clone()).with(elbow, turn);
    scene.animation.add_clip(clip);
    let mut dim = Clip::new("dim");
    dim.push_light(0, Track::brightness([(0.0, 1.0), (2.0, 3.0)]));
    scene.animation.add_clip(dim);
    scene
}

#[test]
fn what_hangs_on_a_joint_moves_with_all_joints_above() {
    let scene = arm();
    let pose = scene.pose(0, 1.0);
    // The elbow goes to (0 1 0); what was two metres right of it is now two metres left of it.
    let tip = pose.world_from_local[0].transform_point3(Vec3::new(3.0, 0.0, 0.0));
    assert!(tip.abs_diff_eq(Vec3::new(-2.0, 1.0, 0.0), 1e-5), "{tip}");
    assert_eq!(pose.world_from_local[1], scene.instances[1].world_from_local, "hangs on nothing");
    let Light::Point { position, .. } = pose.lights[0] else { panic!("{:?}", pose.lights) };
    assert!(position.abs_diff_eq(tip, 1e-5), "{position}");
    let Light::Directional { direction, .. } = pose.lights[1] else { panic!("{:?}", pose.lights) };
    assert!(direction.abs_diff_eq(Vec3::X, 1e-6), "{direction}");
    let camera = &pose.cameras[0];
    assert!(camera.eye.abs_diff_eq(Vec3::new(-2.0, 0.0, 0.0), 1e-5), "{camera:?}");
    assert!((camera.target - camera.eye).abs_diff_eq(Vec3::NEG_X, 1e-5), "{camera:?}");
    assert!(camera.up.abs_diff_eq(Vec3::NEG_Y, 1e-5), "{camera:?}");
    assert_eq!((camera.fov_y, camera.name.as_str()), (scene.cameras[0].fov_y, "c"));
}

#[test]
fn no_such_clip_is_the_rest_even_after_another_pose_was_taken_up() {
    let mut scene = arm();
    let rest = scene.clone();
    scene.apply(&scene.pose(0, 0.7));
    assert_ne!(scene.instances, rest.instances);
    assert_ne!(scene.lights, rest.lights);
    scene.apply(&scene.pose(usize::MAX, 0.7));
    assert_eq!((&scene.instances, &scene.lights), (&rest.instances, &rest.lights));
    assert_eq!((&scene.cameras, &scene.meshes), (&rest.cameras, &rest.meshes));
}

#[test]
fn every_time_gives_a_finite_pose_and_the_ends_meet() {
    let scene = arm();
    assert_eq!(scene.pose(0, 0.0), scene.pose(0, 2.0));
    assert_eq!(scene.pose(0, 0.25), scene.pose(0, -1.75));
    assert_eq!(scene.pose(0, f32::NAN), scene.pose(0, 0.0));
    for t in [1e30, -1e30, f32::INFINITY, f32::MIN_POSITIVE, f32::MAX] {
        assert!(scene.pose(0, t).world_from_local.iter().all(|m| m.is_finite()), "{t}");
    }
    let near = scene.pose(0, 1.999).world_from_local[0];
    assert!(near.abs_diff_eq(scene.pose(0, 0.0).world_from_local[0], 1e-2), "{near}");
}

#[test]
fn brightness_scales_a_hung_light_however_often_it_is_applied() {
    let mut scene = arm();
    for _ in 0..3 {
        scene.apply(&scene.pose(1, 1.0));
        let Light::Point { intensity, .. } = scene.lights[0] else { panic!("{:?}", scene.lights) };
        assert_eq!(intensity, Vec3::splat(2.0));
    }
}

#[test]
fn numbers_too_large_leave_things_at_rest() {
    let mut scene = arm();
    let shoulder = crate::NodeId(0);
    let huge = Track::scale([(0.0, Vec3::splat(3e38))]);
    let far = Track::translation([(0.0, Vec3::splat(3e38))]);
    let clip = scene.animation.add_clip(Clip::new("huge").with(shoulder, huge).with(shoulder, far));
    let pose = scene.pose(clip, 0.0);
    assert!(pose.world_from_local.iter().all(|m| m.is_finite()));
    assert!(pose.lights.iter().all(|l| !matches!(l, Light::Point { position, .. } if !position.is_finite())));
    assert!(pose.cameras.iter().all(|c| c.eye.is_finite() && c.target.is_finite()));
}

#[test]
fn lists_changed_afterwards_do_no_harm() {
    let mut scene = arm();
    scene.instances.clear();
    scene.lights = vec![Light::Directional { direction: Vec3::X, irradiance: Vec3::ONE }];
    scene.cameras.clear();
    let pose = scene.pose(0, 1.0);
    assert_eq!((pose.world_from_local.len(), pose.cameras.len()), (0, 0));
    assert_eq!(pose.lights, scene.lights, "another kind of light is not the one that was hung");
    assert!(scene.bounds_in_motion(0).is_empty());
    let mut other = arm();
    other.apply(&pose);
    other.hang_light(9, crate::NodeId(0));
    other.hang_camera(0, crate::NodeId(9));
    let stray = other.animation.add_node(Some(crate::NodeId(99)), Transform::at(Vec3::Y));
    assert_eq!(other.animation.world_from_node(stray).w_axis.y, 1.0);
}

#[test]
fn a_camera_between_two_nodes_follows_both() {
    let mut scene = Scene::default();
    scene.cameras.push(Camera::look("c", Vec3::ZERO, Vec3::NEG_Z, 40.0));
    let eye = scene.animation.add_node(None, Transform::default());
    let target = scene.animation.add_node(None, Transform::at(Vec3::NEG_Z));
    scene.hang_camera_between(0, eye, target);
    let eyes = Track::translation([(0.0, Vec3::ZERO), (1.0, Vec3::Y)]);
    let targets = Track::translation([(0.0, Vec3::NEG_Z), (1.0, 5.0 * Vec3::Y)]);
    scene.animation.add_clip(Clip::new("path").with(eye, eyes).with(target, targets));
    let half = &scene.pose(0, 0.5).cameras[0];
    assert_eq!((half.eye, half.target), (Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.0, 2.5, -0.5)));
    // Just before the end it looks nearly straight up; the picture still has an up of its own.
    let end = &scene.pose(0, 0.9999).cameras[0];
    assert!((end.target - end.eye).normalize_or_zero().cross(end.up).length() > 1e-4);
}

#[test]
fn the_box_in_motion_holds_the_whole_way() {
    let scene = arm();
    let (now, all) = (scene.bounds(), scene.bounds_in_motion(0));
    assert!(all.contains(now.min) && all.contains(now.max));
    assert!(all.min.x < -1.9 && all.max.y > 2.0, "{all:?}");
    assert_eq!(scene.bounds_in_motion(7), now);
    for i in 0..48u8 {
        let mut moved = scene.clone();
        moved.apply(&scene.pose(0, f32::from(i) * 2.0 / 48.0));
        let b = moved.bounds();
        assert!(all.min.cmple(b.min + 0.01).all() && all.max.cmpge(b.max - 0.01).all(), "{i}");
    }
}
