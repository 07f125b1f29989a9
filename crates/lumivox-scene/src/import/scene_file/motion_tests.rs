use glam::{Quat, Vec3};

use super::*;
use crate::Light;

fn parse(text: &str) -> Scene {
    import(&Source::of_memory("a.scene.json"), text.as_bytes(), &Limits::default()).unwrap()
}

fn meshes(entry: &str) -> Scene {
    parse(&format!(r#"{{"meshes": [{{"box": {{"center": [0,1,0], "size": [1,1,1]}}, {entry}}}]}}"#))
}

fn lights(entry: &str) -> Scene {
    parse(&format!(
        r#"{{"lights": [{{"type": "point", "position": [2,0,0], "intensity": [1,2,3], {entry}}}]}}"#
    ))
}

/// Where a point of the first instance is at a time.
fn at(scene: &Scene, seconds: f32, point: Vec3) -> Vec3 {
    scene.pose(0, seconds).world_from_local[0].transform_point3(point)
}

fn near(a: Vec3, b: Vec3) -> bool {
    a.abs_diff_eq(b, 1e-5)
}

#[test]
fn a_spin_is_about_the_middle_and_goes_with_the_place() {
    let scene = meshes(r#""translate": [5,0,0], "motion": {"spin": {"seconds_per_turn": 4}}"#);
    assert_eq!((scene.clips()[0].name.as_str(), scene.clips()[0].duration), ("motion", 4.0));
    assert_eq!(scene.instances[0].world_from_local, Mat4::from_translation(5.0 * Vec3::X));
    assert!(near(at(&scene, 1.0, Vec3::new(0.5, 1.0, 0.0)), Vec3::new(5.0, 1.0, -0.5)));
    assert!(near(at(&scene, 2.7, Vec3::Y), Vec3::new(5.0, 1.0, 0.0)), "the middle stays");
    let back = meshes(r#""motion": {"spin": {"axis": [2,0,0], "center": [0,0,0], "seconds_per_turn": -4}}"#);
    assert!(near(at(&back, 1.0, Vec3::Y), Vec3::NEG_Z));
}

#[test]
fn an_orbit_is_about_a_point_of_the_world() {
    let scene =
        meshes(r#""translate": [3,0,0], "motion": {"orbit": {"center": [1,0,0], "seconds_per_turn": 8}}"#);
    assert!(near(at(&scene, 2.0, Vec3::ZERO), Vec3::new(1.0, 0.0, -2.0)));
    let lamp = lights(
        r#""motion": {"orbit": {"center": [0,0,0], "seconds_per_turn": 8}, "keyframes":
        [{"seconds": 0, "brightness": 1}, {"seconds": 8, "brightness": 3, "translate": [1,0,0]}]}"#,
    );
    let Light::Point { position, intensity } = lamp.pose(0, 4.0).lights[0] else { panic!() };
    assert!(near(position, Vec3::new(-3.0, 0.0, 0.0)), "{position}");
    assert!(near(intensity, Vec3::new(2.0, 4.0, 6.0)), "{intensity}");
}

#[test]
fn keyframes_stand_for_the_place_and_may_state_a_part_of_it() {
    let scene = meshes(
        r#""translate": [9,9,9], "scale": 2, "motion": {"keyframes": [{"seconds": 1, "translate": [0,0,0], "rotate_deg": [0,0,0]},
        {"seconds": 2, "rotate_deg": [0,0,180]}, {"seconds": 3, "translate": [4,0,0], "rotate_deg": [0,0,720]}]}"#,
    );
    assert_eq!(scene.instances[0].world_from_local.w_axis.x, 9.0, "at rest it stands where it is placed");
    assert!(near(at(&scene, 0.5, Vec3::X), 2.0 * Vec3::X));
    assert!(near(at(&scene, 1.5, Vec3::X), Vec3::new(1.0, 2.0, 0.0)), "{}", at(&scene, 1.5, Vec3::X));
    // Half way from half a turn to two turns is one and a quarter.
    assert!(near(at(&scene, 2.5, Vec3::X), Vec3::new(3.0, 2.0, 0.0)), "{}", at(&scene, 2.5, Vec3::X));
    assert_eq!(scene.clips()[0].duration, 3.0);
    let smooth = meshes(
        r#""motion": {"interpolation": "smooth", "keyframes": [{"seconds": 0, "translate": [0,0,0], "rotate_deg": [0,0,0]},
        {"seconds": 1, "translate": [1,0,0], "rotate_deg": [0,400,0]}, {"seconds": 2, "translate": [0,0,0], "rotate_deg": [0,0,0]}]}"#,
    );
    let turned = Quat::from_rotation_y(400f32.to_radians()) * Vec3::X + Vec3::X;
    assert!(near(at(&smooth, 1.0, Vec3::X), turned), "{}", at(&smooth, 1.0, Vec3::X));
    let step = meshes(
        r#""motion": {"interpolation": "step", "keyframes": [{"seconds": 0, "rotate_deg": [0,0,0]}, {"seconds": 1, "rotate_deg": [0,90,0]}]}"#,
    );
    assert!(near(at(&step, 0.99, Vec3::X), Vec3::X));
}

