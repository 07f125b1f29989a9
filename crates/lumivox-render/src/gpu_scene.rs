//! A scene on the GPU: one vertex and one index buffer for all meshes, a bind group per material, a matrix per instance.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};
use lumivox::gpu::{Bindings, Buffer, Gpu, GpuError, Program, Sampler, Texture, TextureOptions, Uniform};
use lumivox_scene::{AlphaMode, Material, Pose, Scene, Texture as Image, Wrap};

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

lumivox::gpu_struct! {
    /// A material as shaders see it.
    pub struct MaterialUniform {
        /// Linear albedo and opacity.
        pub base_color: Vec4,
        /// Emitted radiance.
        pub emission: Vec3,
        /// Surfaces less opaque than this are holes; negative for none.
        pub alpha_cutoff: f32,
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
    /// Whether the material may have holes.
    pub is_masked: bool,
    /// Whether the camera sees it; lights always do.
    pub in_camera: bool,
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
    first_vertices: Vec<u64>,
    materials: Vec<GpuMaterial>,
}

#[derive(Debug)]
struct GpuMaterial {
    uniform: Uniform<MaterialUniform>,
    base_color: usize,
    emission: usize,
    sampler: usize,
}

/// The textures and samplers that materials share.
#[derive(Debug)]
pub struct MaterialTextures {
    textures: Vec<Texture>,
    samplers: Vec<Sampler>,
}

impl GpuScene {
    /// Uploads a scene, and `panels`, a second one that only lights see. Textures get a full chain of mip levels, averaged in
    /// linear light; without `filtered` only the finest is looked up.
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

        let mut textures = vec![upload_texture(gpu, &white(), false)?];
        for (n, image) in scene.textures.iter().enumerate() {
            let masks = scene
                .materials
                .iter()
                .any(|m| m.alpha != AlphaMode::Opaque && m.base_color_texture == Some(n));
            textures.push(upload_texture(gpu, image, masks)?);
        }
        let samplers = WRAPS.iter().map(|wrap| sampler(gpu, *wrap, filtered)).collect();
        let materials = scene.materials.iter().chain(&panels.materials);
        let materials = materials.map(|m| GpuMaterial::new(gpu, m, scene)).collect();
        let gpu_scene = Self {
            shapes: filled(gpu, "scene/shapes", wgpu::BufferUsages::VERTEX, &geometry.shapes),
            paints: filled(gpu, "scene/paints", wgpu::BufferUsages::VERTEX, &geometry.paints),
            indices: filled(gpu, "scene/indices", wgpu::BufferUsages::INDEX, &geometry.indices),
            instances: Buffer::storage_with(gpu, "scene/instances", &geometry.matrices)?,
            draws: geometry.draws,
            first_panel: scene.instances.len() as u64,
            first_vertices: geometry.first_vertices,
            materials,
        };
        Ok((gpu_scene, MaterialTextures { textures, samplers }))
    }

    /// Moves the scene, from the next submission on; for a pose of the scene that this was made of.
    pub fn set_pose(&self, gpu: &Gpu, pose: &Pose) {
        let count = pose.world_from_local.len().min(self.first_panel as usize);
        let matrices = &pose.world_from_local[..count];
        gpu.queue.write_buffer(&self.instances.raw, 0, bytemuck::cast_slice(matrices));
        for mesh in &pose.deformed {
            let Some(first) = self.first_vertices.get(mesh.mesh) else { continue };
            let moved: Vec<VertexShape> = shapes(&mesh.positions, &mesh.normals).collect();
            let offset = first * size_of::<VertexShape>() as u64;
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
                .read("base_color_texture", &shared.textures[m.base_color])
                .read("emission_texture", &shared.textures[m.emission])
                .read("material_sampler", &shared.samplers[m.sampler]);
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
    /// First vertex of each mesh.
    first_vertices: Vec<u64>,
    indices: Vec<u32>,
    matrices: Vec<Mat4>,
    draws: Vec<Draw>,
    material_count: usize,
}

impl Geometry {
    fn append(&mut self, scene: &Scene, in_camera: bool) {
        let mut ranges = Vec::new();
        for mesh in &scene.meshes {
            let first = self.indices.len() as u32;
            self.indices.extend(mesh.indices.iter().flatten());
            ranges.push(((first, self.indices.len() as u32), self.shapes.len() as i32));
            self.first_vertices.push(self.shapes.len() as u64);
            self.shapes.extend(shapes(&mesh.positions, &mesh.normals));
            self.paints.extend(mesh.uvs.iter().zip(&mesh.colors).map(|(&uv, color)| VertexPaint {
                uv,
                color: color.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8),
            }));
        }
        for instance in &scene.instances {
            let material = scene.meshes[instance.mesh].material;
            self.draws.push(Draw {
                indices: ranges[instance.mesh].0,
                base_vertex: ranges[instance.mesh].1,
                instance: self.matrices.len() as u32,
                material: self.material_count + material,
                is_masked: scene.materials[material].alpha != AlphaMode::Opaque,
                in_camera,
            });
            self.matrices.push(instance.world_from_local);
        }
        self.material_count += scene.materials.len();
    }
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
        let value =
            MaterialUniform { base_color: material.base_color, emission: material.emission, alpha_cutoff };
        // Texture 0 is white; the scene's follow.
        let slot = |texture: Option<usize>| texture.map_or(0, |t| t + 1);
        let wrap = material.base_color_texture.or(material.emission_texture).map(|t| scene.textures[t].wrap);
        let wanted = wrap.unwrap_or([Wrap::Repeat; 2]);
        Self {
            uniform: Uniform::new(gpu, "scene/material", &value),
            base_color: slot(material.base_color_texture),
            emission: slot(material.emission_texture),
            sampler: WRAPS.iter().position(|w| *w == wanted).unwrap_or(0),
        }
    }
}

