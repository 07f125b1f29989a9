use super::*;
use crate::Light;
use glam::Vec4;

fn parse(text: &str) -> Result<Scene, SceneError> {
    import(&Source::of_memory("a.scene.json"), text.as_bytes(), &Limits::default())
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

#[test]
fn every_kind_of_entry_is_read() {
    let scene = parse(
        r#"{"camera": {"eye": [0,1,3.4], "target": [0,1,0], "up": [0,2,0], "fov_y_deg": 39.3},
        "lights": [ {"type": "point", "position": [0,1.9,0], "intensity": [5,5,5]},
            {"type": "directional", "direction": [0,-2,0], "irradiance": [3,3,3]},
            {"type": "spot", "position": [0,2,0], "target": [0,0,0], "intensity": [9,9,9], "cutoff_deg": 30, "beam_deg": 25},
            {"type": "rect", "origin": [0,0,0], "u": [1,0,0], "v": [0,0,1], "radiance": [5,5,5]},
            {"type": "constant", "radiance": [1,1,1]} ],
        "meshes": [ {"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "albedo": [0.7,0.1,0.1], "emission": [1,2,3]},
            {"box": {"center": [0,0.3,0], "size": [0.6,0.6,0.6], "rot_y_deg": 15}},
            {"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "scale": 2.0, "rotate_deg": [90,0,0], "translate": [0,5,0]},
            {"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "scale": [1,1,2], "translate": [0,9,0]} ] }"#,
    )
    .unwrap();
    assert_eq!((scene.cameras.len(), scene.lights.len(), scene.sky), (1, 4, Vec3::ONE));
    assert_eq!(scene.lights[1], Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(3.0) });
    assert_eq!(scene.triangle_count(), 2 + 12 + 2 + 2);
    // The last two are the same mesh in two places.
    assert_eq!((scene.meshes.len(), scene.instances.len()), (3, 4));
    let red = &scene.materials[scene.meshes[0].material];
    assert_eq!((red.base_color, red.emission), (Vec4::new(0.7, 0.1, 0.1, 1.0), Vec3::new(1.0, 2.0, 3.0)));
    let corner = scene.instances[2].world_from_local.transform_point3(Vec3::new(1.0, 0.0, 1.0));
    assert!(corner.abs_diff_eq(Vec3::new(2.0, 3.0, 0.0), 1e-5), "{corner}");
    for (t, n) in scene.meshes[1].indices.iter().map(|t| (t, scene.meshes[1].normals[t[0] as usize])) {
        let p = Vec3::from(scene.meshes[1].positions[t[0] as usize]) - Vec3::new(0.0, 0.3, 0.0);
        assert!(p.dot(n.into()) > 0.29, "boxes face outwards");
    }
}

#[test]
fn rotations_are_about_x_then_y_then_z() {
    let scene =
        parse(r#"{"meshes": [{"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "rotate_deg": [90, 90, 0]}]}"#)
            .unwrap();
    // Y goes to Z about X, then Z to X about Y.
    let y = scene.instances[0].world_from_local.transform_vector3(Vec3::Y);
    assert!(y.abs_diff_eq(Vec3::X, 1e-6), "{y}");
}

#[test]
fn unknown_keys_are_named_with_their_place() {
    let text = error("{\"meshes\": [],\n \"lihgts\": []}");
    assert!(text.starts_with("a.scene.json: is no valid scene file: unknown field `lihgts`"), "{text}");
    assert!(text.contains("line 2"), "{text}");
    let cases = [
        (r#"{"camera": {"eye": [0,0,1], "target": [0,0,0], "fov_y_deg": 40, "fov": 1}}"#, "`fov`"),
        (
            r#"{"lights": [{"type": "point", "position": [0,0,0], "intensity": [1,1,1], "power": 3}]}"#,
            "`power`",
        ),
        (r#"{"lights": [{"type": "laser"}]}"#, "`laser`"),
        (r#"{"meshes": [{"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "colour": [1,1,1]}]}"#, "`colour`"),
        (r#"{"meshes": [{"box": {"center": [0,0,0], "size": [1,1,1], "rot": 3}}]}"#, "`rot`"),
    ];
    for (text, name) in cases {
        assert!(error(text).contains(name), "{}", error(text));
    }
}

#[test]
fn values_without_meaning_are_refused_with_their_place() {
    let cases = [
        (r#"{"meshes": [{}]}"#, "has meshes[0] that is not exactly one of file, quad and box"),
        (
            r#"{"meshes": [{"box": {"center": [0,0,0], "size": [1,-1,1]}}]}"#,
            "meshes[0] whose size is negative",
        ),
        (r#"{"meshes": [{"file": "x.blend"}]}"#, "cannot use meshes[0]: x.blend: unknown file type"),
        (r#"{"meshes": [{"file": "x.glb"}]}"#, "cannot use meshes[0]: x.glb: cannot be read"),
        (
            r#"{"lights": [{"type": "constant", "radiance": [1,-1,1]}]}"#,
            "has lights[0] whose radiance is negative",
        ),
        (
            r#"{"lights": [{"type": "directional", "direction": [0,0,0], "irradiance": [1,1,1]}]}"#,
            "no length",
        ),
        (
            r#"{"camera": {"eye": [0,0,1], "target": [0,0,0], "fov_y_deg": 180}}"#,
            "camera whose fov_y_deg is 180",
        ),
        (r#"{"camera": {"eye": [0,1,0], "target": [0,0,0], "fov_y_deg": 18}}"#, "looks along its up"),
        (r#"{"camera": {"eye": [0,1,1e39], "target": [0,0,0], "fov_y_deg": 18}}"#, "a.scene.json"),
        (
            r#"{"meshes": [{"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "albedo": [2,0,0]}]}"#,
            "albedo is above 1",
        ),
    ];
    for (text, part) in cases {
        assert!(error(text).contains(part), "{}", error(text));
    }
}
