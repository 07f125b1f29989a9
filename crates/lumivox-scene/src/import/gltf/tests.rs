use glam::{Vec3, Vec4};

use super::*;
use crate::{AlphaMode, Glass, ImportReport, Light, SpotFalloff, Wrap};

/// A `.gltf` whose only buffer is embedded, byte by byte.
pub(super) fn parse(buffer: &[u8], rest: &str) -> Result<Scene, SceneError> {
    let escaped: String = buffer.iter().map(|b| format!("%{b:02x}")).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"data:,{escaped}"}}],{rest}}}"#,
        buffer.len()
    );
    import(&Source::of_memory("a.gltf"), json.as_bytes(), &Limits::default(), Shading::FileOrFlat)
}

pub(super) fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// One triangle at (0 0 0), (1 0 0), (0 1 0).
fn triangle() -> Vec<u8> {
    floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
}

const TRIANGLE: &str = r#""bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"meshes":[{"name":"t","primitives":[{"attributes":{"POSITION":0}}]}]"#;

#[test]
fn transforms_multiply_down_the_tree_and_place_cameras_and_lights() {
    let scene = parse(
        &triangle(),
        &format!(
            r#"{TRIANGLE},"scenes":[{{"nodes":[0]}}],"nodes":[{{"children":[1,2,3],"translation":[0,10,0]}},
            {{"mesh":0,"scale":[2,2,2]}},{{"camera":0,"translation":[0,0,5],"name":"eye"}},
            {{"rotation":[-0.70710678,0,0,0.70710678],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
            "cameras":[{{"type":"perspective","perspective":{{"yfov":0.7,"znear":0.1}}}}],
            "extensionsUsed":["KHR_lights_punctual","KHR_materials_unlit"],"extensions":{{"KHR_lights_punctual":{{"lights":
            [{{"type":"spot","intensity":3,"color":[1,0.5,0],"spot":{{"innerConeAngle":0.2,"outerConeAngle":0.5}}}}]}}}}"#
        ),
    )
    .unwrap();
    assert_eq!(scene.bounds().max, Vec3::new(2.0, 12.0, 0.0));
    let camera = &scene.cameras[0];
    assert_eq!((camera.name.as_str(), camera.eye, camera.fov_y), ("eye", Vec3::new(0.0, 10.0, 5.0), 0.7));
    assert_eq!((camera.target, camera.up), (Vec3::new(0.0, 10.0, 4.0), Vec3::Y));
    let Light::Spot { position, direction, intensity, beam, cutoff, falloff } = scene.lights[0] else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!((position, intensity), (Vec3::new(0.0, 10.0, 0.0), Vec3::new(3.0, 1.5, 0.0)));
    assert!(direction.abs_diff_eq(Vec3::NEG_Y, 1e-6), "{direction}");
    assert_eq!((beam, cutoff, falloff), (0.2, 0.5, SpotFalloff::Gltf));
    assert_eq!(scene.report.ignored_extensions, ["KHR_materials_unlit"]);
    assert_eq!((scene.meshes[0].normals[0], scene.materials.len()), ([0.0, 0.0, 1.0], 1));
}

#[test]
fn numbers_of_all_kinds_are_scaled_and_sparse_ones_replaced() {
    let mut buffer = triangle();
    buffer.extend([255, 0, 51, 255, 255, 255, 0, 0, 0, 255, 0, 0]); // colours at 36, VEC4 of bytes
    buffer.extend([2, 0]); // sparse index at 48
    buffer.extend([0, 0]);
    buffer.extend(floats(&[0.0, 3.0, 0.0])); // its value at 52
    let scene = parse(
        &buffer,
        r#""bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},
        {"buffer":0,"byteOffset":48,"byteLength":2},{"buffer":0,"byteOffset":52,"byteLength":12}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,
        "indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":3}}},
        {"bufferView":1,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"mode":5},{"attributes":{"POSITION":0},"mode":1}]}]"#,
    )
    .unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions[2], [0.0, 3.0, 0.0]);
    assert_eq!(mesh.colors[0], [1.0, 0.0, 0.2, 1.0]);
    assert_eq!(scene.report, ImportReport { skipped_primitives: 1, ..ImportReport::default() });
    assert_eq!(scene.instances.len(), 1, "a file without nodes shows its meshes where they are");
}