const WRAPS: [[Wrap; 2]; 9] = {
    let kinds = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let mut wraps = [[Wrap::Repeat; 2]; 9];
    let mut n = 0;
    while n < 9 {
        wraps[n] = [kinds[n % 3], kinds[n / 3]];
        n += 1;
    }
    wraps
};

fn sampler(gpu: &Gpu, wrap: [Wrap; 2], filtered: bool) -> Sampler {
    let mode = |wrap: Wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    Sampler::new(
        gpu,
        &wgpu::SamplerDescriptor {
            label: Some("scene/sampler"),
            address_mode_u: mode(wrap[0]),
            address_mode_v: mode(wrap[1]),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            // Floors seen at a grazing angle keep their tiles.
            anisotropy_clamp: if filtered { 8 } else { 1 },
            lod_max_clamp: if filtered { 32.0 } else { 0.0 },
            ..Default::default()
        },
    )
}

fn filled<T: Pod>(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, values: &[T]) -> Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    let buffer = Buffer::with_usage(gpu, label, bytes.len() as u64, usage | wgpu::BufferUsages::COPY_DST);
    gpu.queue.write_buffer(&buffer.raw, 0, bytes);
    buffer
}

fn white() -> Image {
    Image {
        name: "white".to_owned(),
        width: 1,
        height: 1,
        srgb: false,
        pixels: vec![255; 4],
        wrap: [Wrap::Repeat; 2],
    }
}

/// `masks`: texels that are holes have no colour to mix in.
fn upload_texture(gpu: &Gpu, image: &Image, masks: bool) -> Result<Texture, GpuError> {
    let format =
        if image.srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm };
    let size = [image.width, image.height];
    let mips = image.width.max(image.height).max(1).ilog2() + 1;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = Texture::new(gpu, &image.name, TextureOptions { size, format, usage, mips })?;
    let mut level = (size, image.pixels.clone());
    for mip_level in 0..mips {
        let ([width, height], pixels) = &level;
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level, ..texture.raw.as_image_copy() },
            pixels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
            wgpu::Extent3d { width: *width, height: *height, depth_or_array_layers: 1 },
        );
        level = halved(&level.1, level.0, image.srgb, masks);
    }
    Ok(texture)
}

/// The next mip level: means of 2 x 2 texels, taken in linear light; of colours, weighted by opacity if the texture masks.
fn halved(pixels: &[u8], [width, height]: [u32; 2], srgb: bool, masks: bool) -> ([u32; 2], Vec<u8>) {
    const CORNERS: [[u32; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];
    let half = [(width / 2).max(1), (height / 2).max(1)];
    let mut out = Vec::with_capacity((4 * half[0] * half[1]) as usize);
    for y in 0..half[1] {
        for x in 0..half[0] {
            let texels = CORNERS.map(|[dx, dy]| {
                let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                let at = (4 * (y * width + x)) as usize;
                let value = |c: usize| f32::from(pixels[at + c]) / 255.0;
                let color = |c: usize| if srgb { value(c).powf(2.2) } else { value(c) };
                [color(0), color(1), color(2), value(3)]
            });
            let opacity: f32 = texels.iter().map(|t| t[3]).sum();
            for c in 0..4 {
                let weight =
                    |t: &[f32; 4]| if masks && c < 3 && opacity > 0.0 { t[3] / opacity } else { 0.25 };
                let mean: f32 = texels.iter().map(|t| weight(t) * t[c]).sum();
                let value = if srgb && c < 3 { mean.powf(1.0 / 2.2) } else { mean };
                out.push((255.0 * value + 0.5) as u8);
            }
        }
    }
    (half, out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_lend_no_colour_to_what_is_around_them() {
        let leaf_and_holes = [80, 160, 40, 255, 0, 0, 0, 0, 255, 0, 255, 0, 0, 0, 0, 0];
        let (size, mixed) = halved(&leaf_and_holes, [2, 2], false, true);
        assert_eq!((size, mixed.as_slice()), ([1, 1], [80, 160, 40, 64].as_slice()));
        let (_, plain) = halved(&leaf_and_holes, [2, 2], false, false);
        assert_eq!(plain, [84, 40, 74, 64]);
        let (_, nothing) = halved(&[9, 9, 9, 0].repeat(4), [2, 2], true, true);
        assert_eq!(nothing, [9, 9, 9, 0]);
    }
}
