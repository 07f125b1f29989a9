//! Files that ask for too much, or state things that no one means: each ends soon, in an error that names file and
//! reason or in a scene of sound numbers.

use std::time::{Duration, Instant};

use glam::Vec3;
use lumivox_scene::{Limits, Scene, SceneError, load_bytes};

fn read(name: &str, bytes: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    let start = Instant::now();
    let result = load_bytes(name, bytes.as_ref(), &Limits::default());
    assert!(start.elapsed() < Duration::from_secs(5), "{name} took {:?}", start.elapsed());
    result
}

/// The message, which names the file first.
fn refused(name: &str, bytes: impl AsRef<[u8]>, why: &str) {
    let text = read(name, bytes).expect_err(why).to_string();
    assert!(text.starts_with(&format!("{name}: ")) && text.contains(why), "{text}");
}

fn gltf(rest: &str) -> String {
    format!(r#"{{"asset":{{"version":"2.0"}},{rest}}}"#)
}

#[test]
fn node_trees_of_any_depth_and_cycles_are_refused() {
    for n in [1_000, 100_000] {
        let nodes: Vec<String> = (1..n).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
        let deep = gltf(&format!(r#""nodes":[{},{{}}],"scenes":[{{"nodes":[0]}}]"#, nodes.join(",")));
        refused("deep.gltf", deep, "the depth of its node tree is 129, more than the limit of 128");
    }
    let nested = format!("{}{}", "[".repeat(1_000_000), "]".repeat(1_000_000));
    refused("deep.gltf", gltf(&format!(r#""nodes":{nested}"#)), "is no valid glTF JSON");
    refused("deep.scene.json", format!(r#"{{"meshes":{nested}}}"#), "is no valid scene file");
    for (nodes, why) in [
        (r#"[{"children":[0]}],"scenes":[{"nodes":[0]}]"#, "reaches node 0 twice"),
        (
            r#"[{"children":[1]},{"children":[2]},{"children":[0]}],"scenes":[{"nodes":[1]}]"#,
            "reaches node 1 twice",
        ),
        (r#"[{"children":[1]},{"children":[0]}]"#, "has no root among its nodes"),
        (r#"[{"children":[1,1]},{}],"scenes":[{"nodes":[0]}]"#, "reaches node 1 twice"),
    ] {
        refused("cycle.gltf", gltf(&format!(r#""nodes":{nodes}"#)), why);
    }
}

#[test]
fn giant_counts_cost_nothing() {
    let ply = |vertices: &str, faces: &str, format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
            element face {faces}\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
        )
    };
    for format in ["ascii", "binary_little_endian"] {
        for (vertices, faces) in
            [("4294967295", "1"), ("3", "18446744073709551615"), ("99999999999999999999", "1")]
        {
            let result = read("giant.ply", ply(vertices, faces, format));
            assert!(result.unwrap_err().to_string().starts_with("giant.ply: "));
        }
    }
    let mut stl = vec![b' '; 80];
    stl.extend(u32::MAX.to_le_bytes());
    stl.extend([0; 50]);
    assert!(read("giant.stl", &stl).is_err());
    for counts in ["4294967295 1 0", "3 4294967295 0", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2"] {
        assert!(read("giant.off", format!("OFF\n{counts}\n0 0 0\n")).is_err());
    }
    assert!(read("giant.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967295\n").is_err());
    let header = |length: u32| [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes()].concat();
    refused("giant.glb", header(u32::MAX), "states a length of 4294967295 bytes");
    // Accessors without a buffer are zeros, as many as they say.
    let accessor = |kind: &str| {
        format!(
            r#"{{"componentType":5126,"count":9007199254740991,"type":"{kind}"}},{{"componentType":5126,"count":1,"type":"VEC3"}}"#
        )
    };
    let mesh = |attributes: &str, kind: &str| {
        gltf(&format!(
            r#""accessors":[{}],"meshes":[{{"primitives":[{{"attributes":{attributes}}}]}}],"nodes":[{{"mesh":0,"skin":0}}],
            "skins":[{{"joints":[0],"inverseBindMatrices":0}}],"animations":[{{"channels":[{{"sampler":0,
            "target":{{"node":0,"path":"scale"}}}}],"samplers":[{{"input":0,"output":1}}]}}]"#,
            accessor(kind)
        ))
    };
    refused("giant.gltf", mesh(r#"{"POSITION":0}"#, "VEC3"), "the number of vertices is 9007199254740991");
    refused("giant.gltf", mesh(r#"{"POSITION":1,"NORMAL":0}"#, "VEC3"), "elements beside 1 positions");
    refused(
        "giant.gltf",
        mesh(r#"{"POSITION":1}"#, "MAT4"),
        "the number of bind matrices is 9007199254740991",
    );
    let keys = mesh(r#"{"POSITION":1}"#, "SCALAR").replace(r#","inverseBindMatrices":0"#, "");
    refused("giant.gltf", keys, "the number of keyframes is 9007199254740992");
    let text = r#"{"meshes":[{"box":{"center":[0,0,0],"size":[1,1,1]},"motion":{"keyframes":[{"seconds":0,"rotate_deg":[0,0,0]},
        {"seconds":1,"rotate_deg":[0,1e30,0]}]}}]}"#;
    assert!(read("giant.scene.json", text).is_ok(), "more turns than steps");
}

/// Meshes that share what deforms them must not multiply it without bound.
#[test]
fn shared_morph_targets_are_counted_for_every_node() {
    let targets = vec![r#"{"POSITION":0}"#; 2_000].join(",");
    let nodes = vec![r#"{"mesh":0}"#; 2_000].join(",");
    let text = gltf(&format!(
        r#""accessors":[{{"componentType":5126,"count":1000,"type":"VEC3"}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{targets}]}}]}}]"#
    ));
    refused("morph.gltf", text, "the number of joint weights and morph offsets is");
}

#[test]
fn numbers_at_the_edge_stay_sound() {
    let obj = "v nan 0 0\nv 1e30 0 0\nv 0 1e30 0\nv 0 0 1e30\nv 1e38 1e38 -1e38\nv inf 0 0\nv 1e-40 0 0\n\
        f 1 2 3\nf 2 3 4\nf 2 4 5\nf 2 5 6\nf 7 7 7\n";
    for (name, text) in [
        ("edge.obj", obj.to_owned()),
        ("edge.off", "OFF\n4 2 0\nnan 0 0\n1e30 0 0\n0 1e30 0\n0 0 1e30\n3 0 1 2\n3 1 2 3\n".to_owned()),
    ] {
        let scene = read(name, text).expect("what is not finite is dropped");
        assert!(scene.report.dropped_vertices > 0, "{name}");
        for mesh in &scene.meshes {
            assert!(mesh.positions.iter().flatten().all(|v| v.is_finite()), "{name}");
            assert!(mesh.normals.iter().all(|&n| Vec3::from(n).is_normalized()), "{name}");
        }
        assert!(scene.bounds().max.is_finite() && scene.bounds_in_motion(0).max.is_finite());
    }
}

#[test]
fn boxes_without_area_and_empty_meshes_are_scenes() {
    let text = r#"{"meshes":[{"box":{"center":[0,0,0],"size":[0,0,0]}},{"box":{"center":[0,0,0],"size":[1,0,1]},
        "motion":{"spin":{"seconds_per_turn":1}}},{"quad":[[1,1,1],[1,1,1],[1,1,1],[1,1,1]],"scale":0}]}"#;
    let scene = read("flat.scene.json", text).expect("a flat box is still a box");
    assert_eq!(scene.triangle_count(), 12 + 12 + 2);
    assert!(scene.meshes.iter().flat_map(|m| &m.normals).all(|&n| Vec3::from(n).is_normalized()));
    assert!(scene.pose(0, 0.3).world_from_local.iter().all(|m| m.is_finite()));
    for (name, text) in [
        ("empty.obj", "# nothing\n"),
        ("empty.off", "OFF\n0 0 0\n"),
        ("empty.gltf", r#"{"asset":{"version":"2.0"}}"#),
        (
            "empty.gltf",
            r#"{"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":0,"type":"VEC3"}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":0}]}]}],"nodes":[{"mesh":0}]}"#,
        ),
        ("empty.scene.json", "{}"),
    ] {
        let scene = read(name, text).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.triangle_count(), 0, "{name}");
        assert!(scene.bounds().is_empty() && scene.bounds_in_motion(3).is_empty(), "{name}");
    }
}
