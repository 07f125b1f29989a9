//! Small animated assets whose poses can be worked out by hand.

use glam::{Mat4, Quat, Vec3};

use super::tests::{floats, parse};
use crate::{Light, Scene};

fn near(a: [f32; 3], b: [f32; 3]) -> bool {
    Vec3::from(a).abs_diff_eq(b.into(), 1e-5)
}

/// One buffer made of pieces, with a view and an accessor for each.
#[derive(Default)]
struct Pieces {
    buffer: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Pieces {
    fn add(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let (at, length) = (self.buffer.len(), bytes.len());
        self.buffer.extend(bytes);
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{at},"byteLength":{length}}}"#));
        let view = self.views.len() - 1;
        let json =
            format!(r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"}}"#);
        self.accessors.push(json);
        self.accessors.len() - 1
    }

    fn floats(&mut self, numbers: &[f32], kind: &str, width: usize) -> usize {
        self.add(&floats(numbers), 5126, kind, numbers.len() / width)
    }

    fn parse(&self, rest: &str) -> Scene {
        let (views, accessors) = (self.views.join(","), self.accessors.join(","));
        parse(&self.buffer, &format!(r#""bufferViews":[{views}],"accessors":[{accessors}],{rest}"#)).unwrap()
    }
}

/// Positions of a bar of two triangles: its root at (0 0 0), its tip around (2 0 0).
const BAR: [f32; 18] =
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 2.0, 0.0, 1.0];

/// A bar whose right half follows a joint at (1 0 0) that turns by 90 degrees about Z within a second. Accessors:
/// 0 positions, 1 joints, 2 weights, 3 bind matrices, 4 times, 5 rotations.
fn bent(rest: impl FnOnce(&mut Pieces) -> String) -> Scene {
    let mut p = Pieces::default();
    p.floats(&BAR, "VEC3", 3);
    p.add(&[[0, 0, 0, 0], [1, 0, 0, 0]].map(|j: [u8; 4]| [j; 3]).as_flattened().concat(), 5121, "VEC4", 6);
    p.floats(&[1.0, 0.0, 0.0, 0.0].repeat(6), "VEC4", 4);
    let bind = [Mat4::IDENTITY, Mat4::from_translation(Vec3::NEG_X)];
    p.floats(&bind.map(|m| m.to_cols_array()).concat(), "MAT4", 16);
    p.floats(&[0.0, 1.0], "SCALAR", 1);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    p.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half], "VEC4", 4);
    let rest = rest(&mut p);
    p.parse(&rest)
}

const BENT: &str = r#""meshes":[{"name":"bar","primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}],
"skins":[{"joints":[1,2],"inverseBindMatrices":3}],"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"skin":0,"translation":[50,0,0]},{"children":[2]},{"translation":[1,0,0]}],
"animations":[{"name":"bend","channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}}],
"samplers":[{"input":4,"output":5}]}]"#;

