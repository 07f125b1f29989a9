//! A scene as the voxelizer sees it: borrowed meshes where they stand, and materials with their textures.

use std::collections::HashMap;
use std::sync::Arc;

use glam::Vec2;
use lumivox_core::TriangleView;
use lumivox_scene::{AlphaMode, Scene};
use lumivox_voxels::{Material, MaterialOf, MeshView, Model, TextureFn};

use super::texture::Sampler;

/// Blended surfaces count as soon as anything of them is seen.
const SEEN: f32 = 0.5 / 255.0;

type Lookup<'a> = Box<TextureFn<'a>>;

/// Textures of one material, and where it has holes.
struct Looks<'a> {
    base_color: Option<Lookup<'a>>,
    emission: Option<Lookup<'a>>,
    alpha_cutoff: Option<f32>,
}

/// What the materials of a scene need to be looked up.
pub(super) struct Surfaces<'a>(Vec<Looks<'a>>);

impl<'a> Surfaces<'a> {
    /// With `averages`, textures answer with means over as much as they are asked about, else with the nearest texel.
    pub(super) fn new(scene: &'a Scene, averages: bool) -> Self {
        let mut samplers: HashMap<(usize, bool), Arc<Sampler<'a>>> = HashMap::new();
        let mut lookup = |texture: Option<usize>, by_opacity: bool| -> Option<Lookup<'a>> {
            let number = texture?;
            let texture = scene.textures.get(number).filter(|t| t.width > 0 && t.height > 0)?;
            let sampler = samplers
                .entry((number, by_opacity))
                .or_insert_with(|| Arc::new(Sampler::new(texture, by_opacity, averages)));
            let sampler = Arc::clone(sampler);
            Some(Box::new(move |uv: Vec2, area: f32| sampler.sample(uv, area)))
        };
        let looks = scene.materials.iter().enumerate().map(|(number, material)| {
            let alpha_cutoff = holes(scene, number);
            Looks {
                base_color: lookup(material.base_color_texture, alpha_cutoff.is_some()),
                emission: lookup(material.emission_texture, false),
                alpha_cutoff,
            }
        });
        Self(looks.collect())
    }

    /// The model of the same scene.
    pub(super) fn model<'b>(&'b self, scene: &'b Scene) -> Model<'b> {
        let materials = scene.materials.iter().zip(&self.0).map(|(material, looks)| Material {
            base_color: material.base_color,
            base_color_texture: looks.base_color.as_deref(),
            emission: material.emission,
            emission_texture: looks.emission.as_deref(),
            alpha_cutoff: looks.alpha_cutoff,
        });
        let meshes = scene.instances.iter().map(|instance| {
            let mesh = &scene.meshes[instance.mesh];
            let is_tinted = mesh.colors.iter().any(|color| *color != [1.0; 4]);
            MeshView {
                normals: Some(&mesh.normals),
                uvs: Some(&mesh.uvs),
                colors: is_tinted.then_some(&mesh.colors),
                material: MaterialOf::Mesh(mesh.material),
                world_from_local: instance.world_from_local,
                ..MeshView::new(TriangleView { positions: &mesh.positions, indices: &mesh.indices })
            }
        });
        Model { meshes: meshes.collect(), materials: materials.collect() }
    }
}

/// The opacity below which a material has holes; none if it is above it everywhere.
pub(super) fn holes(scene: &Scene, number: usize) -> Option<f32> {
    let material = &scene.materials[number];
    let cutoff = match material.alpha {
        AlphaMode::Opaque => return None,
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Blend => SEEN,
    };
    let texture = material.base_color_texture.and_then(|n| scene.textures.get(n));
    let thinnest = texture.and_then(|t| t.pixels.chunks_exact(4).map(|p| p[3]).min()).unwrap_or(u8::MAX);
    let tints = scene.meshes.iter().filter(|mesh| mesh.material == number).flat_map(|mesh| &mesh.colors);
    let tint = tints.map(|color| color[3]).fold(1.0, f32::min);
    let least = material.base_color.w * f32::from(thinnest) / 255.0 * tint;
    (least < cutoff).then_some(cutoff)
}