#[test]
fn what_follows_the_last_keyframe() {
    let keys = r#""keyframes": [{"seconds": 0, "translate": [0,0,0]}, {"seconds": 2, "translate": [2,0,0]}]"#;
    let x = |repeat: &str, seconds: f32| {
        let other =
            r#"{"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "motion": {"spin": {"seconds_per_turn": 3}}}"#;
        let scene = parse(&format!(
            r#"{{"meshes": [{{"box": {{"center": [0,1,0], "size": [1,1,1]}}, "motion": {{"repeat": "{repeat}", {keys}}}}}, {other}]}}"#
        ));
        (at(&scene, seconds, Vec3::ZERO).x, scene.clips()[0].duration)
    };
    // With a period of two and one of three seconds, all begin anew after six.
    assert_eq!(x("loop", 3.5), (1.5, 6.0));
    assert_eq!(x("ping_pong", 3.5), (0.5, 12.0));
    assert_eq!(x("ping_pong", 4.5), (0.5, 12.0));
    assert_eq!(x("once", 2.5), (2.0, 3.0));
    let odd = parse(
        r#"{"meshes": [{"box": {"center": [0,0,0], "size": [1,1,1]}, "motion": {"spin": {"seconds_per_turn": 999.983}}},
        {"box": {"center": [0,0,0], "size": [1,2,1]}, "motion": {"spin": {"seconds_per_turn": 998.989}}}]}"#,
    );
    assert_eq!(odd.clips()[0].duration, 3600.0);
    assert!(odd.report.warnings[0].contains("no common period"), "{:?}", odd.report);
}

#[test]
fn the_camera_goes_through_its_path() {
    let scene = parse(
        r#"{"camera": {"eye": [0,1,5], "target": [0,1,0], "fov_y_deg": 40, "path": {"keyframes": [
        {"seconds": 0, "eye": [0,1,5]}, {"seconds": 1, "eye": [3,1,4]}, {"seconds": 2, "eye": [5,1,0], "target": [0,2,0]}]}}}"#,
    );
    assert_eq!(scene.cameras[0].eye, Vec3::new(0.0, 1.0, 5.0));
    let camera = &scene.pose(0, 1.0).cameras[0];
    assert!(near(camera.eye, Vec3::new(3.0, 1.0, 4.0)) && camera.up.is_normalized(), "{camera:?}");
    // Smooth: beside the straight line between the keys.
    assert!(scene.pose(0, 0.5).cameras[0].eye.distance(Vec3::new(1.5, 1.0, 4.5)) > 0.05);
    assert!(near(camera.target, Vec3::new(0.0, 2.0, 0.0)), "the only target stated: {camera:?}");
}

#[test]
fn a_matrix_says_the_place_by_rows() {
    let rows = r#""matrix": [[0,0,1,4],[0,1,0,5],[-1,0,0,6],[0,0,0,1]]"#;
    let scene =
        meshes(&format!(r#"{rows}, "motion": {{"spin": {{"seconds_per_turn": 2, "center": [0,0,0]}}}}"#));
    let place = scene.instances[0].world_from_local;
    assert!(near(place.transform_point3(Vec3::X), Vec3::new(4.0, 5.0, 5.0)));
    assert!(near(at(&scene, 1.0, Vec3::X), Vec3::new(4.0, 5.0, 7.0)));
}

#[test]
fn motions_without_meaning_are_refused_with_their_place() {
    let error = |text: &str| {
        let bytes = text.as_bytes();
        import(&Source::of_memory("a.scene.json"), bytes, &Limits::default()).unwrap_err().to_string()
    };
    let mesh = |rest: &str| {
        error(&format!(r#"{{"meshes": [{{"box": {{"center": [0,1,0], "size": [1,1,1]}}, {rest}}}]}}"#))
    };
    let rows = r#""matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"#;
    for (rest, why) in [
        (r#""motion": {}"#.to_owned(), "has meshes[0] with a motion that moves nothing"),
        (r#""motion": {"spin": {"seconds_per_turn": 0}}"#.to_owned(), "whose seconds_per_turn is 0"),
        (r#""motion": {"spin": {"seconds_per_turn": 1, "axis": [0,0,0]}}"#.to_owned(), "axis has no length"),
        (r#""motion": {"keyframes": [{"seconds": -1}]}"#.to_owned(), "with a keyframe at -1 seconds"),
        (
            r#""motion": {"keyframes": [{"seconds": 1}, {"seconds": 1}]}"#.to_owned(),
            "at 1 seconds after one at 1",
        ),
        (r#""motion": {"clip": "Walk"}"#.to_owned(), "with a clip, which only files have"),
        (format!(r#"{rows}, "scale": 2"#), "both a matrix and scale"),
        (format!(r#"{rows}, "motion": {{"keyframes": [{{"seconds": 1}}]}}"#), "both a matrix and keyframes"),
        (rows.replace("0,0,0,1]]", "0,0,0,2]]"), "does not end in the row 0 0 0 1"),
        (rows.replace("[[1,", "[[1e39,"), "a.scene.json"),
    ] {
        assert!(mesh(&rest).contains(why), "{}", mesh(&rest));
    }
    let light = r#"{"lights": [{"type": "point", "position": [0,0,0], "intensity": [1,1,1], "motion": {"keyframes": [{"seconds": 0, "brightness": -1}]}}]}"#;
    assert!(error(light).contains("lights[0] whose keyframes' brightness is negative"), "{}", error(light));
    let camera =
        r#"{"camera": {"eye": [0,0,1], "target": [0,0,0], "fov_y_deg": 40, "path": {"keyframes": []}}}"#;
    assert!(error(camera).contains("camera with a path without keyframes"), "{}", error(camera));
}
