//! Meshes made by code, and their way to the device.

use lumivox::core::{Grid, TriangleView};
use lumivox::glam::{UVec3, Vec3};
use lumivox::gpu::Gpu;
use lumivox::voxelize::{IndexView, Mesh, MeshDescriptor, VertexView, VoxelizeError};
use lumivox::wgpu;

use crate::support::Random;

/// A mesh that owns its arrays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soup {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Soup {
    pub(crate) fn of(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let mut soup = Self::default();
        for triangle in triangles {
            let n = soup.positions.len() as u32;
            soup.positions.extend(triangle.map(|p| p.to_array()));
            soup.indices.push([n, n + 1, n + 2]);
        }
        soup
    }

    pub(crate) fn view(&self) -> TriangleView<'_> {
        TriangleView { positions: &self.positions, indices: &self.indices }
    }

    /// Uploads the mesh as a host would have it, and describes it to `make`.
    pub(crate) fn described<R>(&self, gpu: &Gpu, make: impl FnOnce(MeshDescriptor<'_>) -> R) -> R {
        let positions = buffer(gpu, &self.positions);
        let indices = buffer(gpu, &self.indices);
        let view =
            VertexView { buffer: &positions, offset: 0, stride: 12, format: wgpu::VertexFormat::Float32x3 };
        let indices = IndexView {
            buffer: &indices,
            offset: 0,
            format: wgpu::IndexFormat::Uint32,
            count: 3 * self.indices.len() as u32,
        };
        make(MeshDescriptor {
            indices: Some(indices),
            ..MeshDescriptor::new(view, self.positions.len() as u32)
        })
    }

    pub(crate) fn mesh(&self, gpu: &Gpu) -> Result<Mesh, VoxelizeError> {
        self.described(gpu, |d| Mesh::new(gpu, &d))
    }
}

/// A storage buffer of a host's.
pub(crate) fn buffer<T: lumivox::bytemuck::NoUninit>(gpu: &Gpu, data: &[T]) -> wgpu::Buffer {
    let bytes: &[u8] = lumivox::bytemuck::cast_slice(data);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("host"),
        size: (bytes.len() as u64).next_multiple_of(4).max(16),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut padded = bytes.to_vec();
    padded.resize(bytes.len().next_multiple_of(4), 0);
    gpu.queue.write_buffer(&buffer, 0, &padded);
    buffer
}

/// A closed sphere of `8 * 4^level` triangles around a point.
pub(crate) fn sphere(center: Vec3, radius: f32, level: u32) -> Soup {
    let mut triangles: Vec<[Vec3; 3]> = Vec::new();
    for octant in 0..8 {
        let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let [x, y, z] = [sign(0) * Vec3::X, sign(1) * Vec3::Y, sign(2) * Vec3::Z];
        triangles.push(if sign(0) * sign(1) * sign(2) > 0.0 { [x, y, z] } else { [x, z, y] });
    }
    for _ in 0..level {
        let split = |[a, b, c]: [Vec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize_or_zero);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    Soup::of(triangles.into_iter().map(|t| t.map(|p| center + radius * p)))
}

/// A closed box between two corners, 12 triangles, faces outwards.
pub(crate) fn cuboid(low: Vec3, high: Vec3) -> Soup {
    let corner = |n: u32| {
        let pick = |bit: u32, a: f32, b: f32| if n >> bit & 1 == 0 { a } else { b };
        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Soup::of(faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner)))
}

/// Triangles without pattern in a cube of `side`, and around it.
pub(crate) fn scattered(seed: u64, count: u32, size: f32, side: f32) -> Soup {
    let mut random = Random::new(seed);
    Soup::of((0..count).map(|_| {
        let center = (side + 2.0) * random.cube() - 1.0;
        [0; 3].map(|_| center + size * (random.cube() - 0.5))
    }))
}

/// A grid of unit cells at the origin.
pub(crate) fn unit_grid(x: u32, y: u32, z: u32) -> Grid {
    Grid { origin: Vec3::ZERO, cell_size: 1.0, dims: UVec3::new(x, y, z) }
}
