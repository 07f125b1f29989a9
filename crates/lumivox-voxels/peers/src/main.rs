//! Our voxelizer beside others on one mesh, in one process, taking turns so that a busy machine slows all alike.
//!
//! `peers MESH.ply [RESOLUTION...]`; the PLY must be binary little-endian with float positions and `uchar int` faces.
//! The variable `ONLY` picks one contestant by its name, or with `~` before it all that contain it.
//! Times are medians and minima over the rounds; CPU times are what all threads together took, which other
//! programs on the machine change less.

mod dense;

use std::hint::black_box;
use std::time::Instant;

use lumivox_core::{Bounds, Grid, TriangleView};
use lumivox_voxels::{Channel, Coverage, Material, MaterialOf, MeshView, Model, VoxelizeOptions, voxelize};

type Failure = Box<dyn std::error::Error>;

struct Mesh {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

/// One contestant: what it is called, and its work, which returns the number of cells.
struct Entry<'a> {
    name: &'static str,
    run: Box<dyn Fn() -> usize + 'a>,
    wall: Vec<f64>,
    cpu: Vec<f64>,
    cells: usize,
}

fn main() -> Result<(), Failure> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("usage: peers MESH.ply [RESOLUTION...]")?;
    let mesh = read_ply(&std::fs::read(&path)?)?;
    let mut resolutions: Vec<u32> = args.map(|a| a.parse()).collect::<Result<_, _>>()?;
    if resolutions.is_empty() {
        resolutions = vec![64, 128, 256, 512];
    }
    println!("{path}: {} triangles, {} threads", mesh.indices.len(), rayon::current_num_threads());
    for n in resolutions {
        round(&mesh, n)?;
    }
    Ok(())
}

