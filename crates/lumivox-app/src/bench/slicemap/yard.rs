//! A yard of many casters, and the depth image of it.

use std::ops::Range;

use anyhow::Result;
use glam::{Mat4, UVec2, Vec3};
use lumivox::bytemuck;
use lumivox::core::{TriangleView, View};
use lumivox::gpu::{Gpu, Texture};
use lumivox::shadow_volumes::Topology;
use lumivox::voxelize::{IndexView, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{self, util::DeviceExt};

/// Metres from one caster to the next.
const STEP: f32 = 2.0;

/// A walled floor with posts, and balls over them; half of it under a roof.
pub(super) struct Yard {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
    /// Of each caster its triangles.
    parts: Vec<Range<usize>>,
    /// Half of its side in metres.
    pub(super) half: f32,
}

/// It on a device.
pub(super) struct Built {
    positions: wgpu::Buffer,
    indices: wgpu::Buffer,
    pub(super) meshes: Vec<Mesh>,
}

impl Yard {
    /// With `side` times `side` posts, and as many balls.
    pub(super) fn new(side: u32) -> Self {
        let half = 0.5 * STEP * side as f32 + 1.0;
        let mut yard = Self { positions: Vec::new(), indices: Vec::new(), parts: Vec::new(), half };
        yard.cuboid(Vec3::new(-half, -0.3, -half), Vec3::new(half, 0.0, half));
        yard.cuboid(Vec3::new(-half, 0.0, -half - 0.3), Vec3::new(half, 4.0, -half));
        yard.cuboid(Vec3::new(-half, 5.0, -half), Vec3::new(0.0, 5.2, half));
        // Places by the golden ratio: no pattern, and the same everywhere.
        let place = |n: u32, by: f32| (n as f32 * 0.618_034 + by).fract();
        for n in 0..side * side {
            let corner = STEP * Vec3::new((n % side) as f32, 0.0, (n / side) as f32)
                - (half - 1.0) * Vec3::new(1.0, 0.0, 1.0);
            let at = corner + Vec3::new(place(n, 0.1), 0.0, place(7 * n, 0.5));
            let (width, height) = (0.2 + 0.3 * place(3 * n, 0.0), 0.4 + 1.6 * place(5 * n, 0.3));
            yard.cuboid(at, at + Vec3::new(width, height, width));
            yard.ball(
                at + Vec3::new(0.4, height + 0.6 + place(11 * n, 0.0), 0.2),
                0.15 + 0.25 * place(13 * n, 0.0),
            );
        }
        yard
    }

    pub(super) fn casters(&self) -> usize {
        self.parts.len()
    }

    pub(super) fn triangles(&self) -> usize {
        self.indices.len()
    }

    pub(super) fn topologies(&self) -> Vec<Topology> {
        let of = |triangles: &Range<usize>| {
            let indices = &self.indices[triangles.clone()];
            Topology::new(&TriangleView { positions: &self.positions, indices })
        };
        self.parts.iter().map(of).collect()
    }

    pub(super) fn build(&self, gpu: &Gpu) -> Result<Built> {
        let buffer = |label, contents: &[u8], usage| {
            let usage = usage | wgpu::BufferUsages::STORAGE;
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        let positions =
            buffer("yard/positions", bytemuck::cast_slice(&self.positions), wgpu::BufferUsages::VERTEX);
        let indices = buffer("yard/indices", bytemuck::cast_slice(&self.indices), wgpu::BufferUsages::INDEX);
        let mesh = |triangles: &Range<usize>| {
            let format = wgpu::VertexFormat::Float32x3;
            let vertices = VertexView { buffer: &positions, offset: 0, stride: 12, format };
            let indices = IndexView {
                buffer: &indices,
                offset: 12 * triangles.start as u64,
                format: wgpu::IndexFormat::Uint32,
                count: 3 * triangles.len() as u32,
            };
            let described = MeshDescriptor::new(vertices, self.positions.len() as u32);
            Mesh::new(gpu, &MeshDescriptor { indices: Some(indices), ..described })
        };
        let meshes = self.parts.iter().map(mesh).collect::<Result<Vec<_>, _>>()?;
        Ok(Built { positions, indices, meshes })
    }

    fn cuboid(&mut self, low: Vec3, high: Vec3) {
        let corner = |n: u32| {
            let pick = |bit: u32, a: f32, b: f32| if n >> bit & 1 == 0 { a } else { b };
            [pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z)]
        };
        let faces: [[u32; 4]; 6] =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        self.part((0..8).map(corner), triangles);
    }

    /// Of 16 times 8 faces.
    fn ball(&mut self, center: Vec3, radius: f32) {
        const AROUND: u32 = 16;
        const DOWN: u32 = 8;
        let point = |n: u32| {
            let (row, column) = (n / AROUND, n % AROUND);
            let (down, around) = (
                std::f32::consts::PI * row as f32 / DOWN as f32,
                std::f32::consts::TAU * column as f32 / AROUND as f32,
            );
            let way = Vec3::new(down.sin() * around.cos(), down.cos(), down.sin() * around.sin());
            // All points of a pole are one, to the last bit.
            let way = if row % DOWN == 0 { down.cos().signum() * Vec3::Y } else { way };
            (center + radius * way).to_array()
        };
        let faces = (0..AROUND * DOWN).flat_map(|n| {
            let next = n / AROUND * AROUND + (n + 1) % AROUND;
            [[n, next, n + AROUND], [next, next + AROUND, n + AROUND]]
        });
        self.part((0..AROUND * (DOWN + 1)).map(point), faces);
    }

    fn part(&mut self, positions: impl Iterator<Item = [f32; 3]>, triangles: impl Iterator<Item = [u32; 3]>) {
        let (vertex, triangle) = (self.positions.len(), self.indices.len());
        self.positions.extend(positions);
        self.indices.extend(triangles.map(|t| t.map(|i| vertex as u32 + i)));
        self.parts.push(triangle..self.indices.len());
    }
}

impl Built {
    /// What a view sees, waited for.
    pub(super) fn depth(&self, gpu: &Gpu, view: &View, size: UVec2) -> Result<Texture> {
        let format = wgpu::TextureFormat::Depth32Float;
        let depth = Texture::target(gpu, "yard/depth", size.to_array(), format)?;
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("yard/depth"),
            source: wgpu::ShaderSource::Wgsl(include_str!("yard.wgsl").into()),
        });
        let attributes = wgpu::vertex_attr_array![0 => Float32x3];
        let vertices = wgpu::VertexBufferLayout {
            array_stride: 12,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        };
        let compare =
            if view.reversed_depth { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("yard/depth"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex_main"),
                compilation_options: Default::default(),
                buffers: &[Some(vertices)],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        let matrix: Mat4 = view.clip_from_world;
        let uniform = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("yard/view"),
            contents: bytemuck::bytes_of(&matrix),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("yard/view"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let far = if view.reversed_depth { 0.0 } else { 1.0 };
        let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(far), store: wgpu::StoreOp::Store };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("yard/depth"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth.view,
                depth_ops: Some(ops),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..(self.indices.size() / 4) as u32, 0, 0..1);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        Ok(depth)
    }
}
