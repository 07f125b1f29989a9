//! MTL material libraries, read line by line: colour, emission, opacity and the colour map. Short colour lines are
//! allowed by the format (one number is a grey) and everything else is passed over.

use glam::Vec3;

use super::DEFAULT_ALBEDO;
use super::source::Source;
use super::texture::Textures;
use crate::{AlphaMode, Limits, Material, Scene, SceneError, Wrap};

/// One material as the file states it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    color: Option<Vec3>,
    emission: Option<Vec3>,
    opacity: Option<f32>,
    color_map: Option<String>,
    opacity_map: Option<String>,
}

/// The materials of a library, in order.
pub(super) fn parse(text: &str) -> Vec<MtlMaterial> {
    let mut all: Vec<MtlMaterial> = Vec::new();
    for line in text.lines() {
        let line = line.trim();
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if key == "newmtl" {
            all.push(MtlMaterial { name: rest.to_owned(), ..MtlMaterial::default() });
            continue;
        }
        let Some(current) = all.last_mut() else { continue };
        match key.to_ascii_lowercase().as_str() {
            "kd" => current.color = color(rest).or(current.color),
            "ke" => current.emission = color(rest).or(current.emission),
            "d" => current.opacity = rest.split_whitespace().next().and_then(|w| w.parse().ok()),
            "map_kd" => current.color_map = map_path(rest),
            "map_d" => current.opacity_map = map_path(rest),
            _ => {}
        }
    }
    all
}

/// One number is a grey; of two the second stands for the third as well. `None` for spectra and other models.
fn color(text: &str) -> Option<Vec3> {
    let mut numbers = text.split_whitespace().map(|w| w.parse::<f32>().ok().filter(|v| v.is_finite()));
    let r = numbers.next()??;
    let g = numbers.next().map_or(Some(r), |v| v)?;
    let b = numbers.next().map_or(Some(g), |v| v)?;
    Some(Vec3::new(r, g, b).max(Vec3::ZERO))
}

/// The path of a map line; after options such as `-s 1 1 1` it is the last word.
fn map_path(text: &str) -> Option<String> {
    let path = if text.starts_with('-') { text.split_whitespace().last().unwrap_or_default() } else { text };
    (!path.is_empty()).then(|| path.to_owned())
}

/// Adds the materials to the scene, with their maps; a map that is missing is reported.
pub(super) fn add(
    source: &Source,
    materials: &[MtlMaterial],
    limits: &Limits,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let mut textures = Textures::new(limits);
    let mut loaded: Vec<(String, Option<usize>)> = Vec::new();
    for m in materials {
        let mut texture = None;
        if let Some(path) = &m.color_map {
            texture = match loaded.iter().find(|(p, _)| p == path) {
                Some((_, index)) => *index,
                None => {
                    let index = match source.beside(path).and_then(|s| s.read_self(limits)) {
                        Ok(bytes) => textures.add(path, &bytes, [Wrap::Repeat; 2], scene)?,
                        Err(error) => {
                            scene.report.warn(format!("texture '{path}' is left out: {error}"));
                            scene.report.missing_textures.push(path.clone());
                            None
                        }
                    };
                    loaded.push((path.clone(), index));
                    index
                }
            };
        }
        // Exporters write a black Kd beside a map; no one means a black picture.
        let stated = m.color.filter(|c| texture.is_none() || *c != Vec3::ZERO);
        let otherwise = if texture.is_some() { 1.0 } else { DEFAULT_ALBEDO };
        let color = stated.unwrap_or(Vec3::splat(otherwise)).min(Vec3::ONE);
        // Fully transparent is a confusion of d and Tr, as it would be left out otherwise.
        let opacity = m.opacity.filter(|d| *d > 0.0 && *d < 1.0).unwrap_or(1.0);
        let masked = m.opacity_map.is_some() && m.opacity_map == m.color_map && texture.is_some();
        if m.opacity_map.is_some() && !masked {
            scene.report.warn("separate opacity maps (map_d) are not read");
        }
        scene.materials.push(Material {
            name: m.name.clone(),
            base_color: color.extend(opacity),
            base_color_texture: texture,
            emission: m.emission.unwrap_or(Vec3::ZERO),
            emission_texture: None,
            alpha: match (masked, opacity < 1.0) {
                (true, _) => AlphaMode::Mask { cutoff: 0.5 },
                (false, true) => AlphaMode::Blend,
                (false, false) => AlphaMode::Opaque,
            },
            ..Material::default()
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_and_strange_lines_are_forgiven() {
        let text = "Kd 1 1 1\nnewmtl a b\nKd 0.5\nKe\nnewmtl c\nKd 0.1 0.2\nKd spectral x.rfl\nd 0.5\n\
            map_Kd -s 1 1 1 maps\\t.png\nnewmtl";
        let all = parse(text);
        assert_eq!(all.len(), 3);
        assert_eq!((all[0].name.as_str(), all[0].color), ("a b", Some(Vec3::splat(0.5))));
        assert_eq!(all[1].color, Some(Vec3::new(0.1, 0.2, 0.2)));
        assert_eq!((all[1].opacity, all[1].color_map.as_deref()), (Some(0.5), Some("maps\\t.png")));
        let mut scene = Scene::default();
        add(&Source::of_memory("a.mtl"), &all, &Limits::default(), &mut scene).unwrap();
        assert_eq!(scene.report.missing_textures, ["maps\\t.png"]);
        assert_eq!(scene.materials[1].alpha, AlphaMode::Blend);
        assert_eq!(scene.materials[2].base_color.x, DEFAULT_ALBEDO);
    }
}
