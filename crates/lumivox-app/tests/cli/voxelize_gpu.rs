//! `lumivox voxelize` on a GPU, against the exact voxelizer and against the CPU's.

use glam::{UVec3, Vec3};
use libtest_mimic::Failed;
use lumivox::core::{Grid, TriangleView};
use lumivox_oracle::voxels::{Coverage, VoxelDifference, VoxelSet};

use crate::support::{Folder, read_json};
use crate::voxel_colors::sheet;
use crate::voxel_files::{self, Points, arrays};

/// A knot over glass, which no axis is good for.
const MODEL: &str = "builtin:knot_glass:1";

const METHODS: [&str; 5] = ["direct", "slicing", "clipping", "slice-per-pass", "slicemap"];

/// The grid that the statistics tell of.
fn grid(folder: &Folder) -> Result<Grid, Failed> {
    let stats = read_json(&folder.join("s.json"))?;
    let number = |value: &serde_json::Value| value.as_f64().unwrap() as f32;
    Ok(Grid {
        origin: Vec3::from_array([0, 1, 2].map(|n| number(&stats["origin"][n]))),
        cell_size: number(&stats["cell_size_m"]),
        dims: UVec3::from_array([0, 1, 2].map(|n| number(&stats["dims"][n]) as u32)),
    })
}

/// Which cells of the grid a file has.
fn occupied(grid: &Grid, points: &Points) -> Vec<bool> {
    let mut cells = vec![false; grid.cell_count() as usize];
    for point in points.keys() {
        let at = [0, 1, 2].map(|n| point[n] as f64 / 1000.0 - f64::from(grid.origin[n] / grid.cell_size));
        cells[grid.index(UVec3::from_array(at.map(|v| v.floor() as u32)))] = true;
    }
    cells
}

/// What was made last of the model, against the exact voxelizer.
fn against_oracle(folder: &Folder, coverage: Coverage) -> Result<VoxelDifference, Failed> {
    let scene = lumivox_scene::load(MODEL)?;
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let first = positions.len() as u32;
        positions.extend(
            mesh.positions.iter().map(|&p| instance.world_from_local.transform_point3(p.into()).to_array()),
        );
        indices.extend(mesh.indices.iter().map(|triangle| triangle.map(|corner| first + corner)));
    }
    let triangles = TriangleView::new(&positions, &indices).ok_or("triangles without corners")?;
    let grid = grid(folder)?;
    let points = voxel_files::read(&folder.join("x.npz"), f64::from(grid.cell_size))?;
    let set = VoxelSet::of(grid, triangles, coverage);
    Ok(VoxelDifference::between(&occupied(&grid, &points), &set)?)
}

/// Every coverage on the GPU and on the CPU has the exact voxelizer's cells, but for those whose verdict hangs on rounding.
pub(crate) fn coverages() -> Result<(), Failed> {
    let folder = Folder::new();
    for (name, coverage) in
        [("exact", Coverage::Exact), ("thin", Coverage::Thin), ("sampled", Coverage::Sampled)]
    {
        for device in ["gpu", "cpu"] {
            folder
                .line(&format!(
                    "voxelize {MODEL} --resolution 48 -o x.npz --coverage {name} --device {device} --stats s.json"
                ))
                .succeeded();
            let difference = against_oracle(&folder, coverage)?;
            assert!(difference.is_equal_within_margin(), "{name} on the {device}: {difference}");
            assert!(difference.ours > 1000, "{name} on the {device}: {difference}");
        }
    }
    Ok(())
}

/// Each method makes a volume of the cells that it should, and says what it is.
pub(crate) fn methods() -> Result<(), Failed> {
    let folder = Folder::new();
    let line = format!("voxelize {MODEL} --resolution 24 -o x.npz --stats s.json --coverage sampled");
    folder.line(&format!("{line} --method cpu")).succeeded();
    let of_cpu = read_json(&folder.join("s.json"))?;
    assert_eq!((&of_cpu["device"]["kind"], &of_cpu["device"]["method"]), (&"cpu".into(), &"cpu".into()));
    for method in METHODS {
        let run = folder.line(&format!("{line} --method {method}"));
        run.succeeded();
        let stats = read_json(&folder.join("s.json"))?;
        assert_eq!((&stats["device"]["kind"], &stats["device"]["method"]), (&"gpu".into(), &method.into()));
        assert!(stats["device"]["ms"].as_f64() > Some(0.0), "{method}");
        let adapter = stats["device"]["adapter"]["name"].as_str().unwrap();
        assert!(run.stderr.contains(adapter) && run.stderr.contains(method), "{}", run.stderr);
        assert_eq!((&stats["coverage"], &stats["triangles"]), (&"sampled".into(), &of_cpu["triangles"]));
        let channels = stats["channels"].as_array().unwrap().len();
        assert_eq!(channels, if method == "slicemap" { 1 } else { 2 }, "{method}");
        let difference = against_oracle(&folder, Coverage::Sampled)?;
        match method {
            // They sample along every axis, and so find more.
            "slice-per-pass" | "slicemap" => {
                let is_more = difference.sure_recall() > 0.99 && difference.ours < 2 * difference.reference;
                assert!(is_more, "{method}: {difference}");
            }
            _ => assert!(difference.is_equal_within_margin(), "{method}: {difference}"),
        }
    }
    Ok(())
}

