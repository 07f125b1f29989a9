//! A scene on the GPU: one vertex and one index buffer for all meshes, a bind group per material, a matrix per instance.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};
use lumivox::gpu::{Bindings, Buffer, Gpu, GpuError, Program, Uniform};
use lumivox_scene::{AlphaMode, Material, Pose, Scene, Wrap};

use crate::material_textures::MaterialTextures;

/// What moves of a vertex: 24 bytes, in a buffer of its own.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct VertexShape {
    position: [f32; 3],
    normal: [f32; 3],
}

/// What stays of it: 12 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct VertexPaint {
    uv: [f32; 2],
    color: [u8; 4],
}

const SHAPE_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
const PAINT_ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![2 => Float32x2, 3 => Unorm8x4];

/// The layouts of [`GpuScene::shapes`] and [`GpuScene::paints`].
pub const VERTEX_BUFFERS: [Option<wgpu::VertexBufferLayout<'_>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<VertexShape>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &SHAPE_ATTRIBUTES,
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<VertexPaint>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &PAINT_ATTRIBUTES,
    }),
];

use lumivox::wgpu;

/// Triangles are drawn, and read by shaders that make volumes of them.
const VERTICES: wgpu::BufferUsages = wgpu::BufferUsages::VERTEX.union(wgpu::BufferUsages::STORAGE);
const INDICES: wgpu::BufferUsages = wgpu::BufferUsages::INDEX.union(wgpu::BufferUsages::STORAGE);

lumivox::gpu_struct! {
    /// A material as shaders see it.
    pub struct MaterialUniform {
        /// Linear albedo and opacity.
        pub base_color: Vec4,
        /// Emitted radiance.
        pub emission: Vec3,
        /// Surfaces less opaque than this are holes; negative for none.
        pub alpha_cutoff: f32,
        /// 1 where texels are still encoded in sRGB; for lookups at a point alone.
        pub decodes_base_color: u32,
        /// The same of the emission's.
        pub decodes_emission: u32,
        /// Unused.
        pub reserved_0: u32,
        /// Unused.
        pub reserved_1: u32,
    }
}

/// One indexed draw: a mesh at a place.
#[derive(Clone, Copy, Debug)]
pub struct Draw {
    /// Range in the index buffer.
    pub indices: (u32, u32),
    /// Added to every index.
    pub base_vertex: i32,
    /// Index of the instance's matrix.
    pub instance: u32,
    /// Index of the material.
    pub material: usize,
    /// Whether the material may have holes, or lets a part of the light through.
    pub is_masked: bool,
    /// Whether the camera sees it; lights always do.
    pub in_camera: bool,
    /// Whether it is an object with a visibility field.
    pub is_caster: bool,
}

/// What is drawn.
#[derive(Debug)]
pub struct GpuScene {
    /// An array of [`VertexShape`].
    pub shapes: Buffer,
    /// An array of [`VertexPaint`].
    pub paints: Buffer,
    /// All indices, 32 bit.
    pub indices: Buffer,
    /// A matrix `world_from_local` per instance.
    pub instances: Buffer,
    /// Sorted by material.
    pub draws: Vec<Draw>,
    first_panel: u64,
    pub(crate) ranges: Vec<MeshRange>,
    pub(crate) materials: Vec<GpuMaterial>,
}

/// Where a mesh lies in the buffers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshRange {
    pub(crate) first_vertex: u64,
    pub(crate) vertex_count: u32,
    pub(crate) first_index: u64,
    pub(crate) index_count: u32,
}

#[derive(Debug)]
pub(crate) struct GpuMaterial {
    pub(crate) value: MaterialUniform,
    uniform: Uniform<MaterialUniform>,
    pub(crate) base_color_texture: Option<usize>,
    pub(crate) emission_texture: Option<usize>,
    pub(crate) wrap: [Wrap; 2],
}

