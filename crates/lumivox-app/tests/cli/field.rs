//! `lumivox field`, and pictures by fields.

use libtest_mimic::Failed;

use crate::support::{Folder, read_json};

/// A box without its top, of 4 x 2 x 2.
const TRAY: &str = "OFF\n8 5 0\n0 0 0\n4 0 0\n4 2 0\n0 2 0\n0 0 2\n4 0 2\n4 2 2\n0 2 2\n\
                    4 0 3 2 1\n4 0 1 5 4\n4 0 4 7 3\n4 1 2 6 5\n4 3 7 6 2\n";

pub(crate) fn wrong_arguments() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("t.off", TRAY);
    folder.write("broken.lvf", "LVF");
    for (arguments, words) in [
        ("t.off --points 100", vec!["'100'", "4226"]),
        ("t.off --directions 48", vec!["'48'", "64"]),
        ("t.off --bits 2", vec!["'2'", "1, 8 and 32"]),
        ("t.off -o t.npz", vec![".lvf"]),
        ("t.off -o t.lvf --maps t.lvf", vec!["t.lvf", "two outputs"]),
        ("t.off --maps t.jpg", vec!["t.jpg", ".png"]),
        ("broken.lvf", vec!["broken.lvf"]),
    ] {
        folder.line(&format!("field {arguments}")).failed_with(&words);
    }
    folder.line("field").refused_with(&["<INPUT>"]);
    folder.line("field t.off --mapping polar").refused_with(&["'polar'", "concentric"]);
    folder.line("render builtin:falling --ao often -o x.png").refused_with(&["'often'", "field"]);
    for (arguments, words) in [
        ("builtin:arena --ao field", vec!["--casters", "moves"]),
        ("builtin:falling:0 --ao field --casters knot,cow", vec!["\"cow\"", "goblet"]),
        ("builtin:falling:0 --ao field --field-points 3", vec!["'3'", "4226"]),
        ("builtin:falling:0 --shadows field --light-radius 1e9", vec!["--light-radius"]),
        ("builtin:falling:0 --reflections field --polish 1.5", vec!["--polish", "0 to 1"]),
    ] {
        folder.line(&format!("render {arguments} -o x.png")).failed_with(&words);
    }
    assert!(!folder.files().contains(&"x.png".to_owned()));
    Ok(())
}

pub(crate) fn baked() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("t.off", TRAY);
    folder.line("field t.off -o t.lvf --points 290 --maps t.png --check 2000 --stats t.json").succeeded();
    let stats = read_json(&folder.join("t.json"))?;
    assert_eq!((stats["points"].as_u64(), stats["rays"].as_u64()), (Some(290), Some(290 * 4096)));
    assert_eq!(stats["triangles"], 10);
    let radius = stats["sphere_radius_m"].as_f64().unwrap_or(0.0);
    assert!((radius - 6f64.sqrt()).abs() < 1e-3, "{radius}");
    // More points know the object better.
    folder.line("field t.off --points 1090 --check 2000 --stats fine.json").succeeded();
    let fine = read_json(&folder.join("fine.json"))?;
    let wrong = |stats: &serde_json::Value, kind: &str| stats[kind]["wrong"].as_f64().unwrap_or(-1.0);
    for kind in ["nearest", "blended"] {
        let [few, many] = [wrong(&stats, kind), wrong(&fine, kind)];
        assert!(many > 0.0 && many < 0.7 * few && few < 0.5, "{kind}: {few} {many}");
    }
    let picture = image::open(folder.join("t.png"))?.to_rgb8();
    assert_eq!(picture.dimensions(), (800, 536));
    // A field that is read is the one that was written.
    folder.line("field t.lvf --stats again.json").succeeded();
    // What says how a field is baked says nothing of one that is read.
    folder.line("field t.lvf --points 82 --normals").failed_with(&["--points, --normals"]);
    let again = read_json(&folder.join("again.json"))?;
    assert_eq!((&again["sphere_radius_m"], &again["bytes"]), (&stats["sphere_radius_m"], &stats["bytes"]));
    Ok(())
}

/// A stick of 8 x 0.2 x 0.2.
const STICK: &str = "OFF\n8 6 0\n0 0 0\n8 0 0\n8 .2 0\n0 .2 0\n0 0 .2\n8 0 .2\n8 .2 .2\n0 .2 .2\n\
                     4 0 3 2 1\n4 0 1 5 4\n4 0 4 7 3\n4 1 2 6 5\n4 3 7 6 2\n4 4 5 6 7\n";

pub(crate) fn several_spheres() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("s.off", STICK);
    let bake = "field s.off --points 82 --directions 32 --check 20000";
    folder.line(&format!("{bake} -o s.lvf --maps s.png --stats many.json")).succeeded();
    folder.line(&format!("{bake} --spheres 1 --stats one.json")).succeeded();
    let [many, one] = [read_json(&folder.join("many.json"))?, read_json(&folder.join("one.json"))?];
    let spheres = |stats: &serde_json::Value| stats["spheres"].as_array().map_or(0, Vec::len);
    assert_eq!((spheres(&many), spheres(&one)), (8, 1));
    let files = folder.files();
    assert!((1..=8).all(|n| files.contains(&format!("s.{n}.lvf"))) && !files.contains(&"s.lvf".to_owned()));
    assert!(many["room"].as_f64().is_some_and(|room| room < 0.05), "{}", many["room"]);
    let wrong = |stats: &serde_json::Value| stats["nearest"]["wrong"].as_f64().unwrap_or(-1.0);
    assert!(wrong(&many) > 0.0 && 2.0 * wrong(&many) < wrong(&one), "{} {}", wrong(&many), wrong(&one));
    assert_eq!(image::open(folder.join("s.png"))?.to_rgb8().dimensions(), (800, 8 * 536));
    Ok(())
}

pub(crate) fn pictures() -> Result<(), Failed> {
    let folder = Folder::new();
    let common = "render builtin:falling:0 --gi off --size 64x36 --light-samples 4 --field-points 82 --field-directions 32 \
                  --field-rays 8 --exposure 0";
    folder.line(&format!("{common} --ao field --shadows field -o both.png --stats s.json")).succeeded();
    let stats = read_json(&folder.join("s.json"))?;
    let stages: Vec<&str> =
        stats["stages"].as_array().into_iter().flatten().filter_map(|s| s["stage"].as_str()).collect();
    assert!(stages.contains(&"visibility/occlusion") && stages.contains(&"visibility/shadow"), "{stages:?}");
    folder.line(&format!("{common} --ao field --layer occlusion -o ao.png")).succeeded();
    let ao = image::open(folder.join("ao.png"))?.to_rgb8();
    let shades: std::collections::BTreeSet<u8> = ao.pixels().map(|p| p.0[0]).collect();
    assert!(shades.len() > 20, "{shades:?}");
    folder
        .line(&format!("{common} --reflections field --polish 0 --layer reflections -o mirror.png"))
        .succeeded();
    let mirror = image::open(folder.join("mirror.png"))?.to_rgb8();
    let red = mirror.pixels().filter(|p| u32::from(p.0[0]) > 2 * u32::from(p.0[2])).count();
    assert!(red > 20, "{red} pixels mirror the red body");
    folder.line(&format!("{common} --ao field --frames 2 -o s_%04d.png")).succeeded();
    assert!(folder.files().contains(&"s_0001.png".to_owned()));
    Ok(())
}
