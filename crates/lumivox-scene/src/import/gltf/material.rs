//! Materials and the images they show.

use std::collections::HashMap;

use glam::{Vec3, Vec4};
use gltf::material::AlphaMode as GltfAlpha;
use gltf::texture::WrappingMode;

use super::accessor::Reader;
use super::container;
use super::texture_transform::UvSource;
use crate::import::texture::Textures;
use crate::{AlphaMode, Glass, ImportReport, Limits, Material, Scene, SceneError, Wrap};

/// Fills `scene.materials` and `scene.textures`; returns for each material the texture coordinates that it uses.
pub(super) fn read(
    reader: &Reader,
    document: &gltf::Document,
    limits: &Limits,
    scene: &mut Scene,
) -> Result<Vec<UvSource>, SceneError> {
    let mut textures = Textures::new(limits);
    let mut loaded: HashMap<usize, Option<usize>> = HashMap::new();
    let mut uv_sources = Vec::new();
    for material in document.materials() {
        let pbr = material.pbr_metallic_roughness();
        let (color, emission) = (pbr.base_color_texture(), material.emissive_texture());
        uv_sources.push(UvSource::of_material(color.as_ref(), emission.as_ref(), &mut scene.report));

        let mut load = |info: Option<gltf::texture::Info>| -> Result<Option<usize>, SceneError> {
            let Some(texture) = info.map(|i| i.texture()) else { return Ok(None) };
            if let Some(known) = loaded.get(&texture.index()) {
                return Ok(*known);
            }
            let index = load_texture(reader, &texture, limits, &mut textures, scene)?;
            loaded.insert(texture.index(), index);
            Ok(index)
        };
        let base_color_texture = load(color)?;
        let emission_texture = load(emission)?;
        let strength = material.emissive_strength().unwrap_or(1.0);
        scene.materials.push(Material {
            name: material.name().unwrap_or_default().to_owned(),
            base_color: Vec4::from(pbr.base_color_factor().map(|v| finite(v, 1.0).clamp(0.0, 1.0))),
            base_color_texture,
            emission: Vec3::from(material.emissive_factor().map(|v| finite(v * strength, 0.0).max(0.0))),
            emission_texture,
            alpha: match material.alpha_mode() {
                GltfAlpha::Opaque => AlphaMode::Opaque,
                GltfAlpha::Mask => {
                    AlphaMode::Mask { cutoff: finite(material.alpha_cutoff().unwrap_or(0.5), 0.5) }
                }
                GltfAlpha::Blend => AlphaMode::Blend,
            },
            glass: glass(&material, &mut scene.report),
            absorber: None,
        });
    }
    Ok(uv_sources)
}

/// A transmission of one half and more is glass, less is a surface like any other: there is no mixture of both. Without a volume, glass
/// is thin. Textures of transmission, thickness and roughness are not read, and thickness is that of the geometry.
fn glass(material: &gltf::Material, report: &mut ImportReport) -> Option<Glass> {
    let transmission = material.transmission()?;
    let factor = finite(transmission.transmission_factor(), 0.0).clamp(0.0, 1.0);
    let name = material.name().unwrap_or_default();
    if transmission.transmission_texture().is_some() {
        report.warn(format!("material '{name}': the texture of its transmission is not read"));
    }
    if factor < 0.5 {
        if factor > 0.0 {
            report.warn(format!("material '{name}': a transmission of {factor} is shown as none"));
        }
        return None;
    }
    let volume = material.volume().filter(|v| finite(v.thickness_factor(), 0.0) > 0.0);
    let distance = volume.as_ref().map_or(f32::INFINITY, gltf::material::Volume::attenuation_distance);
    let color = volume.as_ref().map_or([1.0; 3], gltf::material::Volume::attenuation_color);
    let roughness = finite(material.pbr_metallic_roughness().roughness_factor(), 1.0);
    Some(Glass {
        ior: finite(material.ior().unwrap_or(1.5), 1.5).clamp(1.0, 4.0),
        color: Vec3::from(color.map(|c| finite(c, 1.0).clamp(0.0, 1.0))),
        distance: if distance > 0.0 { distance } else { f32::INFINITY },
        roughness: roughness.clamp(0.0, 1.0),
        is_thin: volume.is_none(),
        ..Glass::default()
    })
}

fn finite(value: f32, otherwise: f32) -> f32 {
    if value.is_finite() { value } else { otherwise }
}

/// Decodes one texture. An image that is absent or broken is reported and the material goes without.
fn load_texture(
    reader: &Reader,
    texture: &gltf::Texture,
    limits: &Limits,
    textures: &mut Textures,
    scene: &mut Scene,
) -> Result<Option<usize>, SceneError> {
    // Straight from the JSON: the crate's reader takes a source, a MIME type and a URI for granted.
    let image = reader.root.textures.get(texture.index()).map_or(usize::MAX, |t| t.source.value());
    let Some(json) = reader.root.images.get(image) else {
        // Its image is in an extension that is not read.
        scene.report.missing_textures.push(format!("texture {}", texture.index()));
        return Ok(None);
    };
    let short = json.uri.as_ref().filter(|u| !u.starts_with("data:"));
    let name = json.name.as_ref().or(short).cloned().unwrap_or_else(|| format!("image {image}"));
    let sampler = texture.sampler();
    let wrap = [sampler.wrap_s(), sampler.wrap_t()].map(|w| match w {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::ClampToEdge => Wrap::Clamp,
    });
    let index = match (&json.buffer_view, &json.uri) {
        (Some(view), _) => textures.add(&name, reader.view(view.value())?, wrap, scene)?,
        (None, Some(uri)) => match container::resolve(reader.source, uri, limits) {
            Ok(bytes) => textures.add(&name, &bytes, wrap, scene)?,
            Err(error) => {
                scene.report.warn(format!("texture '{name}' is left out: {error}"));
                scene.report.missing_textures.push(name);
                None
            }
        },
        (None, None) => None,
    };
    Ok(index)
}