#[test]
fn a_joint_turned_by_90_degrees_takes_its_vertices_along() {
    let mut scene = bent(|_| BENT.to_owned());
    assert_eq!(
        (scene.clips().len(), scene.clips()[0].name.as_str(), scene.clips()[0].duration),
        (1, "bend", 1.0)
    );
    // The node's own 50 metres count for nothing.
    assert_eq!(scene.instances[0].world_from_local, Mat4::IDENTITY);
    assert_eq!(scene.meshes[0].positions[3], [2.0, 0.0, 0.0]);
    let rest = scene.meshes[0].clone();
    // Of a clip of one second, just before it begins anew.
    let pose = scene.pose(0, 0.999_999_9);
    let moved = &pose.deformed[0];
    assert_eq!((moved.mesh, pose.deformed.len(), moved.positions.len()), (0, 1, 6));
    assert!(near(moved.positions[1], [1.0, 0.0, 0.0]), "{moved:?}");
    for (p, expected) in moved.positions[3..].iter().zip([[1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [1.0, 1.0, 1.0]])
    {
        assert!(near(*p, expected), "{p:?} {expected:?}");
    }
    // The file has no normals, so they are the faces' at every moment: (1 0 0) x (0 0 1), then (0 1 0) x (0 0 1).
    assert!(near(moved.normals[0], [0.0, -1.0, 0.0]) && near(moved.normals[3], [1.0, 0.0, 0.0]), "{moved:?}");
    let half = scene.pose(0, 0.5).deformed[0].positions[3];
    let eighth = std::f32::consts::FRAC_PI_4;
    assert!(near(half, [1.0 + eighth.cos(), eighth.sin(), 0.0]), "{half:?}");
    assert!(scene.bounds_in_motion(0).max.y > 1.99);
    scene.apply(&pose);
    assert_ne!(scene.meshes[0], rest);
    scene.apply(&scene.pose(9, 0.0));
    assert_eq!(scene.meshes[0], rest);
}

#[test]
fn normals_of_the_file_turn_with_the_joints() {
    let scene = bent(|p| {
        let normals = p.floats(&[0.6, 0.8, 0.0].repeat(6), "VEC3", 3);
        BENT.replace("\"POSITION\":0,", &format!("\"POSITION\":0,\"NORMAL\":{normals},"))
    });
    let normals = &scene.pose(0, 0.999_999_9).deformed[0].normals;
    assert!(near(normals[0], [0.6, 0.8, 0.0]) && near(normals[5], [-0.8, 0.6, 0.0]), "{normals:?}");
}

#[test]
fn a_mesh_with_two_skins_and_without_one_stands_in_three_shapes() {
    let scene = bent(|_| {
        BENT.replace("\"skins\":[", "\"skins\":[{\"joints\":[2,1],\"inverseBindMatrices\":3},")
            .replace("\"nodes\":[0,1]", "\"nodes\":[0,1,3,4,5]")
            .replace("\"translation\":[1,0,0]}", "\"translation\":[1,0,0]},{\"mesh\":0,\"skin\":1},{\"mesh\":0,\"translation\":[0,7,0]},{\"mesh\":0,\"skin\":1}")
    });
    assert_eq!((scene.meshes.len(), scene.instances.len()), (3, 4));
    assert_eq!(scene.animation.bodies.len(), 2, "nodes with one skin share one shape");
    let plain = scene.instances.iter().find(|i| i.world_from_local != Mat4::IDENTITY).unwrap();
    assert_eq!(scene.meshes[plain.mesh].positions[3], [2.0, 0.0, 0.0]);
    assert!(scene.animation.bodies.iter().all(|b| b.mesh != plain.mesh));
    assert_eq!(scene.triangle_count(), 8);
}

#[test]
fn what_is_wrong_with_a_skin_leaves_the_mesh_at_its_node() {
    let cases = [
        (BENT.replace("[1,2]", "[1]"), "the skin of mesh 'bar' is left out: it uses joint 1 of 1"),
        (BENT.replace("[1,2]", "[1,2,0]"), "it has fewer bind matrices than joints"),
        (
            BENT.replace("\"nodes\":[0,1]}", "\"nodes\":[0]}"),
            "skin 0 is left out: one of its joints is not in the scene",
        ),
        (BENT.replace("[1,2]", "[]"), "it has no joints"),
    ];
    for (text, why) in cases {
        let scene = bent(|_| text);
        assert!(scene.report.warnings.iter().any(|w| w.contains(why)), "{why} {:?}", scene.report.warnings);
        assert_eq!(scene.bounds().min.x, 50.0);
    }
    let scene = bent(|p| {
        let matrices = p.floats(&[f32::NAN; 32], "MAT4", 16);
        BENT.replace("\"inverseBindMatrices\":3", &format!("\"inverseBindMatrices\":{matrices}"))
    });
    assert_eq!(scene.report.warnings, ["skin 0 is left out: a bind matrix is not finite"]);
}

#[test]
fn what_is_wrong_with_a_channel_is_named_and_leaves_it_out() {
    let case = |times: [f32; 2], from: &str, to: &str, why: &str| {
        let scene = bent(|p| {
            let times = p.floats(&times, "SCALAR", 1);
            BENT.replace("\"input\":4", &format!("\"input\":{times}")).replace(from, to)
        });
        assert!(scene.report.warnings.iter().any(|w| w.contains(why)), "{why} {:?}", scene.report.warnings);
        assert!(scene.clips().is_empty());
        assert_eq!(scene.pose(0, 0.5).deformed, []);
    };
    case([0.0, f32::NAN], "", "", "animation 'bend': channel 0 is left out: it has a key at NaN seconds");
    case([1.0, 0.5], "", "", "it has a key at 0.5 seconds after one at 1");
    case([-1.0, 0.5], "", "", "it has a key at -1 seconds");
    case([0.0, 1.0], "\"input\":", "\"interpolation\":\"CUBICSPLINE\",\"input\":", "8 numbers for 2 keys");
    case([0.0, 1.0], "\"path\":\"rotation\"", "\"path\":\"pointer\"", "what it moves is unknown");
    case([0.0, 1.0], "\"node\":2,", "\"node\":9,", "it moves node 9, which is not in the scene");
    case([0.0, 1.0], "\"node\":2,", "", "channels of animations that move no node are left out");
    let matrix = r#"{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}"#;
    case([0.0, 1.0], r#"{"translation":[1,0,0]}"#, matrix, "it moves node 2, which is placed by a matrix");
    let weights = BENT.replace("rotation", "weights").replace("\"output\":5", "\"output\":4");
    let report = bent(|_| weights).report;
    assert!(
        report.warnings[0].contains("it has 1 factors, but node 2 has other morph targets"),
        "{report:?}"
    );
}

#[test]
fn a_morph_weight_half_way_moves_half_the_way() {
    let mut p = Pieces::default();
    p.floats(&BAR[..9], "VEC3", 3);
    p.floats(&[0.0, 0.0, 1.0].repeat(3), "VEC3", 3);
    // A dense target, and a sparse one that moves the last vertex alone.
    p.floats(&[0.0, 4.0, 0.0].repeat(3), "VEC3", 3);
    p.floats(&[0.0, 2.0, -1.0].repeat(3), "VEC3", 3);
    p.floats(&[0.0, 1.0], "SCALAR", 1);
    p.floats(&[0.0, 0.25, 1.0, 0.25], "SCALAR", 1);
    p.add(&[2, 0], 5123, "SCALAR", 1);
    p.floats(&[8.0, 0.0, 0.0], "VEC3", 3);
    p.accessors.push(
        r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":6,"componentType":5123},"values":{"bufferView":7}}}"#
            .to_owned(),
    );
    let scene = p.parse(
        r#""meshes":[{"weights":[0,0.25],"primitives":[{"attributes":{"POSITION":0,"NORMAL":1},
        "targets":[{"POSITION":2,"NORMAL":3},{"POSITION":8}]}]}],"nodes":[{"mesh":0,"scale":[3,3,3]},{"mesh":0,"weights":[1]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":4,"output":5}]}]"#,
    );
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 2));
    // Meshes are loaded with the weights that they state: the first node's of its mesh, the second one's its own.
    let [a, b] = [0, 1].map(|m| {
        let node = scene.animation.bodies.iter().find(|body| body.mesh == m).unwrap().weights.len();
        (node, scene.meshes[m].positions[2])
    });
    let (own, meshes) = if a.0 == 1 { (a.1, b.1) } else { (b.1, a.1) };
    assert_eq!((own, meshes), ([0.0, 4.0, 1.0], [2.0, 0.0, 1.0]));
    let pose = scene.pose(0, 0.5);
    let half = pose.deformed.iter().find(|d| d.positions[0] == [0.0, 2.0, 0.0]).unwrap();
    assert_eq!(half.positions, [[0.0, 2.0, 0.0], [1.0, 2.0, 0.0], [2.0, 2.0, 1.0]]);
    // (0 0 1) + half of (0 2 -1) is (0 1 0.5), made unit.
    assert!(near(half.normals[0], [0.0, 0.8f32.sqrt(), 0.2f32.sqrt()]), "{:?}", half.normals);
    // Morphed meshes stay on their nodes.
    assert!(scene.instances.iter().any(|i| i.world_from_local == Mat4::from_scale(Vec3::splat(3.0))));
}