fn round(mesh: &Mesh, n: u32) -> Result<(), Failure> {
    let view = TriangleView { positions: &mesh.positions, indices: &mesh.indices };
    let used = Bounds::of_points(mesh.indices.iter().flatten().map(|&i| mesh.positions[i as usize].into()));
    let grid = Grid::fit(&used, n)?;
    let model = Model::from(view);
    // Stripes of a thousand triangles.
    let stripes: Vec<u32> = (0..mesh.indices.len() as u32).map(|n| n / 1000 % 3).collect();
    let striped = Model {
        meshes: vec![MeshView { material: MaterialOf::Triangle(&stripes), ..MeshView::new(view) }],
        materials: [0.2, 0.5, 0.8]
            .map(|red| Material { base_color: glam::Vec4::new(red, 0.5, 0.5, 1.0), ..Material::default() })
            .to_vec(),
    };
    let ours_of = |model, coverage, channels: Vec<Channel>| {
        let model: &Model<'_> = model;
        move || {
            let options =
                VoxelizeOptions { coverage, channels: channels.clone(), ..VoxelizeOptions::resolution(n) };
            voxelize(model, &options).map_or(0, |volume| black_box(volume).len() as usize)
        }
    };
    let ours = |coverage, channels| ours_of(&model, coverage, channels);
    // Others take positions in cells, some with cells centred on whole numbers.
    let in_cells = |shift: f32| -> Vec<[f32; 3]> {
        mesh.positions.iter().map(|&p| (grid.grid_from_world(p.into()) - shift).to_array()).collect()
    };
    let (corner, center) = (in_cells(0.0), in_cells(0.5));
    let flat: Vec<usize> = mesh.indices.iter().flatten().map(|&i| i as usize).collect();
    let points: Vec<parry3d::math::Vector> =
        corner.iter().map(|p| parry3d::math::Vector::new(p[0], p[1], p[2])).collect();

    let mut entries = Vec::new();
    let mut add = |name, run| {
        entries.push(Entry { name, run, wall: Vec::new(), cpu: Vec::new(), cells: 0 });
    };
    let both = vec![Channel::albedo(), Channel::normal()];
    add("lumivox exact", Box::new(ours(Coverage::Exact, vec![])));
    add("lumivox exact, albedo, normal", Box::new(ours(Coverage::Exact, both.clone())));
    add("lumivox exact, of three colours", Box::new(ours_of(&striped, Coverage::Exact, both)));
    add("lumivox thin", Box::new(ours(Coverage::Thin, vec![])));
    add("lumivox sampled", Box::new(ours(Coverage::Sampled, vec![])));
    add("dense bits, f32, one thread", Box::new(|| dense::voxelize(&corner, &mesh.indices, grid.dims)));
    add(
        "dda-voxelize (not conservative)",
        Box::new(|| {
            let mut voxelizer = dda_voxelize::DdaVoxelizer::<()>::new();
            for t in &mesh.indices {
                voxelizer.add_triangle(&t.map(|i| center[i as usize]), &|_: Option<&()>, _, _| ());
            }
            black_box(voxelizer.finalize()).len()
        }),
    );
    add(
        "meshvox",
        Box::new(|| {
            black_box(meshvox::voxelize::Voxels::<f32>::voxelize(&corner, &flat, 1.0)).grid_positions.len()
        }),
    );
    add(
        "parry3d",
        Box::new(|| {
            use parry3d::transformation::voxelization::{FillMode, VoxelSet};
            black_box(VoxelSet::with_voxel_size(&points, &mesh.indices, 1.0, FillMode::SurfaceOnly, false))
                .voxels()
                .len()
        }),
    );
    if let Ok(only) = std::env::var("ONLY") {
        entries.retain(|entry: &Entry<'_>| {
            entry.name == only || only.starts_with("~") && entry.name.contains(&only[1..])
        });
    }
    let started = Instant::now();
    for turn in 0..16 {
        for entry in &mut entries {
            let (wall, cpu) = (Instant::now(), cpu_millis());
            let cells = (entry.run)();
            let (wall, cpu) = (wall.elapsed().as_secs_f64() * 1e3, cpu_millis() - cpu);
            entry.cells = cells;
            // The first turn warms up.
            if turn > 0 {
                entry.wall.push(wall);
                entry.cpu.push(cpu);
            }
        }
        if turn >= 3 && started.elapsed().as_secs() > 30 {
            break;
        }
    }
    println!("\n{n} cells along the longest axis, {} turns", entries[0].wall.len());
    println!(
        "{:34} {:>9} {:>9} {:>9} {:>9} {:>7} {:>9}",
        "", "median ms", "min ms", "cpu ms", "min cpu", "ratio", "cells"
    );
    let mut base = 0.0;
    for entry in &mut entries {
        entry.wall.sort_by(f64::total_cmp);
        entry.cpu.sort_by(f64::total_cmp);
        let median = entry.wall[entry.wall.len() / 2];
        base = if base == 0.0 { median } else { base };
        println!(
            "{:34} {median:9.2} {:9.2} {:9.2} {:9.2} {:7.2} {:9}",
            entry.name,
            entry.wall[0],
            entry.cpu[entry.cpu.len() / 2],
            entry.cpu[0],
            median / base,
            entry.cells
        );
    }
    Ok(())
}

/// Milliseconds that this process's threads have run, where the system tells (Linux).
fn cpu_millis() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    let nanos: u64 = tasks
        .filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok())
        .filter_map(|text| text.split(' ').next()?.parse::<u64>().ok())
        .sum();
    nanos as f64 / 1e6
}

fn read_ply(bytes: &[u8]) -> Result<Mesh, Failure> {
    let end = b"end_header\n";
    let body = bytes.windows(end.len()).position(|w| w == end).ok_or("no PLY header")? + end.len();
    let header = std::str::from_utf8(&bytes[..body])?;
    let count = |what: &str| -> Result<usize, Failure> {
        let line = header.lines().find_map(|l| l.strip_prefix(what)).ok_or("no such element")?;
        Ok(line.trim().parse()?)
    };
    let (vertices, faces) = (count("element vertex")?, count("element face")?);
    let word = |at: usize| -> Result<[u8; 4], Failure> {
        Ok(bytes.get(at..at + 4).ok_or("the file ends early")?.try_into()?)
    };
    let mut positions = Vec::new();
    for n in 0..vertices {
        let at = body + 12 * n;
        positions.push([
            f32::from_le_bytes(word(at)?),
            f32::from_le_bytes(word(at + 4)?),
            f32::from_le_bytes(word(at + 8)?),
        ]);
    }
    let mut indices = Vec::new();
    for n in 0..faces {
        let at = body + 12 * vertices + 13 * n + 1;
        indices.push([
            u32::from_le_bytes(word(at)?),
            u32::from_le_bytes(word(at + 4)?),
            u32::from_le_bytes(word(at + 8)?),
        ]);
    }
    Ok(Mesh { positions, indices })
}
