//! Direct light of every kind of light, in a box, a room and an atrium, against the path tracer.

use std::fmt::Write as _;
use std::path::Path;

use glam::Vec3;
use libtest_mimic::Failed;
use serde_json::{Value, json};

use crate::compare::comparison;
use crate::support::{Folder, read_json};

/// Trimmed errors up to this are no difference that one sees.
const CLOSE: f64 = 0.01;

/// Lights of all kinds but the sky: in the Cornell box and in the room.
fn lamps(place: &str) -> [(&'static str, Value); 4] {
    let at = |boxed: [f64; 3], room: [f64; 3]| if place == "box" { boxed } else { room };
    let (lamp, corner) = (at([0.1, 1.9, 0.3], [-1.0, 3.0, -0.7]), at([-0.25, 1.9, -0.25], [-2.5, 3.0, -1.0]));
    [
        (
            "sun",
            json!({"type": "directional", "irradiance": [3, 3, 3],
            "direction": at([0.5, -1.0, -0.6], [0.35, -0.5, -0.8])}),
        ),
        ("point", json!({"type": "point", "position": lamp, "intensity": [1, 1, 1]})),
        (
            "spot",
            json!({"type": "spot", "position": lamp, "intensity": [3, 3, 3], "cutoff_deg": 50,
            "target": at([0.0, 0.0, -0.1], [0.4, 0.0, 0.5])}),
        ),
        (
            "rect",
            json!({"type": "rect", "origin": corner, "u": [0.5, 0, 0], "v": [0, 0, 0.5], "radiance": [10, 9, 7]}),
        ),
    ]
}

fn sky() -> Value {
    json!({"type": "constant", "radiance": [1, 1, 1]})
}

/// A box, open in front, with two blocks. The camera stands a little aside: a pixel's centre on an edge shows one side or the
/// other.
fn cornell() -> (Value, Vec<Value>) {
    let quad = |corners: [[i32; 3]; 4], albedo: [f64; 3]| json!({"quad": corners, "albedo": albedo});
    let gray = [0.7, 0.7, 0.7];
    let block = |center: [f64; 3], height: f64, turn: i32| json!({"box": {"center": center, "size": [0.6, height, 0.6], "rot_y_deg": turn}, "albedo": gray});
    let meshes = vec![
        quad([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], gray),
        quad([[-1, 0, -1], [1, 0, -1], [1, 2, -1], [-1, 2, -1]], gray),
        quad([[-1, 0, 1], [-1, 0, -1], [-1, 2, -1], [-1, 2, 1]], [0.6, 0.07, 0.05]),
        quad([[1, 0, -1], [1, 0, 1], [1, 2, 1], [1, 2, -1]], [0.1, 0.45, 0.1]),
        block([-0.35, 0.6, -0.35], 1.2, 17),
        block([0.35, 0.3, 0.3], 0.6, -17),
    ];
    (json!({"eye": [0.03, 1.02, 3.4], "target": [0.01, 0.98, 0], "fov_y_deg": 39.3}), meshes)
}

/// The built-in room without its light, one file for each of its materials.
fn room(folder: &Folder) -> Result<(Value, Vec<Value>), Failed> {
    let scene = lumivox_scene::load("builtin:room:1").map_err(|e| e.to_string())?;
    let mut files = vec![(String::new(), 0); scene.materials.len()];
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let (text, first) = &mut files[mesh.material];
        for p in &mesh.positions {
            let p = instance.world_from_local.transform_point3(Vec3::from(*p));
            writeln!(text, "v {} {} {}", p.x, p.y, p.z)?;
        }
        for corners in &mesh.indices {
            let [a, b, c] = corners.map(|n| n as usize + *first + 1);
            writeln!(text, "f {a} {b} {c}")?;
        }
        *first += mesh.positions.len();
    }
    let mut meshes = Vec::new();
    for (n, (text, _)) in files.iter().enumerate().filter(|(_, (text, _))| !text.is_empty()) {
        let color = scene.materials[n].base_color;
        folder.write(&format!("part_{n}.obj"), text);
        meshes.push(json!({"file": format!("part_{n}.obj"), "albedo": [color.x, color.y, color.z]}));
    }
    let camera = scene.cameras.first().ok_or("the room has no camera")?;
    let (eye, target) = (camera.eye.to_array(), camera.target.to_array());
    Ok((json!({"eye": eye, "target": target, "fov_y_deg": camera.fov_y.to_degrees()}), meshes))
}

/// Writes a scene and holds its direct light, as radiance and as irradiance, to `most`.
fn check(
    folder: &Folder,
    name: &str,
    light: &Value,
    (camera, meshes): &(Value, Vec<Value>),
    (options, most): (&str, f64),
) -> Result<(), Failed> {
    let scene = json!({"camera": camera, "lights": [light], "meshes": meshes});
    folder.write(&format!("{name}.scene.json"), scene.to_string());
    is_close(folder, &format!("{name}.scene.json"), name, options, most)
}

