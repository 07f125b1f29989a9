//! What `lumivox compare` measures and writes.

use std::path::Path;

use libtest_mimic::Failed;
use serde_json::Value;

use crate::support::{Folder, QUICK, glb, read_exr, read_json};

/// Quick, and from inside the box, so that every pixel is foreground whoever looks.
const INSIDE: &str = "compare builtin:cornell:0 --grid 16 --camera 0,1,0.9:0,0.9,-1:60";

pub(crate) fn wrong_references() -> Result<(), Failed> {
    let folder = Folder::new();
    let compare = |reference: &str, more: &str| {
        folder.line(&format!("{INSIDE} --out o --reference {reference} {more}"))
    };
    compare("nowhere", "").failed_with(&["nowhere", "no such folder"]);
    folder.write("file", "no folder");
    compare("file", "").failed_with(&["file", "no such folder"]);
    std::fs::create_dir(folder.join("empty"))?;
    compare("empty", "").failed_with(&["cannot read the reference", "direct.exr"]);
    write_exr(&folder.join("half/direct.exr"), 8, 6, 0.5)?;
    compare("half", "").failed_with(&["cannot read the reference", "indirect.exr"]);
    folder.write("half/indirect.exr", b"this is no picture at all");
    compare("half", "").failed_with(&["cannot read the reference", "indirect.exr"]);
    write_exr(&folder.join("half/indirect.exr"), 8, 7, 0.5)?;
    compare("half", "").failed_with(&["half", "8x6", "8x7"]);
    write_exr(&folder.join("half/indirect.exr"), 8, 6, f32::NAN)?;
    compare("half", "").failed_with(&["indirect.exr", "pixel 0, 0", "not finite"]);
    write_exr(&folder.join("half/indirect.exr"), 8, 6, 0.5)?;
    compare("half", "--size 9x6").failed_with(&["9x6", "8x6", "--size"]);
    let left: Vec<_> = folder.files().into_iter().filter(|f| f.starts_with("o/")).collect();
    assert!(left.is_empty(), "{left:?}");
    Ok(())
}

fn write_exr(path: &Path, width: usize, height: usize, value: f32) -> Result<(), Failed> {
    path.parent().map_or(Ok(()), std::fs::create_dir_all)?;
    exr::prelude::write_rgb_file(path, width, height, |_, _| (value, value, value))
        .map_err(|e| e.to_string())?;
    Ok(())
}

pub(crate) fn comparison<'a>(report: &'a Value, layer: &str, quantity: &str) -> &'a Value {
    let all = report["comparisons"].as_array().unwrap();
    all.iter().find(|c| c["layer"] == layer && c["quantity"] == quantity).unwrap()
}