/// Values of all channels are the CPU's.
pub(crate) fn channels() -> Result<(), Failed> {
    let folder = Folder::new();
    for model in [MODEL, "builtin:furnace:0"] {
        let mut found = Vec::new();
        for device in ["cpu", "gpu"] {
            let channels = "albedo:f32,normal:f32,emission:f32,area:f32";
            folder
                .line(&format!(
                    "voxelize {model} --resolution 24 -o x.npz --channels {channels} --device {device}"
                ))
                .succeeded();
            found.push(arrays(&std::fs::read(folder.join("x.npz"))?)?);
        }
        for channel in ["albedo", "normal", "emission", "area"] {
            let floats = |n: usize| -> Vec<f32> {
                let bytes = found[n][channel].1.chunks_exact(4);
                bytes.map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect()
            };
            let (cpu, gpu) = (floats(0), floats(1));
            assert_eq!(cpu.len(), gpu.len());
            let largest = cpu.iter().fold(0.0f32, |a, b| a.max(b.abs()));
            let mean = |list: &[f32]| list.iter().map(|v| f64::from(v.abs())).sum::<f64>();
            let apart: f64 = cpu.iter().zip(&gpu).map(|(a, b)| f64::from((a - b).abs())).sum();
            eprintln!("{model}, {channel}: {apart} of {}, up to {largest}", mean(&cpu));
            assert!(apart <= 1e-4 * mean(&cpu), "{model}, {channel}: {apart} of {}", mean(&cpu));
        }
        assert!(found[0]["area"].1 != vec![0; found[0]["area"].1.len()]);
    }
    Ok(())
}

/// Textures have the CPU's colours within a few percent, in cells larger and smaller than texels.
pub(crate) fn textures() -> Result<(), Failed> {
    let folder = Folder::new();
    sheet(&folder, 64, |x, y| [4 * x as u8, 4 * y as u8, if (x / 16 + y / 16) % 2 == 0 { 200 } else { 120 }]);
    for n in [4, 12, 100] {
        let mut found = Vec::new();
        for device in ["cpu", "gpu"] {
            folder
                .line(&format!("voxelize sheet.obj -o x.ply --resolution {n} --device {device}"))
                .succeeded();
            found.push(voxel_files::read(&folder.join("x.ply"), 1.0 / f64::from(n))?);
        }
        assert!(found[0].keys().eq(found[1].keys()) && found[0].len() == (n * n) as usize);
        let colors = |points: &Points| -> Vec<[u8; 3]> { points.values().map(|c| c.unwrap()).collect() };
        let (cpu, gpu) = (colors(&found[0]), colors(&found[1]));
        let apart = cpu
            .iter()
            .zip(&gpu)
            .map(|(a, b)| (0..3).map(|n| f64::from(a[n].abs_diff(b[n]))).sum::<f64>() / (3.0 * 255.0));
        let mean = apart.sum::<f64>() / cpu.len() as f64;
        eprintln!("{n} cells: {mean} apart");
        assert!(mean < 0.03, "{n} cells: {mean} apart");
    }
    Ok(())
}

/// A grid that does not fit at once is done slab by slab, with the same result, by every method.
pub(crate) fn slabs() -> Result<(), Failed> {
    let folder = Folder::new();
    for method in &METHODS[..4] {
        let line = format!("voxelize {MODEL} --resolution 60 -o x.npz --stats s.json --method {method}");
        let made = |memory: u64| -> Result<_, Failed> {
            folder.line(&format!("{line} --memory {memory}")).succeeded();
            let slabs = read_json(&folder.join("s.json"))?["device"]["slabs"].as_u64();
            Ok((slabs.ok_or("no slabs are told")?, std::fs::read(folder.join("x.npz"))?))
        };
        let (at_once, in_slabs) = (made(4096)?, made(2)?);
        assert!(at_once.0 == 1 && in_slabs.0 > 1, "{method}: {} and {}", at_once.0, in_slabs.0);
        assert!(at_once.1 == in_slabs.1, "{method}");
    }
    Ok(())
}

/// What a GPU or a method cannot do is refused, and auto has the CPU do it.
pub(crate) fn refusals() -> Result<(), Failed> {
    let folder = Folder::new();
    for (arguments, words) in [
        ("--method slicing --coverage exact", vec!["slicing", "no exact coverage"]),
        ("--method clipping --coverage thin", vec!["clipping", "no thin coverage"]),
        ("--method slice-per-pass --coverage thin", vec!["slice-per-pass", "no thin coverage"]),
        ("--method slicemap --coverage exact", vec!["slicemap", "no exact coverage"]),
        ("--method slicemap --channels albedo", vec!["slicemap", "a bit a cell", "albedo"]),
        ("--device gpu --snap 0.1", vec!["--snap", "CPU alone"]),
        ("--device cpu --method direct", vec!["--device", "--method"]),
        ("--device gpu --method cpu", vec!["--device", "--method"]),
        ("--device cpu --adapter any", vec!["--device", "--adapter"]),
        ("--adapter no-such-adapter", vec!["no graphics adapter found", "no-such-adapter"]),
        ("--device gpu --resolution 400 --memory 1", vec!["400", "1.0 MiB are allowed", "would fit"]),
    ] {
        folder.line(&format!("voxelize builtin:furnace:0 -o x.npz {arguments}")).failed_with(&words);
    }
    assert_eq!(folder.files(), [""; 0]);
    let run = folder.line("voxelize builtin:furnace:0 -o x.npz --resolution 8 --snap 0.1 --device auto");
    run.succeeded();
    assert!(run.stderr.contains("on the CPU") && run.stderr.contains("--snap"), "{}", run.stderr);
    folder.line("voxelize builtin:furnace:0 -o x.npz --resolution 8 --device auto").succeeded();
    Ok(())
}