#[test]
fn materials_have_colour_emission_alpha_and_what_is_missing_is_counted() {
    let scene = parse(
        &triangle(),
        &format!(
            r#"{TRIANGLE},"materials":[{{"name":"m","alphaMode":"MASK","emissiveFactor":[1,0.5,0],
            "pbrMetallicRoughness":{{"baseColorFactor":[0.1,0.2,0.3,0.4],"baseColorTexture":{{"index":0}}}},
            "extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":4}}}}}},
            {{"emissiveTexture":{{"index":1}}}}],"textures":[{{"source":0}},{{"source":1,"sampler":0}}],
            "samplers":[{{"wrapS":33071,"wrapT":33648}}],"images":[{{"uri":"no.png"}},{{"uri":"data:image/png;base64,{PIXEL}"}}]"#
        ),
    )
    .unwrap();
    let m = &scene.materials[0];
    assert_eq!((m.name.as_str(), m.base_color), ("m", Vec4::new(0.1, 0.2, 0.3, 0.4)));
    assert_eq!((m.emission, m.alpha), (Vec3::new(4.0, 2.0, 0.0), AlphaMode::Mask { cutoff: 0.5 }));
    assert_eq!((m.base_color_texture, scene.materials[1].emission_texture), (None, Some(0)));
    assert_eq!(scene.report.missing_textures, ["no.png"]);
    let t = &scene.textures[0];
    assert_eq!((t.width, t.height, t.wrap, t.srgb), (1, 1, [Wrap::Clamp, Wrap::Mirror], true));
}

#[test]
fn transmission_and_volume_become_glass() {
    let material = |extensions: &str| {
        format!(r#"{{"pbrMetallicRoughness":{{"roughnessFactor":0.5}},"extensions":{{{extensions}}}}}"#)
    };
    let volume = r#""KHR_materials_transmission":{"transmissionFactor":0.9},"KHR_materials_ior":{"ior":1.33},
        "KHR_materials_volume":{"thicknessFactor":0.1,"attenuationDistance":0.25,"attenuationColor":[0.5,1,1]}"#;
    let materials = [
        material(volume),
        material(r#""KHR_materials_transmission":{"transmissionFactor":1}"#),
        material(r#""KHR_materials_transmission":{"transmissionFactor":0.3}"#),
        material(r#""KHR_materials_volume":{"thicknessFactor":0.1}"#),
    ];
    let rest = format!(
        r#"{TRIANGLE},"materials":[{}],"extensionsUsed":["KHR_materials_transmission","KHR_materials_volume","KHR_materials_ior"]"#,
        materials.join(",")
    );
    let scene = parse(&triangle(), &rest).unwrap();
    let glass: Vec<_> = scene.materials.iter().map(|m| m.glass).collect();
    let water = Glass {
        ior: 1.33,
        color: Vec3::new(0.5, 1.0, 1.0),
        distance: 0.25,
        roughness: 0.5,
        is_thin: false,
        ..Glass::default()
    };
    assert_eq!(glass[0], Some(water));
    assert_eq!(glass[1], Some(Glass { roughness: 0.5, is_thin: true, ..Glass::default() }));
    assert_eq!(glass[2..4], [None, None]);
    assert_eq!(scene.report.ignored_extensions, [""; 0]);
    assert_eq!(scene.report.warnings.len(), 1, "{:?}", scene.report.warnings);
}

/// A PNG of one pixel.
const PIXEL: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg==";

#[test]
fn broken_references_and_ranges_are_named() {
    let error = |rest: &str| parse(&triangle(), rest).unwrap_err().to_string();
    let cases = [
        (
            TRIANGLE.replace("\"POSITION\":0", "\"POSITION\":7"),
            "names accessor 7 in meshes[0].primitives[0] but has 1",
        ),
        (
            TRIANGLE.replace("\"count\":3", "\"count\":4"),
            "accessor 0 of 4 elements reaching beyond its buffer view of 36",
        ),
        (TRIANGLE.replace("\"count\":3", "\"count\":1e9"), "is no valid glTF JSON"),
        (
            TRIANGLE.replace("\"count\":3", "\"count\":999999999"),
            "the number of vertices is 999999999, more than",
        ),
        (TRIANGLE.replace(":36", ":37"), "buffer view 0 outside of its buffer"),
        (TRIANGLE.replace("VEC3", "VEC2"), "accessor 0 with 2 numbers per element"),
        (TRIANGLE.replace("5126", "77"), "accessors[0].componentType"),
        (
            format!("{TRIANGLE},\"nodes\":[{{\"children\":[0]}}],\"scenes\":[{{\"nodes\":[0]}}]"),
            "reaches node 0 twice",
        ),
        (format!("{TRIANGLE},\"cameras\":[{{\"type\":\"perspective\"}}]"), "has no projection in cameras[0]"),
        (
            format!("{TRIANGLE},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]"),
            "KHR_draco_mesh_compression is not",
        ),
    ];
    for (rest, why) in cases {
        let text = error(&rest);
        assert!(text.starts_with("a.gltf: ") && text.contains(why), "{text}");
    }
    let nodes: Vec<String> = (1..400).map(|i| format!("{{\"children\":[{i}]}}")).collect();
    let deep = format!("{TRIANGLE},\"nodes\":[{},{{}}],\"scenes\":[{{\"nodes\":[0]}}]", nodes.join(","));
    assert!(error(&deep).contains("the depth of its node tree is 129"), "{}", error(&deep));
}