pub(crate) fn against_the_tracer() -> Result<(), Failed> {
    let folder = Folder::new();
    let line = "compare builtin:cornell:0 --size 64x48 --grid 16 --max-samples 24 --out o/c --stats s.json";
    let run = folder.line(line);
    for word in
        ["path tracer, ", "direct radiance", "indirect irradiance", "trimmed", "voxels: ", "thin cells"]
    {
        assert!(run.succeeded().stdout.contains(word), "{}", run.stdout);
    }
    let mut expected = vec!["o/c/compare.json".to_owned(), "o/c/sheet.png".to_owned(), "s.json".to_owned()];
    for what in ["ours", "reference", "difference"] {
        for name in ["direct", "indirect", "direct_irradiance", "indirect_irradiance"] {
            expected.extend(["exr", "png"].map(|format| format!("o/c/{what}_{name}.{format}")));
        }
    }
    expected.sort();
    assert_eq!(folder.files(), expected);
    let report = read_json(&folder.join("o/c/compare.json"))?;
    assert_eq!(report, read_json(&folder.join("s.json"))?);

    // The box fills less than the picture; only its front edge may be another's in half a pixel.
    let pixels = &report["foreground"];
    assert!(pixels["both"].as_u64().is_some_and(|n| n > 2000 && n < 64 * 48), "{pixels}");
    assert!(
        pixels["only_ours"].as_u64() < Some(30) && pixels["only_reference"].as_u64() < Some(30),
        "{pixels}"
    );
    assert_eq!(
        (&report["reference"]["kind"], &report["reference"]["max_samples"]),
        (&"path_tracer".into(), &24.into())
    );
    let samples = report["reference"]["samples"].as_u64().unwrap();
    assert!((16..=24).contains(&samples), "{samples}");
    for (layer, quantity) in [
        ("direct", "radiance"),
        ("direct", "irradiance"),
        ("indirect", "radiance"),
        ("indirect", "irradiance"),
    ] {
        let c = comparison(&report, layer, quantity);
        for number in
            ["mean_ours", "mean_reference", "mean_ratio", "nrmse", "trimmed", "low_frequency", "flip"]
        {
            assert!(c[number].as_f64().is_some_and(|n| n > 0.0 && n < 3.0), "{number} of {c}");
        }
        assert!(c["trimmed"].as_f64() < c["nrmse"].as_f64(), "{c}");
        assert!(
            c["noise"].as_f64().is_some() && c["noise_is_low"].is_boolean() && c["note"].is_null(),
            "{c}"
        );
    }
    // A spot light's direct light has no noise, and no doubt but at the edges of its shadows.
    let direct = comparison(&report, "direct", "irradiance");
    assert!(direct["noise"].as_f64() < Some(1e-6) && direct["noise_is_low"] == true, "{direct}");
    assert!((direct["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.02, "{direct}");
    assert!(direct["trimmed"].as_f64() < Some(0.05), "{direct}");
    let voxels = &report["voxels"];
    assert!(voxels["recall_with_margin"].as_f64() > Some(0.99), "{voxels}");
    assert!(voxels["strays_beyond_margin"] == 0, "{voxels}");

    let file = |name: &str| read_exr(&folder.join("o/c").join(name));
    let [ours, theirs, difference] =
        [file("ours_direct.exr")?, file("reference_direct.exr")?, file("difference_direct.exr")?];
    // On the lit back wall.
    let (x, y) = (42, 19);
    for channel in 0..3 {
        let expected = ours[y][x][channel] - theirs[y][x][channel];
        assert!(ours[y][x][channel] > 0.0 && (difference[y][x][channel] - expected).abs() < 1e-6);
    }
    Ok(())
}

/// Pictures of the tracer given back as another renderer's have the same numbers, and our own have no error.
pub(crate) fn references_from_files() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.line(&format!("{INSIDE} --size 32x24 --max-samples 16 --out t")).succeeded();
    for from in ["reference", "ours"] {
        std::fs::create_dir(folder.join(from))?;
        for layer in ["direct", "indirect"] {
            let picture = folder.join(&format!("t/{from}_{layer}.exr"));
            std::fs::copy(picture, folder.join(&format!("{from}/{layer}.exr")))?;
        }
        folder.line(&format!("{INSIDE} --reference {from} --antialias 1 --out from_{from}")).succeeded();
    }
    let [traced, theirs, own] = ["t", "from_reference", "from_ours"]
        .map(|name| read_json(&folder.join(name).join("compare.json")).unwrap());
    assert_eq!(
        (&theirs["size"], &theirs["foreground"]["both"]),
        (&serde_json::json!([32, 24]), &(32 * 24).into())
    );
    for layer in ["direct", "indirect"] {
        let [traced, theirs, own] = [&traced, &theirs, &own].map(|r| comparison(r, layer, "radiance"));
        for number in [
            "pixels",
            "mean_ours",
            "mean_reference",
            "mean_ratio",
            "nrmse",
            "trimmed",
            "low_frequency",
            "flip",
        ] {
            assert_eq!(traced[number], theirs[number], "{number}");
        }
        assert!(theirs["noise"].is_null() && theirs["noise_is_low"].is_null());
        for (number, expected) in
            [("mean_ratio", 1.0), ("nrmse", 0.0), ("trimmed", 0.0), ("low_frequency", 0.0)]
        {
            assert_eq!(own[number].as_f64(), Some(expected), "{number} of {own}");
        }
    }
    // Its irradiance is radiance over albedo here and was traced there.
    let [traced, theirs] = [&traced, &theirs].map(|r| comparison(r, "direct", "irradiance"));
    let [a, b] = [traced, theirs].map(|c| c["mean_reference"].as_f64().unwrap());
    assert!((a / b - 1.0).abs() < 0.03, "{a} {b}");
    Ok(())
}

/// Averaged over pixels, ours comes closer to what an antialiased tracer sees than with one point each.
pub(crate) fn antialiased() -> Result<(), Failed> {
    let folder = Folder::new();
    let scene = "compare builtin:cornell:0 --grid 16 --gi off --size 32x24 --max-samples 64 --max-seconds 60";
    folder.line(&format!("{scene} --antialias 4 --out fine")).succeeded();
    std::fs::create_dir(folder.join("box"))?;
    for layer in ["direct", "indirect"] {
        let picture = folder.join(&format!("fine/reference_{layer}.exr"));
        std::fs::copy(picture, folder.join(&format!("box/{layer}.exr")))?;
    }
    for (points, out) in [("", "default"), ("--antialias 1", "coarse")] {
        folder.line(&format!("{scene} --reference box {points} --out {out}")).succeeded();
    }
    let report = |out: &str| read_json(&folder.join(out).join("compare.json"));
    let error = |report: &Value| comparison(report, "direct", "radiance")["nrmse"].as_f64().unwrap();
    let [fine, default, coarse] = [report("fine")?, report("default")?, report("coarse")?];
    assert_eq!([&fine["antialias"], &default["antialias"], &coarse["antialias"]], [4, 4, 1]);
    assert!(error(&fine) < 0.5 * error(&coarse), "{} {}", error(&fine), error(&coarse));
    assert!((error(&fine) - error(&default)).abs() < 0.01, "{} {}", error(&fine), error(&default));
    let run = folder.line("compare builtin:cornell:0 --size 4000x30 --antialias 4 --out big");
    run.failed_with(&["4000x30", "--antialias 4", "8192"]);
    Ok(())
}

/// A lamp with an area is surface to light, and so to the voxels.
pub(crate) fn rect_light() -> Result<(), Failed> {
    let folder = Folder::new();
    let lamp = r#"{ "camera": {"eye": [0,1,3], "target": [0,0.5,0], "up": [0,1,0], "fov_y_deg": 50},
        "lights": [{"type": "rect", "origin": [-0.4,1.53,-0.4], "u": [0.8,0,0], "v": [0,0,0.8], "radiance": [5,5,5]}],
        "meshes": [{"quad": [[-2,0.03,2],[2,0.03,2],[2,0.03,-2],[-2,0.03,-2]], "albedo": [0.5,0.5,0.5]},
                   {"box": {"center": [0,0.4,0], "size": [0.5,0.3,0.5], "rot_y_deg": 20}, "albedo": [0.7,0.6,0.5]}] }"#;
    folder.write("lamp.scene.json", lamp);
    let scene = "compare lamp.scene.json --grid 24 --size 32x24 --max-samples 256 --max-seconds 60 --out o";
    folder.line(scene).succeeded();
    let report = read_json(&folder.join("o/compare.json"))?;
    let voxels = &report["voxels"];
    assert!(
        voxels["strays_beyond_margin"] == 0 && voxels["recall_with_margin"].as_f64() > Some(0.99),
        "{voxels}"
    );
    let direct = comparison(&report, "direct", "irradiance");
    assert!((direct["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.03, "{direct}");
    Ok(())
}

/// A triangle that slides 0.7 m along x in one second.
const SLIDING: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":1,"output":2}]}],
"buffers":[{"byteLength":68,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAzMzM/AAAAAAAAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},{"buffer":0,"byteOffset":44,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}]}"#;

/// What moves is where it is at that time, for both.
pub(crate) fn moving() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("sliding.gltf", SLIDING);
    let scene =
        "compare sliding.gltf --camera 0.8,0.5,3:0.8,0.5,0:40 --sun 0,-1,-1:3 --gi off --max-samples 4";
    let pictures = ["0", "0.9"].map(|time| {
        folder.line(&format!("{scene} --size 48x36 --time {time} --out at_{time}")).succeeded();
        let report = read_json(&folder.join(&format!("at_{time}/compare.json"))).unwrap();
        let pixels = &report["foreground"];
        assert!(pixels["both"].as_u64() > Some(100), "{pixels}");
        assert!(
            pixels["only_ours"].as_u64() < Some(5) && pixels["only_reference"].as_u64() < Some(5),
            "{pixels}"
        );
        let direct = comparison(&report, "direct", "radiance");
        assert!((direct["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.01, "{direct}");
        read_exr(&folder.join(&format!("at_{time}/reference_direct.exr"))).unwrap()
    });
    assert!(pictures[0] != pictures[1], "it moves");
    Ok(())
}

pub(crate) fn dark_and_unlit() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("triangle.glb", glb());
    let quick = || QUICK.into_iter().chain(["--max-samples", "16"]);
    let run = folder.run(["compare", "triangle.glb", "--out", "t"].into_iter().chain(quick()));
    assert!(run.succeeded().stderr.contains("no light"), "{}", run.stderr);
    // One flat triangle under a sun alone: nothing bounces, and nothing divides by that.
    let sunny = ["compare", "triangle.glb", "--out", "s", "--sun", "-1,-2,-1:9,8,7"];
    let run = folder.run(sunny.into_iter().chain(quick()));
    assert!(run.succeeded().stdout.contains("not compared: the reference is black"), "{}", run.stdout);
    let report = read_json(&folder.join("s/compare.json"))?;
    let indirect = comparison(&report, "indirect", "radiance");
    assert!(indirect["nrmse"].is_null() && indirect["mean_reference"] == 0.0, "{indirect}");
    // Without indirect light there is no volume.
    let off = ["compare", "builtin:cornell:0", "--gi", "off", "--out", "o"];
    folder.run(off.into_iter().chain(quick())).succeeded();
    let report = read_json(&folder.join("o/compare.json"))?;
    assert!(report["voxels"].is_null() && report["voxels_note"].is_string(), "{report}");
    assert_eq!(comparison(&report, "indirect", "radiance")["mean_ours"], 0.0);
    Ok(())
}

/// 4.5 % when this was written, of which the path tracer's noise is 2 %.
pub(crate) fn gathered_light_in_a_box() -> Result<(), Failed> {
    let folder = Folder::new();
    let line = "compare builtin:cornell:0 --camera 0,1,0.9:0,0.9,-1:60 --size 48x36 --grid 48 --gi gather \
                --max-samples 4096 --out o";
    folder.line(line).succeeded();
    let report = read_json(&folder.join("o/compare.json"))?;
    let indirect = comparison(&report, "indirect", "irradiance");
    assert!((indirect["mean_ratio"].as_f64().unwrap() - 1.0).abs() < 0.05, "{indirect}");
    assert!(indirect["trimmed"].as_f64() < Some(0.06), "{indirect}");
    assert!(indirect["low_frequency"].as_f64() < Some(0.055), "{indirect}");
    assert!(indirect["noise"].as_f64() < Some(0.03), "{indirect}");
    Ok(())
}
