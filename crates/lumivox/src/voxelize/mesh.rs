//! Meshes whose buffers are on the GPU already.

use glam::{DMat3, Mat4, UVec4, Vec3, Vec4};

use super::VoxelizeError;
use super::views::{IndexView, VertexView, index_window, vertex_window};
use crate::gpu::{Buffer, Gpu, Sampler, Texture, Uniform};

/// Triangles of one dispatch: what a method's list of triangles for later must hold.
pub const BATCH_TRIANGLES: u32 = 1 << 17;

/// The numbers of a material. Textures and vertex colours multiply them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Linear albedo and opacity.
    pub base_color: Vec4,
    /// Emitted radiance in W/(m2 sr).
    pub emission: Vec3,
    /// Where the opacity is less than this, there is no surface: a triangle marks only cells in which it is at least
    /// this at the middle of its piece. One point stands for a cell, so that holes smaller than cells come and go, unless
    /// [`Options::see_through`](super::Options::see_through) asks for more.
    pub alpha_cutoff: Option<f32>,
}

impl Default for Material {
    /// White, opaque, dark.
    fn default() -> Self {
        Self { base_color: Vec4::ONE, emission: Vec3::ZERO, alpha_cutoff: None }
    }
}

/// What a [`Mesh`] is made of.
#[derive(Clone, Copy, Debug)]
pub struct MeshDescriptor<'a> {
    /// Positions in the mesh's own space; any soup. Triangles with an index out of range or a position that is not
    /// finite are skipped.
    pub positions: VertexView<'a>,
    /// Number of vertices.
    pub vertex_count: u32,
    /// Three to a triangle; without them three vertices in a row are one.
    pub indices: Option<IndexView<'a>>,
    /// Normals of any length; without them the faces' own.
    pub normals: Option<VertexView<'a>>,
    /// Texture coordinates.
    pub uvs: Option<VertexView<'a>>,
    /// Linear colour and opacity.
    pub colors: Option<VertexView<'a>>,
    /// The mesh's own space to the world.
    pub world_from_local: Mat4,
    /// The material's numbers.
    pub material: Material,
    /// Multiplies the base colour; in linear numbers, so of an `Srgb` format if it holds sRGB. Where it has mip levels, the
    /// one is read whose texels are as large as the piece of surface in the cell.
    pub base_color_texture: Option<&'a Texture>,
    /// Multiplies the emission.
    pub emission_texture: Option<&'a Texture>,
    /// How both are read; without it linearly, repeated. One without anisotropy: there are no pixels to take slopes from.
    pub sampler: Option<&'a Sampler>,
    /// What [`SurfaceFunction`](super::SurfaceFunction)s see as the mesh's number.
    pub number: u32,
}

impl<'a> MeshDescriptor<'a> {
    /// A white mesh of nothing but positions, where they stand.
    pub fn new(positions: VertexView<'a>, vertex_count: u32) -> Self {
        Self {
            positions,
            vertex_count,
            indices: None,
            normals: None,
            uvs: None,
            colors: None,
            world_from_local: Mat4::IDENTITY,
            material: Material::default(),
            base_color_texture: None,
            emission_texture: None,
            sampler: None,
            number: 0,
        }
    }
}

crate::gpu_struct! {
    /// A [`Mesh`] as shaders see it.
    pub struct MeshUniform {
        /// The mesh's own space to the world.
        pub world_from_local: Mat4,
        /// First column of the matrix that turns normals.
        pub normal_x: Vec3,
        /// -1 where the mesh is mirrored, so that its triangles turn the other way.
        pub side: f32,
        /// Second column.
        pub normal_y: Vec3,
        /// Less opaque is no surface; negative for none.
        pub alpha_cutoff: f32,
        /// Third column.
        pub normal_z: Vec3,
        /// Sum of `MESH_*`.
        pub flags: u32,
        /// Linear albedo and opacity.
        pub base_color: Vec4,
        /// Emitted radiance.
        pub emission: Vec3,
        /// The host's number of the mesh.
        pub number: u32,
        /// Vertices, triangles, bits of an index (0 for none), first index.
        pub counts: UVec4,
        /// Of positions: first word, words from one to the next, format code, 0.
        pub positions: UVec4,
        /// Of normals.
        pub normals: UVec4,
        /// Of texture coordinates.
        pub uvs: UVec4,
        /// Of colours.
        pub colors: UVec4,
    }
}