impl GpuScene {
    /// Uploads a scene, and `panels`, a second one that only lights see. Textures are filtered over the area of a pixel or
    /// looked up at a point ([`MaterialTextures`]).
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        panels: &Scene,
        filtered: bool,
    ) -> Result<(Self, MaterialTextures), GpuError> {
        let mut geometry = Geometry::default();
        geometry.append(scene, true);
        geometry.append(panels, false);
        geometry.draws.sort_by_key(|d| d.material);

        let textures = MaterialTextures::new(gpu, scene, filtered)?;
        let materials = scene.materials.iter().chain(&panels.materials);
        let materials = materials.map(|m| GpuMaterial::new(gpu, m, scene)).collect();
        let gpu_scene = Self {
            shapes: filled(gpu, "scene/shapes", VERTICES, &geometry.shapes),
            paints: filled(gpu, "scene/paints", VERTICES, &geometry.paints),
            indices: filled(gpu, "scene/indices", INDICES, &geometry.indices),
            instances: Buffer::storage_with(gpu, "scene/instances", &geometry.matrices)?,
            draws: geometry.draws,
            first_panel: scene.instances.len() as u64,
            ranges: geometry.ranges,
            materials,
        };
        Ok((gpu_scene, textures))
    }

    /// Says which of the scene's instances are objects with visibility fields.
    pub(crate) fn set_casters(&mut self, instances: impl Iterator<Item = usize>) {
        for instance in instances {
            let draws = self.draws.iter_mut().filter(|d| d.in_camera && d.instance as usize == instance);
            draws.for_each(|draw| draw.is_caster = true);
        }
    }

    /// Moves the scene, from the next submission on; for a pose of the scene that this was made of.
    pub fn set_pose(&self, gpu: &Gpu, pose: &Pose) {
        let count = pose.world_from_local.len().min(self.first_panel as usize);
        let matrices = &pose.world_from_local[..count];
        gpu.queue.write_buffer(&self.instances.raw, 0, bytemuck::cast_slice(matrices));
        for mesh in &pose.deformed {
            let Some(range) = self.ranges.get(mesh.mesh) else { continue };
            let moved: Vec<VertexShape> = shapes(&mesh.positions, &mesh.normals).collect();
            let offset = range.first_vertex * size_of::<VertexShape>() as u64;
            gpu.queue.write_buffer(&self.shapes.raw, offset, bytemuck::cast_slice(&moved));
        }
    }

    /// Moves what only lights see: as many instances as before.
    pub fn set_panels(&self, gpu: &Gpu, panels: &Scene) {
        let matrices: Vec<Mat4> = panels.instances.iter().map(|i| i.world_from_local).collect();
        let offset = self.first_panel * size_of::<Mat4>() as u64;
        gpu.queue.write_buffer(&self.instances.raw, offset, bytemuck::cast_slice(&matrices));
    }

    /// The bind group of every material for group 1 of a surface program.
    pub fn bind_materials(
        &self,
        gpu: &Gpu,
        shared: &MaterialTextures,
        program: &Program,
    ) -> Result<Vec<wgpu::BindGroup>, GpuError> {
        let bind = |m: &GpuMaterial| {
            let bindings = Bindings::new()
                .read("material", &m.uniform)
                .read("base_color_texture", shared.texture(m.base_color_texture))
                .read("emission_texture", shared.texture(m.emission_texture))
                .read("material_sampler", shared.sampler(m.wrap));
            program.bind(gpu, 1, &bindings)
        };
        self.materials.iter().map(bind).collect()
    }
}

/// What goes into the buffers.
#[derive(Default)]
struct Geometry {
    shapes: Vec<VertexShape>,
    paints: Vec<VertexPaint>,
    ranges: Vec<MeshRange>,
    indices: Vec<u32>,
    matrices: Vec<Mat4>,
    draws: Vec<Draw>,
    material_count: usize,
}

impl Geometry {
    fn append(&mut self, scene: &Scene, in_camera: bool) {
        let first_mesh = self.ranges.len();
        for mesh in &scene.meshes {
            self.ranges.push(MeshRange {
                first_vertex: self.shapes.len() as u64,
                vertex_count: mesh.positions.len() as u32,
                first_index: self.indices.len() as u64,
                index_count: 3 * mesh.indices.len() as u32,
            });
            self.indices.extend(mesh.indices.iter().flatten());
            self.shapes.extend(shapes(&mesh.positions, &mesh.normals));
            self.paints.extend(mesh.uvs.iter().zip(&mesh.colors).map(|(&uv, color)| VertexPaint {
                uv,
                color: color.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8),
            }));
        }
        for instance in &scene.instances {
            let material = scene.meshes[instance.mesh].material;
            let range = self.ranges[first_mesh + instance.mesh];
            let first_index = range.first_index as u32;
            self.draws.push(Draw {
                indices: (first_index, first_index + range.index_count),
                base_vertex: range.first_vertex as i32,
                instance: self.matrices.len() as u32,
                material: self.material_count + material,
                is_masked: is_thin(&scene.materials[material]),
                in_camera,
                is_caster: false,
            });
            self.matrices.push(instance.world_from_local);
        }
        self.material_count += scene.materials.len();
    }
}

/// Whether a material may have holes, or lets a part of the light through.
pub(crate) fn is_thin(material: &Material) -> bool {
    material.alpha != AlphaMode::Opaque || material.absorber.is_some()
}

fn shapes(positions: &[[f32; 3]], normals: &[[f32; 3]]) -> impl Iterator<Item = VertexShape> {
    positions.iter().zip(normals).map(|(&position, &normal)| VertexShape { position, normal })
}

impl GpuMaterial {
    fn new(gpu: &Gpu, material: &Material, scene: &Scene) -> Self {
        let alpha_cutoff = match material.alpha {
            AlphaMode::Opaque => -1.0,
            AlphaMode::Mask { cutoff } => cutoff,
            AlphaMode::Blend => 0.5,
        };
        let is_srgb = |texture: Option<usize>| u32::from(texture.is_some_and(|t| scene.textures[t].srgb));
        let [base_color_texture, emission_texture] = [material.base_color_texture, material.emission_texture];
        let value = MaterialUniform {
            base_color: material.base_color,
            emission: material.emission,
            alpha_cutoff,
            decodes_base_color: is_srgb(base_color_texture),
            decodes_emission: is_srgb(emission_texture),
            reserved_0: 0,
            reserved_1: 0,
        };
        let wrap = base_color_texture.or(emission_texture).map(|t| scene.textures[t].wrap);
        Self {
            value,
            uniform: Uniform::new(gpu, "scene/material", &value),
            base_color_texture,
            emission_texture,
            wrap: wrap.unwrap_or([Wrap::Repeat; 2]),
        }
    }
}

fn filled<T: Pod>(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, values: &[T]) -> Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    let buffer = Buffer::with_usage(gpu, label, bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
    gpu.queue.write_buffer(&buffer.raw, 0, bytes);
    buffer
}