/// Renders and traces a scene and holds its direct light to `most`.
fn is_close(folder: &Folder, scene: &str, name: &str, options: &str, most: f64) -> Result<(), Failed> {
    folder.line(&format!("compare {scene} --gi off --out {name} {options}")).succeeded();
    let report = read_json(&folder.join(&format!("{name}/compare.json")))?;
    for quantity in ["radiance", "irradiance"] {
        let direct = comparison(&report, "direct", quantity);
        let number = |key: &str| direct[key].as_f64().ok_or(format!("{name}: no {key} in {direct}"));
        let (trimmed, noise, ratio) = (number("trimmed")?, number("noise")?, number("mean_ratio")?);
        eprintln!("{name} {quantity}: {:.2} %, noise {:.2} %", 1e2 * trimmed, 1e2 * noise);
        assert!(noise < 0.5 * most, "{name} {quantity}: too much noise to tell, {direct}");
        // Noise and error are independent, so their squares add.
        assert!(trimmed < most.hypot(noise) && (ratio - 1.0).abs() < most, "{name} {quantity}: {direct}");
    }
    Ok(())
}

pub(crate) fn lamps_in_a_box() -> Result<(), Failed> {
    let folder = Folder::new();
    for (name, light) in lamps("box") {
        check(&folder, name, &light, &cornell(), ("--size 64x36 --max-samples 65536", CLOSE))?;
    }
    Ok(())
}

pub(crate) fn lamps_in_the_room() -> Result<(), Failed> {
    let folder = Folder::new();
    let room = room(&folder)?;
    for (name, light) in lamps("room") {
        check(&folder, name, &light, &room, ("--size 64x36 --max-samples 65536", CLOSE))?;
    }
    Ok(())
}

/// The sky takes time: quickly it comes within 2 %.
pub(crate) fn sky_in_a_box() -> Result<(), Failed> {
    let options = "--size 32x18 --max-samples 65536 --light-samples 1024 --shadow-size 1024";
    check(&Folder::new(), "sky", &sky(), &cornell(), (options, 2.0 * CLOSE))
}

/// The patient version, in the box and in the room, there with its sun and without: minutes for each.
pub(crate) fn sky_with_patience() -> Result<(), Failed> {
    let folder = Folder::new();
    let options = "--size 32x18 --max-samples 262144 --light-samples 4096";
    check(&folder, "box", &sky(), &cornell(), (options, CLOSE))?;
    let options = "--size 32x18 --max-samples 1000000 --light-samples 4096";
    is_close(&folder, "builtin:room", "room", options, CLOSE)?;
    let options = "--size 32x18 --max-samples 1000000 --light-samples 32768";
    check(&folder, "room_sky", &sky(), &room(&folder)?, (options, CLOSE))
}

/// The atrium that everybody knows, under each lamp.
pub(crate) fn lamps_in_sponza(assets: &Path) -> Result<(), Failed> {
    let folder = Folder::new();
    let sponza = sponza(&folder, assets)?;
    let lamps = [
        json!({"type": "directional", "direction": [0.18, -1.0, 0.28], "irradiance": [9.0, 8.4, 7.4]}),
        json!({"type": "point", "position": [-3, 3.5, 0.3], "intensity": [40, 36, 30]}),
        json!({"type": "spot", "position": [-8, 6, 0], "target": [1, 0, -1], "intensity": [200, 190, 170],
            "cutoff_deg": 50}),
    ];
    for (name, light) in ["sun", "point", "spot"].into_iter().zip(lamps) {
        check(&folder, name, &light, &sponza, ("--size 160x90", CLOSE))?;
    }
    Ok(())
}

/// A copy of the model beside the scene files, which name nothing else.
fn sponza(folder: &Folder, assets: &Path) -> Result<(Value, Vec<Value>), Failed> {
    std::fs::copy(assets.join("scenes/sponza_dabrovic/sponza.glb"), folder.join("sponza.glb"))?;
    let camera = json!({"eye": [-11.0, 1.8, 0.6], "target": [6.0, 4.2, -1.2], "fov_y_deg": 60});
    Ok((camera, vec![json!({"file": "sponza.glb"})]))
}

/// Area lights there, a rect light and the sky, of which hardly any is seen: up to half an hour on two cores without a graphics
/// card.
pub(crate) fn area_lights_in_sponza(assets: &Path) -> Result<(), Failed> {
    let folder = Folder::new();
    let rect = json!({"type": "rect", "origin": [-5, 7, -1], "u": [3, 0, 0], "v": [0, 0, 2], "radiance": [20, 19, 17]});
    let sponza = sponza(&folder, assets)?;
    let options = "--size 48x27 --max-samples 1000000";
    check(&folder, "rect", &rect, &sponza, (options, CLOSE))?;
    let options = "--size 48x27 --max-samples 1000000 --light-samples 16384 --shadow-size 8192";
    check(&folder, "sky", &sky(), &sponza, (options, CLOSE))
}
