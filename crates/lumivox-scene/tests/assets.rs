//! Real and deliberately broken models from the folder that `LUMIVOX_ASSETS` names.
//!
//! Without the variable every test is reported as ignored, with that reason in its name; with
//! `LUMIVOX_REQUIRE_ASSETS=1` its absence fails instead.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use glam::Vec3;
use libtest_mimic::{Arguments, Failed, Trial};
use lumivox_scene::{EXTENSIONS, SCHEMA, Scene, load};

#[path = "common/child.rs"]
mod child;
#[path = "common/schema.rs"]
mod schema;

use child::{CHILD, in_a_child, load_as_child};

/// Files and their triangles over all instances, as another program counts them.
const COUNTS: &[(&str, u64)] = &[
    ("scenes/sponza_dabrovic/sponza.glb", 66_445),
    ("scenes/sibenik/sibenik.glb", 71_326),
    ("scenes/country_kitchen/kitchen.glb", 1_021_813),
    ("scenes/staircase2/staircase2.glb", 31_087),
    ("scenes/zdm2/zdm2.glb", 58_772),
    ("scenes/godot_room/room.glb", 63_720),
    ("scenes/godot_living_room/living_room.glb", 5_088),
    ("scenes/samurai_monastery/samurai_monastery.glb", 124_789),
    ("scenes/cornell_box/CornellBox.glb", 36),
    ("meshes/oak_tree.glb", 160_146),
    ("scenes/sibenik/sibenik_untextured.ply", 75_284),
    ("scenes/conference/conference.ply", 331_179),
    ("scenes/cornell_box/cornell_box.obj", 32),
    ("meshes/bunny.ply", 69_451),
    ("meshes/dragon.ply", 871_414),
    ("meshes/dragon_res4.ply", 11_102),
    ("meshes/nefertiti.ply", 99_938),
    ("meshes/teapot.ply", 6_320),
    ("nasty/soup.stl", 100),
    ("nasty/busted.STL", 3_878),
    ("nasty/7_8ths_cube.stl", 24),
    ("nasty/wallhole.obj", 66),
    ("nasty/negative_indices.obj", 12),
    ("nasty/elephant-with-holes.off", 4_463),
    ("nasty/open_cube.off", 10),
    ("nasty/mode5.gltf", 2_786),
    ("nasty/no_indices_3storybuilding.glb", 72),
    ("animated/Fox.glb", 576),
    ("animated/CesiumMan.glb", 4_672),
    ("animated/RiggedFigure.glb", 256),
];

/// What is known of an animated file.
struct Animated {
    file: &'static str,
    /// Name and seconds of each clip.
    clips: &'static [(&'static str, f32)],
    /// Corners of the box at rest.
    rest: [[f32; 3]; 2],
}

const ANIMATED: &[Animated] = &[
    Animated {
        file: "animated/Fox.glb",
        clips: &[("Survey", 3.416_667), ("Walk", 0.708_333), ("Run", 1.158_333)],
        rest: [[-12.59, -0.1217, -88.1], [12.59, 78.91, 66.62]],
    },
    Animated {
        file: "animated/CesiumMan.glb",
        clips: &[("", 2.0)],
        rest: [[-0.5691, 0.0, -0.131], [0.5691, 1.507, 0.181]],
    },
    Animated {
        file: "animated/RiggedFigure.glb",
        clips: &[("", 1.25)],
        rest: [[-0.5895, 0.0, -0.1309], [0.5895, 1.45, 0.195]],
    },
];

/// A test of the folder's content.
type Test = Box<dyn FnOnce(&Path) -> Result<(), Failed> + Send>;

fn main() -> ExitCode {
    if let Ok(path) = std::env::var(CHILD) {
        return load_as_child(&path);
    }
    let args = Arguments::from_args();
    let required = std::env::var("LUMIVOX_REQUIRE_ASSETS").is_ok_and(|v| v == "1");
    let folder = std::env::var_os("LUMIVOX_ASSETS").map(PathBuf::from).filter(|p| p.is_dir());
    let mut trials = Vec::new();
    let mut add = |name: String, test: Test| {
        trials.push(match folder.clone() {
            Some(folder) => Trial::test(name, move || test(&folder)),
            None if required => Trial::test(name, || Err("LUMIVOX_ASSETS names no folder".into())),
            None => Trial::test(format!("{name} (needs LUMIVOX_ASSETS)"), || Ok(())).with_ignored_flag(true),
        });
    };
    for &(file, triangles) in COUNTS {
        add(format!("counts of {file}"), Box::new(move |folder| counts(&folder.join(file), triangles)));
    }
    for known in ANIMATED {
        add(
            format!("motion of {}", known.file),
            Box::new(move |folder| motion(known, &folder.join(known.file))),
        );
    }
    add("a fox in a scene file".to_owned(), Box::new(fox_in_a_scene_file));
    add(
        "reference scene files fit the schema".to_owned(),
        Box::new(|folder| references(&folder.join("../references"))),
    );
    add("every nasty file ends well".to_owned(), Box::new(|folder| nasty(&folder.join("nasty"))));
    libtest_mimic::run(&args, trials).exit_code()
}