#[test]
fn lights_and_cameras_follow_their_nodes_and_steps_and_splines_are_kept() {
    let mut p = Pieces::default();
    p.floats(&BAR[..9], "VEC3", 3);
    p.floats(&[0.0, 2.0], "SCALAR", 1);
    p.floats(&[0.0, 0.0, 0.0, 0.0, 6.0, 0.0], "VEC3", 3);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    p.floats(&[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half], "VEC4", 4);
    // In-tangent, value, out-tangent per key.
    let (zero, one) = ([0.0; 3], [1.0, 0.0, 0.0]);
    p.floats(&[zero, zero, one, [-1.0, 0.0, 0.0], [4.0, 0.0, 0.0], zero].concat(), "VEC3", 3);
    let scene = p.parse(
        r#""nodes":[{"children":[1,2]},{"camera":0},{"extensions":{"KHR_lights_punctual":{"light":0}}},{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"extensionsUsed":["KHR_lights_punctual"],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{}}]}},
        "cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
        {"sampler":1,"target":{"node":0,"path":"rotation"}},{"sampler":2,"target":{"node":3,"path":"translation"}}],
        "samplers":[{"input":1,"output":2,"interpolation":"STEP"},{"input":1,"output":3},
        {"input":1,"output":4,"interpolation":"CUBICSPLINE"}]}]"#,
    );
    let pose = scene.pose(0, 1.0);
    let looking = Quat::from_rotation_y(std::f32::consts::FRAC_PI_4) * Vec3::NEG_Z;
    let Light::Spot { position, direction, .. } = pose.lights[0] else { panic!("{:?}", pose.lights) };
    assert_eq!(position, Vec3::ZERO, "a step waits for its key");
    assert!(direction.abs_diff_eq(looking, 1e-6), "{direction}");
    let camera = &pose.cameras[0];
    assert!((camera.target - camera.eye).abs_diff_eq(looking, 1e-6), "{camera:?}");
    // 0.125 * 2 * 1 + 0.5 * 4 - 0.125 * 2 * -1 = 2.5
    assert_eq!(pose.world_from_local[0].w_axis.x, 2.5);
    assert_eq!(scene.pose(7, 1.0).world_from_local[0], Mat4::IDENTITY);
}

