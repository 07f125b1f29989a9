//! Thousands of damaged files for every importer, always the same ones: each must end in a scene or an error, without
//! a panic and without taking long.

use std::panic::catch_unwind;
use std::time::{Duration, Instant};

use lumivox_scene::{Limits, Scene, SceneError, load_bytes};

#[path = "common/damage.rs"]
mod damage;

use damage::{Random, damaged};

/// Much longer than any of these small files takes, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(5);

/// Runs `count` damaged versions; `finish` may repair what would only hide deeper faults, such as lengths.
fn run(name: &str, original: &[u8], count: u32, finish: impl Fn(Vec<u8>) -> Vec<u8>) {
    load_bytes(name, &finish(original.to_vec()), &Limits::default()).expect("the undamaged file is sound");
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut scenes, mut caught) = (0, Vec::new());
    for i in 0..count {
        let bytes = finish(damaged(original, &mut random));
        let start = Instant::now();
        let result = catch_unwind(|| load_bytes(name, &bytes, &Limits::default()));
        let shown = || String::from_utf8_lossy(&bytes).into_owned();
        assert!(start.elapsed() < PATIENCE, "{name} {i} took {:?}: {}", start.elapsed(), shown());
        match result {
            Err(_) => panic!("{name} {i} panicked: {}", shown()),
            Ok(Err(SceneError::Parser { reason, .. })) if !caught.contains(&reason) => caught.push(reason),
            Ok(Err(error)) => assert!(!error.to_string().is_empty()),
            Ok(Ok(scene)) => {
                scenes += 1;
                for mesh in &scene.meshes {
                    let n = mesh.positions.len();
                    assert_eq!([mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()], [n; 3]);
                    assert!(mesh.indices.iter().flatten().all(|&v| (v as usize) < n));
                    assert!(mesh.positions.iter().flatten().all(|v| v.is_finite()));
                    assert!(mesh.material < scene.materials.len());
                }
                assert!(scene.instances.iter().all(|k| k.mesh < scene.meshes.len()));
                check_motion(scene);
            }
        }
    }
    // The importers' own checks find everything first; the fence is for what no one has thought of.
    assert_eq!(caught, Vec::<String>::new(), "{name}: panics within a parser");
    assert!(scenes > 0, "{name}: the damage is so heavy that it tests nothing");
}

/// Any clip of any file gives finite poses at any time, and applying one gives the rest back afterwards.
fn check_motion(mut scene: Scene) {
    for clip in 0..scene.clips().len().min(3) {
        let duration = scene.clips()[clip].duration;
        assert!(duration > 0.0 && duration.is_finite());
        for t in [0.0, 0.37 * duration, 0.99 * duration, -1e30, f32::NAN] {
            let pose = scene.pose(clip, t);
            assert!(pose.world_from_local.iter().all(|m| m.is_finite()));
            for d in &pose.deformed {
                assert!(d.positions.iter().flatten().all(|v| v.is_finite()));
                let unit = |n: &[f32; 3]| (n.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-3;
                assert!(d.normals.iter().all(unit), "{:?}", d.normals);
            }
            assert_eq!((pose.lights.len(), pose.cameras.len()), (scene.lights.len(), scene.cameras.len()));
            assert!(
                pose.cameras.iter().all(|c| c.eye.is_finite() && c.target.is_finite() && c.up.is_finite())
            );
            scene.apply(&pose);
        }
    }
    let rest = scene.pose(usize::MAX, 0.0);
    scene.apply(&rest);
    assert_eq!(scene.pose(usize::MAX, 1.0), rest);
}

/// A GLB with most of what the importer reads: sparse and strided accessors, strips, textures, camera and light.
fn gltf_json(png: usize) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,3]}}],
"extensionsUsed":["KHR_lights_punctual","KHR_materials_emissive_strength"],
"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","intensity":3,"spot":{{"outerConeAngle":0.5}}}}]}}}},
"nodes":[{{"children":[1,2],"translation":[1,2,3]}},{{"mesh":0,"scale":[2,2,2]}},{{"camera":0,"rotation":[0,0,0,1]}},
{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}},"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}}],
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.7,"znear":0.1}}}}],
"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[1,0.5,0.2,1],"baseColorTexture":{{"index":0}}}},"alphaMode":"MASK",
"emissiveFactor":[1,1,0],"extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":4}}}}}}],
"textures":[{{"source":0,"sampler":0}}],"samplers":[{{"wrapS":33071,"wrapT":33648}}],
"images":[{{"bufferView":2,"mimeType":"image/png"}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}},"indices":4,"material":0}},
{{"attributes":{{"POSITION":5}},"mode":5}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]}},
{{"bufferView":0,"byteOffset":12,"componentType":5126,"count":4,"type":"VEC3"}},
{{"bufferView":0,"byteOffset":8,"componentType":5123,"normalized":true,"count":4,"type":"VEC2"}},
{{"bufferView":0,"byteOffset":4,"componentType":5121,"normalized":true,"count":4,"type":"VEC4"}},
{{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}},
{{"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1],"sparse":{{"count":2,
"indices":{{"bufferView":1,"byteOffset":2,"componentType":5123}},"values":{{"bufferView":0}}}}}}],
"bufferViews":[{{"buffer":0,"byteLength":96,"byteStride":24}},{{"buffer":0,"byteOffset":96,"byteLength":12}},
{{"buffer":0,"byteOffset":108,"byteLength":{png}}}],"buffers":[{{"byteLength":{}}}]}}"#,
        108 + png
    )
}

