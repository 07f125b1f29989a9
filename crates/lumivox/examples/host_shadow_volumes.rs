//! Sharp shadows in a host: what it has to do to have a mask for its sun from its own depth image and meshes.
//!
//! The host's own depth image is that of a floor. `cargo run -p lumivox --example host_shadow_volumes` records three frames, and says how
//! much of the floor the cubes above it shade.

mod floor;

use half::f16;
use lumivox::core::{TriangleView, View};
use lumivox::glam::{Mat4, UVec2, Vec2, Vec3};
use lumivox::gpu::{AdapterChoice, Gpu, Tier, read_texture};
use lumivox::shadow_volumes::{CullSettings, ShadowVolumes, Topology, VolumeLight, VolumeSettings};
use lumivox::voxelize::{IndexView, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{self, util::DeviceExt};

use floor::Floor;

const SIZE: UVec2 = UVec2::new(320, 180);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A host gives its own device: `Gpu::from_device(device, queue, Tier::Core)`.
    let gpu = Gpu::new_blocking(&AdapterChoice::default(), Tier::Core)?;
    let view =
        View::perspective(Vec3::new(12.0, 6.0, 20.0), Vec3::X * 12.0, Vec3::Y, 1.0, 16.0 / 9.0, 0.1, 100.0);
    let floor = Floor::new(&gpu, &view, SIZE)?;

    // Made once: which triangles share which edges, from the mesh as it was loaded. Eight cubes have one of it.
    let topology = Topology::new(&TriangleView { positions: &POSITIONS, indices: &INDICES });
    // The host's own buffers; only the usage `STORAGE` may be new to it.
    let positions = buffer(&gpu, lumivox::bytemuck::cast_slice(&POSITIONS));
    let indices = buffer(&gpu, lumivox::bytemuck::cast_slice(&INDICES));
    let mut cubes = (0..8).map(|_| cube(&gpu, &positions, &indices)).collect::<Result<Vec<_>, _>>()?;
    let settings =
        VolumeSettings { size: SIZE, culling: Some(CullSettings::default()), ..Default::default() };
    let mut shadows = ShadowVolumes::new(&gpu, &[&topology; 8], 1, settings)?;

    for frame in 0..3 {
        // What a frame writes before it is recorded: where everything stands, and what the sun shines on.
        for (n, cube) in cubes.iter_mut().enumerate() {
            let place = Vec3::new(3.0 * n as f32, 2.0, 0.1 * frame as f32);
            cube.set_transform(&gpu, &Mat4::from_translation(place));
        }
        let direction = Vec3::new(0.3, -1.0, 0.2).normalize_or_zero();
        let sunlit =
            View::orthographic_along(-60.0 * direction, direction, Vec3::Z, Vec2::splat(80.0), 120.0);
        shadows.update(&gpu, &view, &[(VolumeLight::Directional { direction }, &[sunlit])]);

        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // Here the host draws its depth image ...
        shadows.record(&gpu, &mut encoder, &floor.depth, &cubes.iter().collect::<Vec<_>>())?;
        // ... and here it multiplies its sun's light by `shadows.mask(0)`.
        gpu.queue.submit([encoder.finish()]);
    }
    let mask: Vec<f16> = read_texture(&gpu, shadows.mask(0).ok_or("there is one light")?)?;
    let of_floor: Vec<f16> =
        mask.into_iter().zip(&floor.is_floor).filter(|(_, is_floor)| **is_floor).map(|(m, _)| m).collect();
    let shaded = of_floor.iter().filter(|m| **m == f16::ZERO).count() as f32 / of_floor.len() as f32;
    eprintln!("{:.1} % of the floor lie in shadow", 100.0 * shaded);
    Ok(())
}

fn cube(
    gpu: &Gpu,
    positions: &wgpu::Buffer,
    indices: &wgpu::Buffer,
) -> Result<Mesh, lumivox::voxelize::VoxelizeError> {
    let positions =
        VertexView { buffer: positions, offset: 0, stride: 12, format: wgpu::VertexFormat::Float32x3 };
    let indices = IndexView { buffer: indices, offset: 0, format: wgpu::IndexFormat::Uint32, count: 36 };
    Mesh::new(gpu, &MeshDescriptor { indices: Some(indices), ..MeshDescriptor::new(positions, 8) })
}

fn buffer(gpu: &Gpu, contents: &[u8]) -> wgpu::Buffer {
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("host"),
        contents,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::INDEX,
    })
}

/// A cube of 2 m.
const POSITIONS: [[f32; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];

const INDICES: [[u32; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];
