//! `lumivox voxelize`: arguments, formats, fills, several meshes, and what cannot be.

use std::collections::BTreeMap;

use libtest_mimic::Failed;

use crate::support::{Folder, read_json};
use crate::voxel_files::{self, Points, key};

/// A lopsided tetrahedron with its smallest corner at (-3, 1, 20): no two axes can be mistaken for one another.
const TETRAHEDRON: &str =
    "OFF\n4 4 0\n-3 1 20\n1.75 1 20.5\n-2.5 8 21\n0 2 22.25\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

/// A cube from 0 to 1 with `faces` of its six faces, the top last.
fn cube(faces: usize) -> String {
    let corners = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
    let sides = ["4 0 3 2 1\n", "4 4 5 6 7\n", "4 0 1 5 4\n", "4 0 4 7 3\n", "4 1 2 6 5\n", "4 3 7 6 2\n"];
    format!("OFF\n8 {faces} 0\n{corners}{}", sides[..faces].concat())
}

pub(crate) fn wrong_arguments() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("t.off", TETRAHEDRON);
    folder.write("u.off", TETRAHEDRON);
    folder.write("none.off", "OFF\n0 0 0\n");
    std::fs::create_dir(folder.join("d"))?;
    folder.write("d/t.off", TETRAHEDRON);
    for (arguments, words) in [
        ("", vec!["<MESH>", "--output"]),
        ("t.off", vec!["--output"]),
        ("t.off -o x.npz --resolution 0", vec!["'0'", "--resolution", "1..=2048"]),
        ("t.off -o x.npz --resolution 2049", vec!["2049", "1..=2048"]),
        ("t.off -o x.npz --resolution 8 --voxel-size 1", vec!["--resolution", "--voxel-size"]),
        ("t.off -o x.npz --dims 8,8,8 --voxel-size 1", vec!["--dims", "--voxel-size"]),
        ("t.off -o x.npz --dims 8,8", vec!["'8,8'", "three numbers"]),
        ("t.off -o x.npz --dims 8,8,0", vec!["--dims", "1 to 2048"]),
        ("t.off -o x.npz --voxel-size large", vec!["large", "--voxel-size"]),
        ("t.off -o x.npz --bounds 0,0,0", vec!["--bounds", "x,y,z:x,y,z"]),
        ("t.off -o x.npz --bounds 0,0,0:1,-1,1", vec!["--bounds", "below"]),
        ("t.off -o x.npz --coverage fat", vec!["'fat'", "--coverage", "thin"]),
        ("t.off -o x.npz --channels colour", vec!["colour", "albedo", "emission"]),
        ("t.off -o x.npz --channels albedo:u9", vec!["u9", "f16", "nearest"]),
        ("t.off -o x.npz --channels occupancy:u8", vec!["occupancy", "no format"]),
        ("t.off -o x.npz --color red", vec!["'red'", "--color", "nearest"]),
        ("t.off -o x.npz --device abacus", vec!["'abacus'", "--device", "cpu"]),
        ("t.off -o x.npz --memory 0", vec!["'0'", "--memory"]),
        ("t.off -o d --format jpg", vec!["'jpg'", "npz", "ktx2"]),
    ] {
        folder.line(&format!("voxelize {arguments}")).refused_with(&words);
    }
    for (arguments, words) in [
        ("t.off -o x.jpg", vec!["x.jpg", ".npz", ".vox", ".binvox", ".ply", ".vdb", ".nhdr", ".ktx2"]),
        ("t.off -o x", vec!["x: ", ".npz"]),
        ("t.off -o x.npz --format vox", vec!["x.npz", "vox"]),
        ("t.off -o d", vec!["d: ", "folder", "--format"]),
        ("t.off u.off -o x.npz", vec!["x.npz", "several meshes", "--format"]),
        ("t.off d/t.off -o d --format npz", vec!["d/t.npz", "one file"]),
        ("t.off -o x.vox --cubes", vec!["--cubes", ".ply"]),
        ("t.off -o x.npz --time nan", vec!["--time", "finite"]),
        ("t.off -o x.npz --snap 2", vec!["--snap", "0.5"]),
        ("t.off -o x.npz --channels albedo,normal,albedo", vec!["albedo twice"]),
        ("t.off -o x.npz --clip walk", vec!["walk", "t.off does not move"]),
        ("t.off -o x.npz --voxel-size 0", vec!["t.off", "0 m"]),
        ("t.off -o x.npz --voxel-size -1", vec!["t.off", "-1 m"]),
        (
            "t.off -o x.npz --voxel-size 1e-3",
            vec!["0.001 m", "2048", "the smallest that would fit is 0.0034"],
        ),
        ("t.off -o x.npz --resolution 2048 --pad 1", vec!["--pad 1", "2050", "2048"]),
        ("t.off -o x.npz --dims 8,8,4 --pad 2", vec!["--pad 2", "8 x 8 x 4"]),
        ("t.off -o x.npz --bounds 5,5,5:6,6,6", vec!["t.off", "--bounds", "-3,1,20:1.75,8,22.25"]),
        ("t.off -o x.vox --resolution 2048", vec!["x.vox", "2048", "2000"]),
        ("t.off -o x.npz --resolution 2048 --memory 2", vec!["t.off", "2.0 MiB are allowed", "would fit"]),
        ("gone.off -o x.npz", vec!["gone.off", "cannot be read"]),
        ("t.off -o t.off/x.npz", vec!["cannot write", "t.off/x.npz"]),
        ("t.off -o x.npz --stats t.off", vec!["t.off", "overwritten"]),
        ("t.off -o x.npz --stats ./x.npz", vec!["x.npz", "one file"]),
        ("t.off -o x.ktx2 --stats x.albedo.ktx2", vec!["x.albedo.ktx2", "one file"]),
        ("builtin:palace -o x.npz", vec!["palace", "cornell"]),
    ] {
        folder.line(&format!("voxelize {arguments}")).failed("lumivox: ", &words);
    }
    folder.line("voxelize none.off -o x.npz").failed("", &["lumivox: none.off", "no triangles"]);
    folder.write("t.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
    folder.line("voxelize t.ply -o t.ply").failed_with(&["t.ply", "overwritten"]);
    assert_eq!(folder.files(), ["d/t.off", "none.off", "t.off", "t.ply", "u.off"]);
    Ok(())
}

