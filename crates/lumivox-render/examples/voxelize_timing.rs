//! Times of the GPU voxelizer on a scene: `voxelize_timing SCENE [RESOLUTION...]`, wall clock around submission and wait, and the
//! processor time of the whole program, which on a software driver is the steadier of the two.

use std::time::Instant;

use lumivox::core::Grid;
use lumivox::gpu::{AdapterChoice, Gpu, Tier};
use lumivox::voxelize::{Channel, Coverage, IndexView, Mesh, MeshDescriptor, Options, VertexView, Voxelizer};
use lumivox::wgpu::{self, BufferUsages, IndexFormat, VertexFormat};
use lumivox_scene::Scene;

const RUNS: u32 = 5;

#[expect(clippy::print_stdout, reason = "its output")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().ok_or("which scene?")?;
    let scene = match path.as_str() {
        // Twelve triangles as large as the grid.
        "huge" => lumivox_scene::builtin::furnace(1),
        path => lumivox_scene::load(path)?,
    };
    let resolutions: Vec<u32> = args.filter_map(|a| a.parse().ok()).collect();
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let meshes = upload(&gpu, &scene)?;
    let meshes: Vec<&Mesh> = meshes.iter().collect();
    println!("{} triangles in {} meshes", scene.triangle_count(), meshes.len());
    for n in resolutions {
        let grid = Grid::fit(&scene.bounds(), n)?;
        for (name, coverage, channels) in [
            ("exact", Coverage::Exact, vec![]),
            ("exact albedo normal", Coverage::Exact, vec![Channel::albedo(), Channel::normal()]),
            ("thin", Coverage::Thin, vec![]),
            ("thin albedo normal", Coverage::Thin, vec![Channel::albedo(), Channel::normal()]),
            ("sampled", Coverage::Sampled, vec![]),
        ] {
            let options = Options { coverage, ..Options::default() };
            let mut voxelizer = Voxelizer::new(&gpu, grid, &channels, &options)?;
            let mut volume = voxelizer.volume(&gpu)?;
            let mut once = || -> Result<f64, lumivox::gpu::GpuError> {
                let start = Instant::now();
                let mut encoder = gpu.device.create_command_encoder(&Default::default());
                voxelizer.record(&gpu, &mut encoder, &meshes, &mut volume)?;
                gpu.queue.submit([encoder.finish()]);
                gpu.wait()?;
                Ok(start.elapsed().as_secs_f64() * 1e3)
            };
            once()?;
            let before = processor_millis();
            let mut times = (0..RUNS).map(|_| once()).collect::<Result<Vec<_>, _>>()?;
            let processor = (processor_millis() - before) / f64::from(RUNS);
            times.sort_by(f64::total_cmp);
            let cells = voxelizer.read_occupancy(&gpu)?.iter().filter(|c| **c).count();
            println!(
                "{n:5} {name:20} wall min {:8.2} ms, median {:8.2} ms; processor {processor:8.1} ms; {cells} cells, {} passes",
                times[0],
                times[times.len() / 2],
                voxelizer.triangle_passes(),
            );
        }
    }
    Ok(())
}

/// Time that all threads of this program have spent, on Linux.
fn processor_millis() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(") ").next().unwrap_or_default().split(' ');
    10.0 * fields.skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>()
}

fn upload(gpu: &Gpu, scene: &Scene) -> Result<Vec<Mesh>, Box<dyn std::error::Error>> {
    let mut meshes = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let positions = buffer(gpu, lumivox::bytemuck::cast_slice(&mesh.positions));
        let indices = buffer(gpu, lumivox::bytemuck::cast_slice(&mesh.indices));
        let view = VertexView { buffer: &positions, offset: 0, stride: 12, format: VertexFormat::Float32x3 };
        let count = 3 * mesh.indices.len() as u32;
        let indices = IndexView { buffer: &indices, offset: 0, format: IndexFormat::Uint32, count };
        let descriptor = MeshDescriptor {
            indices: Some(indices),
            world_from_local: instance.world_from_local,
            ..MeshDescriptor::new(view, mesh.positions.len() as u32)
        };
        meshes.push(Mesh::new(gpu, &descriptor)?);
    }
    Ok(meshes)
}

fn buffer(gpu: &Gpu, bytes: &[u8]) -> wgpu::Buffer {
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
    let made = lumivox::gpu::Buffer::with_usage(gpu, "mesh", bytes.len() as u64, usage);
    gpu.queue.write_buffer(&made.raw, 0, bytes);
    made.raw
}