crate::gpu_struct! {
    /// Which triangles of a mesh one dispatch is about.
    pub struct BatchUniform {
        /// The first.
        pub first: u32,
        /// How many.
        pub count: u32,
    }
}

const HAS_NORMALS: u32 = 1;
const HAS_UVS: u32 = 2;
const HAS_COLORS: u32 = 4;
const HAS_TEXTURES: u32 = 8;

/// The flags by their names in WGSL.
pub(crate) const FLAGS: [(&str, u32); 4] = [
    ("MESH_HAS_NORMALS", HAS_NORMALS),
    ("MESH_HAS_UVS", HAS_UVS),
    ("MESH_HAS_COLORS", HAS_COLORS),
    ("MESH_HAS_TEXTURES", HAS_TEXTURES),
];

/// One placed mesh over buffers of the host's: made once, moved and repainted without allocation. A mesh that stands in
/// several places is several of these over the same buffers.
///
/// The buffers' contents may change from frame to frame, by the host's own writes and passes.
#[derive(Debug)]
pub struct Mesh {
    value: MeshUniform,
    capacity: u32,
    uniform: Uniform<MeshUniform>,
    batches: Vec<wgpu::BindGroup>,
}

impl Mesh {
    /// Looks the views over, and makes the bind groups for them.
    ///
    /// # Errors
    /// When a buffer cannot be bound as storage, an offset, a stride or a format does not fit, or there are fewer bytes than
    /// vertices or indices need. Of larger buffers than the device binds, what lies behind is not seen.
    pub fn new(gpu: &Gpu, descriptor: &MeshDescriptor<'_>) -> Result<Self, VoxelizeError> {
        let d = descriptor;
        let count = d.vertex_count;
        let vertices =
            |what, view: Option<VertexView<'_>>| -> Result<Option<(Buffer, UVec4)>, VoxelizeError> {
                view.map(|view| vertex_window(gpu, what, &view, count)).transpose()
            };
        let (positions, position_words) = vertex_window(gpu, "positions", &d.positions, count)?;
        let normals = vertices("normals", d.normals)?;
        let uvs = vertices("texture coordinates", d.uvs)?;
        let colors = vertices("colours", d.colors)?;
        let indices = d.indices.map(|view| index_window(gpu, &view)).transpose()?;
        let triangles = d.indices.map_or(count, |i| i.count) / 3;
        let (index_bits, first_index) = indices.as_ref().map_or((0, 0), |(_, bits, first)| (*bits, *first));
        let flag = |is: bool, flag: u32| if is { flag } else { 0 };
        let words = |view: &Option<(Buffer, UVec4)>| view.as_ref().map_or(UVec4::ZERO, |v| v.1);
        let mut value = MeshUniform {
            flags: flag(normals.is_some(), HAS_NORMALS)
                | flag(uvs.is_some(), HAS_UVS)
                | flag(colors.is_some(), HAS_COLORS)
                | flag(d.base_color_texture.or(d.emission_texture).is_some(), HAS_TEXTURES),
            number: d.number,
            counts: UVec4::new(count, triangles, index_bits, first_index),
            positions: position_words,
            normals: words(&normals),
            uvs: words(&uvs),
            colors: words(&colors),
            ..bytemuck::Zeroable::zeroed()
        };
        value.place(&d.world_from_local);
        value.paint(&d.material);
        let uniform = Uniform::new(gpu, "voxelize/mesh", &value);
        let (white, linear) = gpu.white()?;
        let [normals, uvs, colors] =
            [&normals, &uvs, &colors].map(|view| view.as_ref().map_or(&positions, |v| &v.0));
        let layout = super::text::mesh_layout(gpu)?;
        let batches = (0..triangles.div_ceil(BATCH_TRIANGLES)).map(|n| {
            let first = n * BATCH_TRIANGLES;
            let batch = BatchUniform { first, count: BATCH_TRIANGLES.min(triangles - first) };
            let batch = Uniform::new(gpu, "voxelize/batch", &batch);
            let view = |texture: Option<&'_ Texture>| texture.unwrap_or(white).view.clone();
            let (base_color, emission) = (view(d.base_color_texture), view(d.emission_texture));
            let resources = [
                uniform.binding(),
                batch.binding(),
                positions.binding(),
                indices.as_ref().map_or(&positions, |i| &i.0).binding(),
                normals.binding(),
                uvs.binding(),
                colors.binding(),
                wgpu::BindingResource::TextureView(&base_color),
                wgpu::BindingResource::TextureView(&emission),
                wgpu::BindingResource::Sampler(&d.sampler.unwrap_or(linear).raw),
            ];
            let entries: Vec<_> = (0..)
                .zip(resources)
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            crate::gpu::made_bind_group(gpu, "voxelize/mesh", &layout, &entries)
        });
        let batches = batches.collect::<Result<_, _>>()?;
        Ok(Self { value, capacity: triangles, uniform, batches })
    }

    /// Moves the mesh, from the next submission on.
    pub fn set_transform(&mut self, gpu: &Gpu, world_from_local: &Mat4) {
        self.value.place(world_from_local);
        self.uniform.write(gpu, &self.value);
    }

    /// Changes the material's numbers, from the next submission on.
    pub fn set_material(&mut self, gpu: &Gpu, material: &Material) {
        self.value.paint(material);
        self.uniform.write(gpu, &self.value);
    }

    /// Takes only the first so many triangles, at most those that it was made with, from the next submission on.
    pub fn set_triangle_count(&mut self, gpu: &Gpu, count: u32) {
        self.value.counts.y = count.min(self.capacity);
        self.uniform.write(gpu, &self.value);
    }

    /// Triangles that are looked at.
    pub fn triangle_count(&self) -> u32 {
        self.value.counts.y
    }

    /// Whether it has neither textures nor holes.
    pub(crate) fn is_plain(&self) -> bool {
        self.value.flags & HAS_TEXTURES == 0 && self.value.alpha_cutoff < 0.0
    }

    /// The bind groups (group 1) and numbers of triangles of the batches that cover the mesh.
    pub(crate) fn batches(&self) -> impl Iterator<Item = (&wgpu::BindGroup, u32)> {
        let count = self.triangle_count();
        self.batches.iter().enumerate().filter_map(move |(n, group)| {
            let left = count.saturating_sub(n as u32 * BATCH_TRIANGLES);
            (left > 0).then_some((group, left.min(BATCH_TRIANGLES)))
        })
    }
}

impl MeshUniform {
    fn place(&mut self, world_from_local: &Mat4) {
        let m = DMat3::from_mat4(world_from_local.as_dmat4());
        // Cofactors turn normals, and exist for flattening transforms too. A mirror turns them inside out.
        let cofactors =
            DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
        let largest = cofactors.to_cols_array().into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let side = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
        let turned = cofactors * (side / if largest > 0.0 { largest } else { 1.0 });
        self.world_from_local = *world_from_local;
        self.side = side as f32;
        self.normal_x = turned.x_axis.as_vec3();
        self.normal_y = turned.y_axis.as_vec3();
        self.normal_z = turned.z_axis.as_vec3();
    }

    fn paint(&mut self, material: &Material) {
        self.base_color = material.base_color;
        self.emission = material.emission;
        self.alpha_cutoff = material.alpha_cutoff.unwrap_or(-1.0);
    }
}