/// All formats have the same cells at the same points in the world, by their own words for where the grid is.
pub(crate) fn formats() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("t.off", TETRAHEDRON);
    let side = 0.25;
    let mut seen: BTreeMap<&str, Points> = BTreeMap::new();
    for name in ["a.ply", "a.npz", "a.vox", "a.binvox", "a.nhdr", "a.ktx2"] {
        folder
            .run(["voxelize", "t.off", "--voxel-size", "0.25", "-o", name, "--stats", "s.json"])
            .succeeded();
        let points = voxel_files::read(&folder.join(name), side)?;
        assert_eq!(read_json(&folder.join("s.json"))?["voxels"], points.len(), "{name}");
        seen.insert(name, points);
    }
    let stats = read_json(&folder.join("s.json"))?;
    assert_eq!(stats["origin"], serde_json::json!([-3.0, 1.0, 20.0]));
    assert_eq!((&stats["dims"], &stats["cell_size_m"]), (&serde_json::json!([19, 28, 9]), &0.25.into()));
    let expected: Vec<[i64; 3]> = seen["a.ply"].keys().copied().collect();
    // The first corner's cell, and one that only an unmirrored tetrahedron has.
    for corner in [[-3.0, 1.0, 20.0], [-2.5, 7.75, 21.0]] {
        assert!(expected.contains(&key(corner.map(|v| v + side / 2.0), side)), "{corner:?}");
    }
    for (name, points) in &seen {
        assert!(points.keys().eq(&expected), "{name} has other cells");
    }
    // What the file says nothing about is four fifths grey: 231 of 255.
    assert!(seen["a.vox"].values().chain(seen["a.ply"].values()).all(|color| *color == Some([231; 3])));
    // OpenVDB's own library reads the rest.
    folder.line("voxelize t.off --voxel-size 0.25 -o a.vdb").succeeded();
    assert_eq!(std::fs::read(folder.join("a.vdb"))?[..4], *b" BDV");
    folder.line("voxelize t.off --voxel-size 0.25 -o cubes.ply --cubes").succeeded();
    let cubes = lumivox_scene::load(&folder.join("cubes.ply").display().to_string())?;
    assert!(cubes.triangle_count() > 2 * expected.len() as u64);
    let (low, high) = (cubes.bounds().min, cubes.bounds().max);
    assert_eq!((low.to_array(), high.to_array()), ([-3.0, 1.0, 20.0], [1.75, 8.0, 22.25]));
    Ok(())
}

