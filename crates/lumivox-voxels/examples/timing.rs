//! Times of the voxelizer on one mesh: `timing MESH [RESOLUTION...]`.

use std::time::Instant;

use lumivox_core::TriangleView;
use lumivox_voxels::{Channel, Coverage, Model, VoxelizeOptions, voxelize};

#[expect(clippy::print_stdout, reason = "its output")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("which mesh?")?;
    let scene = lumivox_scene::load(&path)?;
    let mesh = &scene.meshes[0];
    let resolutions: Vec<u32> = args.filter_map(|a| a.parse().ok()).collect();
    let view = TriangleView { positions: &mesh.positions, indices: &mesh.indices };
    let (positions, indices) = weld(view);
    let model = Model::from(TriangleView { positions: &positions, indices: &indices });
    println!("{} triangles", model.meshes[0].triangles.len());
    for n in resolutions {
        for (name, coverage, channels) in [
            ("exact", Coverage::Exact, vec![]),
            ("exact albedo normal", Coverage::Exact, vec![Channel::albedo(), Channel::normal()]),
            ("thin", Coverage::Thin, vec![]),
            ("sampled", Coverage::Sampled, vec![]),
        ] {
            let options = VoxelizeOptions { coverage, channels, ..VoxelizeOptions::resolution(n) };
            let mut times = Vec::new();
            let mut volume = voxelize(&model, &options)?;
            for _ in 0..9 {
                let start = Instant::now();
                volume = voxelize(&model, &options)?;
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
            times.sort_by(f64::total_cmp);
            println!(
                "{n:5} {name:20} min {:8.2} ms, median {:8.2} ms, {} cells, {:.1} MiB",
                times[0],
                times[times.len() / 2],
                volume.len(),
                volume.bytes() as f64 / 1048576.0
            );
        }
    }
    Ok(())
}

/// The importer gives each triangle its own corners; files share them.
fn weld(view: TriangleView<'_>) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut places = std::collections::HashMap::new();
    let mut positions = Vec::new();
    let indices = view.indices.iter().map(|t| {
        t.map(|i| {
            let p = view.positions[i as usize];
            *places.entry(p.map(f32::to_bits)).or_insert_with(|| {
                positions.push(p);
                positions.len() as u32 - 1
            })
        })
    });
    let indices = indices.collect();
    (positions, indices)
}
