//! Triangles that live on the host's GPU become a volume: `cargo run -p lumivox --example voxelize_host_buffers`.

use lumivox::core::{Bounds, Grid};
use lumivox::glam::{Vec3, Vec4};
use lumivox::gpu::{AdapterChoice, Gpu, Tier};
use lumivox::voxelize::{Channel, IndexView, Mesh, MeshDescriptor, Options, VertexView, Voxelizer};
use lumivox::wgpu::{self, BufferUsages, IndexFormat, VertexFormat, util::DeviceExt};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let (vertices, indices) = torus(&gpu.device);

    // What is needed once. Vertices are position and normal, 24 bytes.
    let grid = Grid::fit(&Bounds::new(Vec3::new(-1.4, -0.4, -1.4), Vec3::new(1.4, 0.4, 1.4)), 64)?;
    let view = |offset| VertexView { buffer: &vertices, offset, stride: 24, format: VertexFormat::Float32x3 };
    let indices =
        IndexView { buffer: &indices, offset: 0, format: IndexFormat::Uint32, count: 6 * RINGS * SIDES };
    let mesh = MeshDescriptor {
        indices: Some(indices),
        normals: Some(view(12)),
        ..MeshDescriptor::new(view(0), RINGS * SIDES)
    };
    let mesh = Mesh::new(&gpu, &mesh)?;
    let mut voxelizer =
        Voxelizer::new(&gpu, grid, &[Channel::normal(), Channel::albedo()], &Options::default())?;
    let mut volume = voxelizer.volume(&gpu)?;

    // What is needed in each frame, whatever the vertices are by then.
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    voxelizer.record(&gpu, &mut encoder, &[&mesh], &mut volume)?;
    gpu.queue.submit([encoder.finish()]);

    let values = volume.read_back(&gpu)?;
    let normals: &[Vec4] = values.channel("normal").ok_or("no such channel")?;
    let occupied = normals.iter().filter(|n| n.w > 0.0).count();
    eprintln!("{occupied} of {} cells are occupied", grid.cell_count());
    Ok(())
}

const RINGS: u32 = 96;
const SIDES: u32 = 48;

/// Buffers as the host has them; `STORAGE` is what Lumivox asks of them.
fn torus(device: &wgpu::Device) -> (wgpu::Buffer, wgpu::Buffer) {
    let vertex = |n: u32| {
        let angle = |n: u32, of: u32| std::f32::consts::TAU * n as f32 / of as f32;
        let (ring, side) = (angle(n / SIDES, RINGS), angle(n % SIDES, SIDES));
        let outwards = Vec3::new(ring.cos(), 0.0, ring.sin());
        let normal = side.cos() * outwards + side.sin() * Vec3::Y;
        [outwards + 0.3 * normal, normal]
    };
    let vertices: Vec<[Vec3; 2]> = (0..RINGS * SIDES).map(vertex).collect();
    let quad = |n: u32| {
        let at = |ring: u32, side: u32| ring % RINGS * SIDES + side % SIDES;
        let (ring, side) = (n / SIDES, n % SIDES);
        let [a, b, c, d] = [at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)];
        [a, b, c, a, c, d]
    };
    let indices: Vec<u32> = (0..RINGS * SIDES).flat_map(quad).collect();
    let buffer = |label, contents, usage| {
        let usage = usage | BufferUsages::STORAGE;
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    };
    (
        buffer("vertices", lumivox::bytemuck::cast_slice(&vertices), BufferUsages::VERTEX),
        buffer("indices", lumivox::bytemuck::cast_slice(&indices), BufferUsages::INDEX),
    )
}