/// Grids as they are asked for, and what the statistics say of them.
pub(crate) fn grids() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("cube.off", cube(6));
    for (arguments, dims, origin, cell_size) in [
        ("--resolution 10", [10, 10, 10], 0.0, 0.1),
        ("--resolution 10 --pad 2", [14, 14, 14], -0.2, 0.1),
        ("--dims 12,14,13 --pad 1", [12, 14, 13], -0.1, 0.1),
        ("--voxel-size 0.25", [4, 4, 4], 0.0, 0.25),
        ("--bounds 0,0,0:2,1,0.5 --voxel-size 0.5", [4, 2, 1], 0.0, 0.5),
        ("--bounds -0.5,-0.5,-0.5:1.5,1.5,1.5 --resolution 20", [20, 20, 20], -0.5, 0.1),
        ("", [128, 128, 128], 0.0, 1.0 / 128.0),
    ] {
        folder.line(&format!("voxelize cube.off -o x.binvox --stats s.json {arguments}")).succeeded();
        let stats = read_json(&folder.join("s.json"))?;
        assert_eq!(stats["dims"], serde_json::json!(dims), "{arguments}");
        let near = |value: &serde_json::Value, expected: f64| {
            value.as_f64().is_some_and(|v| (v - expected).abs() < 1e-6)
        };
        assert!(near(&stats["origin"][0], origin) && near(&stats["cell_size_m"], cell_size), "{arguments}");
    }
    let stats = read_json(&folder.join("s.json"))?;
    assert_eq!(stats["device"]["kind"], "cpu");
    assert_eq!((&stats["triangles"], &stats["coverage"]), (&12.into(), &"exact".into()));
    for stage in ["load", "binning", "cells", "write"] {
        let stages = stats["stages"].as_array().cloned().unwrap_or_default();
        assert!(stages.iter().any(|s| s["stage"] == stage && s["ms"].as_f64() >= Some(0.0)), "{stage}");
    }
    if cfg!(target_os = "linux") {
        assert!(stats["peak_memory_bytes"].as_u64() > Some(1 << 20));
    }
    let mut counts = Vec::new();
    for coverage in ["exact", "thin", "sampled"] {
        folder.write("t.off", TETRAHEDRON);
        let run = folder.line(&format!(
            "voxelize t.off -o x.npz --stats s.json --coverage {coverage} --channels occupancy,normal:f32,area,emission"
        ));
        assert!(run.succeeded().stderr.contains("on the CPU"), "{}", run.stderr);
        let stats = read_json(&folder.join("s.json"))?;
        let channels = stats["channels"].as_array().cloned().unwrap_or_default();
        let names: Vec<&str> = channels.iter().filter_map(|c| c["name"].as_str()).collect();
        assert_eq!(names, ["occupancy", "normal", "area", "emission"]);
        assert_eq!((&channels[1]["format"], &channels[2]["rule"]), (&"f32".into(), &"sum".into()));
        assert!(channels.iter().all(|channel| channel["voxels"] == stats["voxels"]));
        assert_eq!(
            (&channels[3]["nonzero_voxels"], &channels[1]["nonzero_voxels"]),
            (&0.into(), &stats["voxels"])
        );
        counts.push(stats["voxels"].as_u64());
    }
    assert!(counts[0] > counts[1] && counts[1] > counts[2], "{counts:?}");
    Ok(())
}