fn gltf_buffer() -> (Vec<u8>, usize) {
    let mut bytes: Vec<u8> = Vec::new();
    for [x, y] in [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        bytes.extend([x, y, 0.0, 0.0, 0.0, 1.0].iter().flat_map(|v| v.to_le_bytes()));
    }
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::new(2, 2)
        .write_to(&mut png, image::ImageFormat::Png)
        .expect("two pixels can be written");
    bytes.extend(png.get_ref());
    (bytes, png.get_ref().len())
}

fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| [bytes, &vec![with; bytes.len().wrapping_neg() % 4]].concat();
    let (json, bin) = (padded(json, b' '), padded(bin, 0));
    let length = (12 + 8 + json.len() + 8 + bin.len()) as u32;
    let u = |n: usize| (n as u32).to_le_bytes();
    let parts: [&[u8]; 9] = [
        b"glTF",
        &2u32.to_le_bytes(),
        &length.to_le_bytes(),
        &u(json.len()),
        b"JSON",
        &json,
        &u(bin.len()),
        b"BIN\0",
        &bin,
    ];
    parts.concat()
}

#[test]
fn glb_json() {
    let (bin, png) = gltf_buffer();
    run("m.glb", gltf_json(png).as_bytes(), 6000, |json| glb(&json, &bin));
}

#[test]
fn glb_bytes() {
    let (bin, png) = gltf_buffer();
    run("m.glb", &glb(gltf_json(png).as_bytes(), &bin), 3000, |bytes| bytes);
    run("m.glb", &bin, 1000, |bin| glb(gltf_json(png).as_bytes(), &bin));
}

