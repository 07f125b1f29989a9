//! A scene as the GPU's voxelizer sees it: meshes in buffers, materials with their textures.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use anyhow::{Context, Result};
use lumivox::gpu::{Buffer, Gpu, Sampler, Texture, TextureOptions};
use lumivox::voxelize::{IndexView, Material, Mesh, MeshDescriptor, VertexView};
use lumivox::wgpu::{self, AddressMode, FilterMode, IndexFormat, VertexFormat};
use lumivox_scene::{Scene, Wrap};

use super::model::holes;
use super::texture::Sampler as Image;

/// Attributes of a mesh.
struct Buffers {
    positions: Buffer,
    normals: Buffer,
    indices: Buffer,
    uvs: Buffer,
    colors: Option<Buffer>,
}

/// What materials share.
struct Textures<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    /// One texel stands for all around it.
    is_nearest: bool,
    /// By number, and by whether holes lend colour.
    textures: HashMap<(usize, bool), Texture>,
    samplers: HashMap<[AddressMode; 2], Sampler>,
}

/// A mesh for each instance. Textures are left out if nothing is painted and nothing has holes.
pub(super) fn meshes(gpu: &Gpu, scene: &Scene, paints: bool, is_nearest: bool) -> Result<Vec<Mesh>> {
    let mut all = Textures { gpu, scene, is_nearest, textures: HashMap::new(), samplers: HashMap::new() };
    let mut buffers: HashMap<usize, Buffers> = HashMap::new();
    let mut meshes = Vec::with_capacity(scene.instances.len());
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        if mesh.indices.is_empty() || mesh.positions.is_empty() {
            continue;
        }
        let buffers = match buffers.entry(instance.mesh) {
            Entry::Occupied(made) => made.into_mut(),
            Entry::Vacant(place) => place.insert(Buffers::new(gpu, mesh)?),
        };
        let material = scene.materials.get(mesh.material).cloned().unwrap_or_default();
        let alpha_cutoff = scene.materials.get(mesh.material).and_then(|_| holes(scene, mesh.material));
        let is_seen = paints || alpha_cutoff.is_some();
        let base_color = material.base_color_texture.filter(|_| is_seen);
        let base_color = base_color.map(|n| (n, alpha_cutoff.is_some()));
        let emission = material.emission_texture.filter(|_| paints).map(|n| (n, false));
        for key in [base_color, emission].into_iter().flatten() {
            all.upload(key)?;
        }
        let wrap = base_color.or(emission).and_then(|(n, _)| scene.textures.get(n)).map(|t| t.wrap);
        let wrap = wrap.unwrap_or_default();
        all.make_sampler(wrap);
        let texture = |key: Option<(usize, bool)>| key.and_then(|key| all.textures.get(&key));
        let descriptor = MeshDescriptor {
            indices: Some(IndexView {
                buffer: &buffers.indices.raw,
                offset: 0,
                format: IndexFormat::Uint32,
                count: 3 * mesh.indices.len() as u32,
            }),
            normals: Some(view(&buffers.normals, VertexFormat::Float32x3)),
            uvs: Some(view(&buffers.uvs, VertexFormat::Float32x2)),
            colors: buffers.colors.as_ref().map(|colors| view(colors, VertexFormat::Float32x4)),
            world_from_local: instance.world_from_local,
            material: Material { base_color: material.base_color, emission: material.emission, alpha_cutoff },
            base_color_texture: texture(base_color),
            emission_texture: texture(emission),
            sampler: all.samplers.get(&wrap.map(address_mode)),
            ..MeshDescriptor::new(
                view(&buffers.positions, VertexFormat::Float32x3),
                mesh.positions.len() as u32,
            )
        };
        meshes.push(Mesh::new(gpu, &descriptor).with_context(|| format!("mesh {:?}", mesh.name))?);
    }
    Ok(meshes)
}

impl Buffers {
    fn new(gpu: &Gpu, mesh: &lumivox_scene::Mesh) -> Result<Self> {
        let is_tinted = mesh.colors.iter().any(|color| *color != [1.0; 4]);
        Ok(Self {
            positions: Buffer::storage_with(gpu, "the positions of a mesh", &mesh.positions)?,
            normals: Buffer::storage_with(gpu, "the normals of a mesh", &mesh.normals)?,
            indices: Buffer::storage_with(gpu, "the indices of a mesh", &mesh.indices)?,
            uvs: Buffer::storage_with(gpu, "the texture coordinates of a mesh", &mesh.uvs)?,
            colors: is_tinted
                .then(|| Buffer::storage_with(gpu, "the colours of a mesh", &mesh.colors))
                .transpose()?,
        })
    }
}

impl Textures<'_> {
    fn upload(&mut self, key: (usize, bool)) -> Result<()> {
        let (number, by_opacity) = key;
        let image = self.scene.textures.get(number).filter(|t| t.width > 0 && t.height > 0);
        let Some(image) = image.filter(|_| !self.textures.contains_key(&key)) else { return Ok(()) };
        let levels = Image::mip_levels(image, by_opacity, !self.is_nearest);
        let format =
            if image.srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm };
        let options = TextureOptions {
            size: [image.width, image.height],
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            mips: levels.len() as u32,
        };
        let texture = Texture::new(self.gpu, &image.name, options)?;
        for (mip_level, ([width, height], bytes)) in (0..).zip(&levels) {
            self.gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo { mip_level, ..texture.raw.as_image_copy() },
                bytes,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(4 * width),
                    rows_per_image: None,
                },
                wgpu::Extent3d { width: *width, height: *height, depth_or_array_layers: 1 },
            );
        }
        self.textures.insert(key, texture);
        Ok(())
    }

    fn make_sampler(&mut self, wrap: [Wrap; 2]) {
        let modes = wrap.map(address_mode);
        let filter = if self.is_nearest { FilterMode::Nearest } else { FilterMode::Linear };
        let descriptor = wgpu::SamplerDescriptor {
            label: Some("voxelize/sampler"),
            address_mode_u: modes[0],
            address_mode_v: modes[1],
            mag_filter: filter,
            min_filter: filter,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        };
        self.samplers.entry(modes).or_insert_with(|| Sampler::new(self.gpu, &descriptor));
    }
}

fn address_mode(wrap: Wrap) -> AddressMode {
    match wrap {
        Wrap::Repeat => AddressMode::Repeat,
        Wrap::Mirror => AddressMode::MirrorRepeat,
        Wrap::Clamp => AddressMode::ClampToEdge,
    }
}

fn view(buffer: &Buffer, format: VertexFormat) -> VertexView<'_> {
    VertexView { buffer: &buffer.raw, offset: 0, stride: format.size(), format }
}