/// Closed surfaces are filled, wherever their cells were found; the hole of an open one is named.
pub(crate) fn solid() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("closed.off", cube(6));
    folder.write("open.off", cube(5));
    for device in ["cpu", "gpu"] {
        let line = format!("-o x.npz --solid --resolution 10 --stats s.json --device {device}");
        let voxelize = |name: &str| folder.line(&format!("voxelize {name} {line}"));
        let closed = voxelize("closed.off");
        assert!(!closed.succeeded().stderr.contains("open"), "{}", closed.stderr);
        let stats = read_json(&folder.join("s.json"))?;
        assert_eq!(stats["device"]["kind"], device);
        assert_eq!((&stats["voxels"], &stats["solid"]["filled_voxels"]), (&1000.into(), &512.into()));
        assert_eq!(stats["solid"]["hole"], serde_json::Value::Null);
        // The lid, at y = 1, is missing.
        let open = voxelize("open.off");
        for words in ["open.off: the surface is open", "4 edges", "0.5,1,0.5", "leaks in"] {
            assert!(open.succeeded().stderr.contains(words), "{words}: {}", open.stderr);
        }
        let solid = &read_json(&folder.join("s.json"))?["solid"];
        assert_eq!((&solid["filled_voxels"], &solid["boundary_edges"]), (&0.into(), &4.into()));
        assert_eq!(solid["hole"]["center"], serde_json::json!([0.5, 1.0, 0.5]));
    }
    Ok(())
}

pub(crate) fn many() -> Result<(), Failed> {
    let folder = Folder::new();
    folder.write("t.off", TETRAHEDRON);
    folder.write("cube.off", cube(6));
    folder.write("broken.off", "nonsense");
    let run = folder.line(
        "voxelize t.off cube.off builtin:cornell:0 -o out/ --format vox --resolution 12 --stats s.json",
    );
    assert_eq!(run.succeeded().stderr.lines().filter(|line| line.contains(" voxels in ")).count(), 3);
    assert_eq!(
        folder.files(),
        ["broken.off", "cube.off", "out/cornell_0.vox", "out/cube.vox", "out/t.vox", "s.json", "t.off"]
    );
    let stats = read_json(&folder.join("s.json"))?;
    assert_eq!(stats["volumes"].as_array().map(Vec::len), Some(3));
    assert_eq!(stats["volumes"][1]["voxels"], 12 * 12 * 12 - 10 * 10 * 10);
    // One that is broken does not keep the others, but the end is not well.
    let run =
        folder.line("voxelize t.off broken.off cube.off -o more --format npz --resolution 12 --stats s.json");
    run.failed("", &["broken.off", "1 of 3 meshes could not be voxelized: broken.off"]);
    let files = folder.files();
    let made: Vec<&String> = files.iter().filter(|file| file.starts_with("more/")).collect();
    assert_eq!(made, ["more/cube.npz", "more/t.npz"]);
    let stats = read_json(&folder.join("s.json"))?;
    assert!(stats["failed"][0]["error"].as_str().is_some_and(|error| error.contains("broken.off")));
    Ok(())
}

/// A door that opens: at another time other cells are occupied.
pub(crate) fn moving() -> Result<(), Failed> {
    let folder = Folder::new();
    let cells = |arguments: &str| {
        folder
            .line(&format!(
                "voxelize builtin:door:0 -o x.ply --voxel-size 0.125 --bounds -8,-1,-8:8,7,8 {arguments}"
            ))
            .succeeded();
        voxel_files::read(&folder.join("x.ply"), 0.125)
    };
    let (still, begin, later) = (cells("--clip none")?, cells("--clip 0")?, cells("--time 1.5")?);
    assert!(!begin.is_empty() && begin != later && !still.is_empty());
    assert!(begin == cells("")?, "the first clip is played unless said otherwise");
    folder.line("voxelize builtin:door:0 -o x.ply --clip 99").failed_with(&["99", "known are"]);
    Ok(())
}