/// A skinned, morphing triangle, a lamp and a camera that move, all three interpolations, a texture transform.
fn animated() -> (String, Vec<u8>) {
    let mut bin: Vec<u8> = Vec::new();
    let mut floats = |numbers: &[f32]| bin.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]); // 0: positions, and offsets of a morph target
    floats(&[0.75, 0.25, 0.0, 0.0].repeat(3)); // 36: weights
    floats(&[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0].repeat(2)); // 84: bind matrices
    floats(&[0.0, 0.5, 2.0]); // 212: times
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.7, 0.0, 0.7, 0.0, 0.0, 1.0, 0.0]); // 224: rotations
    floats(&[0.1; 27]); // 272: a spline of translations
    bin.extend([0, 1, 0, 0].repeat(3)); // 380: joints
    bin.extend([2, 0, 0, 0]); // 392: a sparse index
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,3,4]}],
"extensionsUsed":["KHR_lights_punctual","KHR_texture_transform"],
"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":3,"spot":{"outerConeAngle":0.5}}]}},
"nodes":[{"mesh":0,"skin":0,"weights":[0.5,0.25]},{"children":[2],"translation":[1,2,3]},{"rotation":[0,0,0,1],"camera":0},
{"extensions":{"KHR_lights_punctual":{"light":0}}},{"mesh":0,"scale":[2,1,1]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.5,1],"rotation":1.5,"scale":[2,3]}}}}}],
"textures":[{}],"skins":[{"joints":[1,2],"inverseBindMatrices":3}],
"meshes":[{"weights":[0.5,1],"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":7,"JOINTS_0":2,"WEIGHTS_0":1},"material":0,
"targets":[{"POSITION":0,"NORMAL":0},{"POSITION":8}]}]}],
"animations":[{"name":"a","channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}},{"sampler":1,"target":{"node":1,"path":"translation"}},
{"sampler":2,"target":{"node":0,"path":"weights"}},{"sampler":1,"target":{"node":3,"path":"scale"}}],
"samplers":[{"input":4,"output":5},{"input":4,"output":6,"interpolation":"CUBICSPLINE"},{"input":4,"output":9,"interpolation":"STEP"}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC4"},
{"bufferView":0,"byteOffset":380,"componentType":5121,"count":3,"type":"VEC4"},{"bufferView":0,"byteOffset":84,"componentType":5126,"count":2,"type":"MAT4"},
{"bufferView":0,"byteOffset":212,"componentType":5126,"count":3,"type":"SCALAR"},{"bufferView":0,"byteOffset":224,"componentType":5126,"count":3,"type":"VEC4"},
{"bufferView":0,"byteOffset":272,"componentType":5126,"count":9,"type":"VEC3"},{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"},
{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"byteOffset":392,"componentType":5123},"values":{"bufferView":0}}},
{"bufferView":0,"byteOffset":272,"componentType":5126,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":396}],"buffers":[{"byteLength":396}]}"#;
    (json.to_owned(), bin)
}

#[test]
fn animated_glb() {
    let (json, bin) = animated();
    let scene = load_bytes("m.glb", &glb(json.as_bytes(), &bin), &Limits::default()).expect("it is sound");
    assert_eq!(scene.pose(0, 0.0).deformed.len(), 2, "{:?}", scene.report);
    assert_eq!(scene.report.warnings, [""; 0]);
    run("m.glb", json.as_bytes(), 6000, |json| glb(&json, &bin));
    run("m.glb", &bin, 4000, |mut bin| {
        bin.resize(396, 0);
        glb(json.as_bytes(), &bin)
    });
    run("m.glb", &glb(json.as_bytes(), &bin), 2000, |bytes| bytes);
}

#[test]
fn obj() {
    let text = "mtllib m.mtl\no a\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvt 0 0\nvt 1 0\nvn 0 0 1\n\
        usemtl red\nf 1/1/1 2/2/1 3/1/1 4/2/1\ng b\nf -4//1 -3//1 -2//1\nf 1 2 3\nl 1 2\np 1\ns off\n";
    run("m.obj", text.as_bytes(), 4000, |bytes| bytes);
}

#[test]
fn mtl() {
    let text = "newmtl red\nKd 0.6 0.1 0.1\nKe 1 1 1\nd 0.5\nmap_Kd -s 1 1 1 t.png\nmap_d t.png\nnewmtl b\nKd 0.5\nKd\nillum 2\n";
    let folder = std::env::temp_dir().join(format!("lumivox-mtl-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (obj, mtl) = (folder.join("m.obj"), folder.join("m.mtl"));
    std::fs::write(&obj, "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl b\nf 3 2 1\n")
        .unwrap();
    let mut random = Random(77);
    for i in 0..2000 {
        std::fs::write(&mtl, damaged(text.as_bytes(), &mut random)).unwrap();
        let scene = lumivox_scene::load(&obj.display().to_string());
        let scene = scene.unwrap_or_else(|e| panic!("{i}: a library must not spoil its model: {e}"));
        assert_eq!(scene.triangle_count(), 2);
        assert!(scene.materials.iter().all(|m| m.base_color.is_finite() && m.emission.is_finite()));
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn ply() {
    let text = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty float y\nproperty double z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
        property list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n\
        0 0 0 255 0 0\n1 0 0 255 0 0\n1 1 0 0 255 0\n0 1 0 0 0 55\n4 0 1 2 3\n3 0 1 2\n1\n";
    run("m.ply", text.as_bytes(), 3000, |bytes| bytes);
    for (format, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uint int vertex_indices\nend_header\n"
        );
        let mut bytes = header.into_bytes();
        let put = |v: [u8; 4]| if big { v.into_iter().rev().collect::<Vec<_>>() } else { v.to_vec() };
        for v in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(put(v.to_le_bytes()));
        }
        for v in [3i32, 0, 1, 2] {
            bytes.extend(put(v.to_le_bytes()));
        }
        run("m.ply", &bytes, 2000, |bytes| bytes);
    }
}

#[test]
fn stl() {
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\nendsolid a\n";
    run("m.stl", text.as_bytes(), 3000, |bytes| bytes);
    let mut bytes = vec![b' '; 80];
    bytes.extend(2u32.to_le_bytes());
    bytes.extend((0..100).map(|i| (i * 7) as u8));
    run("m.stl", &bytes, 1000, |bytes| bytes);
}

#[test]
fn off() {
    let text = "OFF\n# c\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3 255 0 0\n";
    run("m.off", text.as_bytes(), 3000, |bytes| bytes);
}

#[test]
fn scene_file() {
    let text = r#"{"camera": {"eye": [0,1,3.4], "target": [0,1,0], "up": [0,1,0], "fov_y_deg": 39.3},
"lights": [{"type": "point", "position": [0,1.9,0], "intensity": [5,5,5]},
{"type": "directional", "direction": [0.3,-1,0.2], "irradiance": [3,3,3]},
{"type": "spot", "position": [0,2,0], "target": [0,0,0], "intensity": [9,9,9], "cutoff_deg": 30, "beam_deg": 25},
{"type": "rect", "origin": [0,0,0], "u": [1,0,0], "v": [0,0,1], "radiance": [5,5,5]}, {"type": "constant", "radiance": [1,1,1]}],
"meshes": [{"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "albedo": [0.7,0.1,0.1], "scale": 2, "rotate_deg": [0,90,0]},
{"box": {"center": [0,0.3,0], "size": [0.6,0.6,0.6], "rot_y_deg": 15}, "emission": [1,1,1], "scale": [1,2,3]}]}"#;
    run("m.scene.json", text.as_bytes(), 4000, |bytes| bytes);
    let text = r#"{"camera": {"eye": [0,1,3], "target": [0,1,0], "fov_y_deg": 39, "path": {"keyframes": [{"seconds": 0, "eye": [0,1,3]},
{"seconds": 2, "eye": [1,1,3], "target": [0,1,1]}], "repeat": "ping_pong"}},
"lights": [{"type": "point", "position": [0,1.9,0], "intensity": [5,5,5], "motion": {"orbit": {"center": [0,0,0], "seconds_per_turn": 3}}},
{"type": "rect", "origin": [0,0,0], "u": [1,0,0], "v": [0,0,1], "radiance": [5,5,5], "motion": {"interpolation": "smooth",
"keyframes": [{"seconds": 0, "brightness": 1, "rotate_deg": [0,0,0]}, {"seconds": 1, "brightness": 0, "rotate_deg": [0,300,0]}]}}],
"meshes": [{"quad": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "matrix": [[1,0,0,5],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "motion": {"spin": {"axis": [0,1,1], "seconds_per_turn": 2}}},
{"box": {"center": [0,0.3,0], "size": [0.6,0.6,0.6]}, "motion": {"repeat": "once", "keyframes": [{"seconds": 0.5, "translate": [0,0,0], "scale": 1},
{"seconds": 1.5, "rotate_deg": [0,900,0], "scale": [1,2,3]}]}}]}"#;
    run("m.scene.json", text.as_bytes(), 4000, |bytes| bytes);
}