fn counts(path: &Path, triangles: u64) -> Result<(), Failed> {
    let scene = load(&path.display().to_string()).map_err(|e| e.to_string())?;
    check_sound(&scene)?;
    let report = &scene.report;
    if report.dropped_vertices != 0 || !report.missing_textures.is_empty() {
        return Err(format!("{report:?}").into());
    }
    match scene.triangle_count() {
        n if n == triangles => Ok(()),
        n => Err(format!("{n} triangles instead of {triangles}; {report:?}").into()),
    }
}

/// What every scene that comes back promises, however broken its file was.
fn check_sound(scene: &Scene) -> Result<(), Failed> {
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        let same = [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()] == [count; 3];
        let finite = mesh.positions.iter().flatten().all(|v| v.is_finite());
        let unit = mesh.normals.iter().all(|n| (n.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-3);
        let in_range = mesh.indices.iter().flatten().all(|&i| (i as usize) < count);
        if !(same && finite && unit && in_range && mesh.material < scene.materials.len()) {
            let name = &mesh.name;
            return Err(format!("mesh '{name}': {same} {finite} {unit} {in_range}").into());
        }
    }
    let textures = scene.materials.iter().flat_map(|m| [m.base_color_texture, m.emission_texture]);
    if textures.flatten().any(|t| t >= scene.textures.len()) {
        return Err("a material shows a texture that is not there".into());
    }
    if scene.instances.iter().any(|i| i.mesh >= scene.meshes.len() || !i.world_from_local.is_finite()) {
        return Err("an instance is out of range or not finite".into());
    }
    Ok(())
}

fn expect(holds: bool, what: impl FnOnce() -> String) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(what().into()) }
}

/// Clips, the box at rest, and what holds at every moment: finite, unit normals, within the box in motion, no jumps.
fn motion(known: &Animated, path: &Path) -> Result<(), Failed> {
    let rest = load(&path.display().to_string()).map_err(|e| e.to_string())?;
    let clips: Vec<(&str, f32)> = rest.clips().iter().map(|c| (c.name.as_str(), c.duration)).collect();
    let same = |(a, b): (&(&str, f32), &(&str, f32))| a.0 == b.0 && (a.1 - b.1).abs() < 1e-5;
    expect(clips.len() == known.clips.len() && clips.iter().zip(known.clips).all(same), || {
        format!("{clips:?}")
    })?;
    expect(rest.report.warnings.is_empty(), || format!("{:?}", rest.report))?;
    let bounds = rest.bounds();
    let size = bounds.size().max_element();
    let [low, high] = known.rest.map(Vec3::from);
    expect(bounds.min.abs_diff_eq(low, 1e-3 * size) && bounds.max.abs_diff_eq(high, 1e-3 * size), || {
        format!("{bounds:?} at rest")
    })?;
    for (c, clip) in rest.clips().iter().enumerate() {
        let whole = rest.bounds_in_motion(c);
        expect(whole.contains(bounds.min) && whole.contains(bounds.max), || format!("{whole:?}"))?;
        expect(rest.pose(c, 0.0) == rest.pose(c, clip.duration), || "the ends do not meet".to_owned())?;
        let mut scene = rest.clone();
        const STEPS: u32 = 64;
        for i in 0..STEPS {
            let t = clip.duration * i as f32 / STEPS as f32;
            let pose = rest.pose(c, t);
            expect(pose == rest.pose(c, t), || format!("{t}: two poses of one moment differ"))?;
            scene.apply(&pose);
            check_sound(&scene)?;
            let now = scene.bounds();
            let slack = 0.01 * size;
            expect(whole.min.cmple(now.min + slack).all() && whole.max.cmpge(now.max - slack).all(), || {
                format!("{t}: {now:?} is outside of {whole:?}")
            })?;
            if clip.name == "Walk" {
                // Walking on the spot, on y = 0: some paw is always down, and none reaches far below.
                expect(now.min.y.abs() < 0.03 * size, || format!("{t}: lowest point at {}", now.min.y))?;
            }
            let soon = rest.pose(c, t + 1e-3);
            let furthest = pose.deformed.iter().zip(&soon.deformed).flat_map(|(a, b)| {
                a.positions.iter().zip(&b.positions).map(|(a, b)| Vec3::from(*a).distance((*b).into()))
            });
            let furthest = furthest.fold(0.0, f32::max);
            // Ten times the size of the whole within a second is more than any limb does.
            expect(furthest < 0.01 * size, || format!("{t}: a vertex jumps by {furthest}"))?;
        }
    }
    Ok(())
}