#[test]
fn texture_transforms_are_baked_into_the_coordinates() {
    let mut p = Pieces::default();
    p.floats(&BAR[..9], "VEC3", 3);
    p.floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], "VEC2", 2);
    p.floats(&[0.5, 0.5].repeat(3), "VEC2", 2);
    let make = |color: &str, emission: &str| {
        let transform =
            |t: &str| format!(r#"{{"index":0,"extensions":{{"KHR_texture_transform":{{{t}}}}}}}"#);
        p.parse(&format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2}},"material":0}}]}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{}}},"emissiveTexture":{}}}],"textures":[{{}}],
            "extensionsUsed":["KHR_texture_transform"]"#,
            transform(color),
            transform(emission)
        ))
    };
    let quarter = r#""offset":[0.25,0.5],"rotation":1.5707963267948966,"scale":[2,4]"#;
    let scene = make(quarter, quarter);
    // Scaled to (2 0) and (0 4), turned counterclockwise as seen with v downwards to (0 -2) and (4 0), moved.
    let expected = [[0.25, 0.5], [0.25, -1.5], [4.25, 0.5]];
    for (uv, expected) in scene.meshes[0].uvs.iter().zip(expected) {
        assert!(uv.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{uv:?} {expected:?}");
    }
    assert_eq!(scene.report.ignored_extensions, [""; 0]);
    assert_eq!(scene.report.warnings, [""; 0]);
    assert_eq!(scene.report.missing_textures, ["texture 0"], "a texture without an image");
    let other = make(r#""offset":[0.25,0]"#, r#""offset":[0.5,0]"#);
    assert_eq!(other.meshes[0].uvs[0], [0.25, 0.0]);
    assert!(other.report.warnings[0].contains("those of the colour are kept"), "{:?}", other.report);
    let set = make(r#""texCoord":1"#, r#""texCoord":1"#);
    assert_eq!(set.meshes[0].uvs[1], [0.5, 0.5]);
    let huge = make(r#""scale":[1e38,1e38],"rotation":1"#, r#""scale":[1e38,1e38],"rotation":1"#);
    assert!(huge.meshes[0].uvs.iter().flatten().all(|v| v.is_finite()));
}

#[test]
fn extensions_that_are_not_read_are_named_whether_required_or_not() {
    let mut p = Pieces::default();
    p.floats(&BAR[..9], "VEC3", 3);
    let scene = p.parse(
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "extensionsUsed":["EXT_one","EXT_two","KHR_mesh_quantization"],"extensionsRequired":["EXT_two"]"#,
    );
    assert_eq!(scene.report.ignored_extensions, ["EXT_one", "EXT_two"]);
    assert!(scene.report.warnings[0].contains("EXT_one is not supported; the file calls it optional"));
    assert!(scene.report.warnings[1].contains("EXT_two is not supported; the file calls it required"));
}
