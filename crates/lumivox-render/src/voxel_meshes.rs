//! A scene's buffers as the voxelizer of triangles sees them.

use lumivox::gpu::{Buffer, Gpu};
use lumivox::voxelize::{self, IndexView, Mesh, MeshDescriptor, VertexView, VoxelizeError};
use lumivox::wgpu::{IndexFormat, VertexFormat};
use lumivox_scene::Scene;

use crate::gpu_scene::{GpuMaterial, GpuScene, MaterialUniform, MeshRange, VertexPaint, VertexShape};
use crate::material_textures::MaterialTextures;

const SHAPE_BYTES: u64 = size_of::<VertexShape>() as u64;
const PAINT_BYTES: u64 = size_of::<VertexPaint>() as u64;

impl GpuScene {
    /// Every instance for the voxelizer of triangles, those of the scene first. `scenes` are those that this was made of, the
    /// textures those of the first.
    pub(crate) fn voxel_meshes(
        &self,
        gpu: &Gpu,
        scenes: [&Scene; 2],
        textures: &MaterialTextures,
    ) -> Result<Vec<Mesh>, VoxelizeError> {
        let (mut first_mesh, mut first_material) = (0, 0);
        let mut meshes = Vec::new();
        for scene in scenes {
            for instance in &scene.instances {
                let material = &self.materials[first_material + scene.meshes[instance.mesh].material];
                let range = &self.ranges[first_mesh + instance.mesh];
                let descriptor = self.described(range, material, textures);
                let number = meshes.len() as u32;
                let placed =
                    MeshDescriptor { world_from_local: instance.world_from_local, number, ..descriptor };
                meshes.push(Mesh::new(gpu, &placed)?);
            }
            first_mesh += scene.meshes.len();
            first_material += scene.materials.len();
        }
        Ok(meshes)
    }

    fn described<'a>(
        &'a self,
        range: &MeshRange,
        material: &GpuMaterial,
        textures: &'a MaterialTextures,
    ) -> MeshDescriptor<'a> {
        let view = |buffer: &'a Buffer, stride: u64, at: u64, format| VertexView {
            buffer: &buffer.raw,
            offset: range.first_vertex * stride + at,
            stride,
            format,
        };
        let shape = |at, format| view(&self.shapes, SHAPE_BYTES, at, format);
        let paint = |at, format| view(&self.paints, PAINT_BYTES, at, format);
        let texture = |number: Option<usize>| number.map(|_| textures.texture(number));
        let MaterialUniform { base_color, emission, alpha_cutoff, .. } = material.value;
        MeshDescriptor {
            indices: Some(IndexView {
                buffer: &self.indices.raw,
                offset: 4 * range.first_index,
                format: IndexFormat::Uint32,
                count: range.index_count,
            }),
            normals: Some(shape(12, VertexFormat::Float32x3)),
            uvs: Some(paint(0, VertexFormat::Float32x2)),
            colors: Some(paint(8, VertexFormat::Unorm8x4)),
            material: voxelize::Material {
                base_color,
                emission,
                alpha_cutoff: (alpha_cutoff >= 0.0).then_some(alpha_cutoff),
            },
            base_color_texture: texture(material.base_color_texture),
            emission_texture: texture(material.emission_texture),
            sampler: Some(textures.volume_sampler(material.wrap)),
            ..MeshDescriptor::new(shape(0, VertexFormat::Float32x3), range.vertex_count)
        }
    }
}