/// A clip of a file that a scene file names and places: the same shapes, elsewhere.
fn fox_in_a_scene_file(folder: &Path) -> Result<(), Failed> {
    let here = std::env::temp_dir().join(format!("lumivox-fox-{}", std::process::id()));
    std::fs::create_dir_all(&here)?;
    std::fs::copy(folder.join("animated/Fox.glb"), here.join("Fox.glb"))?;
    let fox = |scale: &str, clip: &str| {
        format!(
            r#"{{"file": "Fox.glb", "scale": {scale}, "translate": [1, 0, 0], "motion": {{"clip": {clip}}}}}"#
        )
    };
    let write = |entries: [String; 3]| {
        let text = format!(r#"{{"meshes": [{}]}}"#, entries.join(","));
        let path = here.join("fox.scene.json");
        std::fs::write(&path, text).map(|()| path.display().to_string())
    };
    let scene = load(&write([fox("0.01", "\"Walk\""), fox("0.02", "2"), fox("0.03", "\"Walk\"")])?);
    let wrong = load(&write([fox("1", "\"Swim\""), fox("1", "0"), fox("1", "0")])?);
    let alone = load(&here.join("Fox.glb").display().to_string());
    std::fs::remove_dir_all(&here)?;
    let (mut scene, alone) = (scene.map_err(|e| e.to_string())?, alone.map_err(|e| e.to_string())?);
    expect((scene.meshes.len(), scene.instances.len()) == (2, 3), || {
        "two foxes share their walk".to_owned()
    })?;
    for t in [0.0, 0.3, 0.6, 5.1] {
        let pose = scene.pose(0, t);
        let (walk, run) = (alone.pose(1, t), alone.pose(2, t));
        for (i, expected) in [(0, &walk), (1, &run), (2, &walk)] {
            let mesh = scene.instances[i].mesh;
            let found = pose.deformed.iter().find(|d| d.mesh == mesh).ok_or("no such mesh")?;
            let apart = found.positions.iter().zip(&expected.deformed[0].positions);
            let apart = apart.map(|(a, b)| Vec3::from(*a).distance((*b).into())).fold(0.0, f32::max);
            // Times within a clip come from different sums.
            expect(apart < 1e-2, || format!("{t}: fox {i} is off by {apart} of 150 units"))?;
        }
        scene.apply(&pose);
        check_sound(&scene)?;
        let feet = scene.bounds().min.y;
        expect(feet.abs() < 0.1, || format!("{t}: feet at {feet}"))?;
    }
    let text = wrong.err().map(|e| e.to_string()).unwrap_or_default();
    expect(text.contains("no such clip; it has 3 (Survey, Walk, Run)"), || text)
}

fn references(folder: &Path) -> Result<(), Failed> {
    let schema = serde_json::from_str(SCHEMA)?;
    let mut count = 0;
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.display().to_string();
        if !name.ends_with(".scene.json") {
            continue;
        }
        count += 1;
        let mut document: serde_json::Value = serde_json::from_slice(&std::fs::read(&path)?)?;
        expect(schema::fault(&schema, &document).is_none(), || {
            format!("{name}: {:?}", schema::fault(&schema, &document))
        })?;
        load(&name).map_err(|e| e.to_string())?;
        document["fog"] = 1.into();
        expect(schema::fault(&schema, &document).is_some(), || "an unknown key passed".to_owned())?;
    }
    expect(count >= 3, || format!("only {count} scene files"))
}

fn nasty(folder: &Path) -> Result<(), Failed> {
    let mut files = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            let name = path.display().to_string().to_ascii_lowercase();
            if path.is_dir() {
                open.push(path);
            } else if EXTENSIONS.iter().any(|e| name.ends_with(e)) {
                files.push(path);
            }
        }
    }
    files.sort();
    if files.len() < 60 {
        return Err(format!("only {} files in {}", files.len(), folder.display()).into());
    }
    let mut wrong = Vec::new();
    for path in files {
        let short = path.strip_prefix(folder).unwrap_or(&path).display().to_string();
        match in_a_child(&path) {
            Ok(text) if text.starts_with("scene") => {}
            Ok(text) => {
                let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
                // "error FILE: REASON"
                let reason = text.rsplit(": ").next().unwrap_or_default();
                if !(text.starts_with("error") && text.contains(stem) && reason.len() > 5) {
                    wrong.push(format!("{short}: the message does not name file and reason: {text}"));
                }
            }
            Err(why) => wrong.push(format!("{short}: {why}")),
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n").into()) }
}
