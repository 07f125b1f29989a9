//! Which materials take a part of the light, and which part: those with holes, such as leaves, and those that say so.

use glam::Vec3;
use lumivox_scene::{AlphaMode, Material, Scene, Texture};

use super::leaf_shadows::KINDS;
use crate::gpu_scene::is_thin;

/// The kinds of bits that materials have.
#[derive(Debug)]
pub(super) struct Absorbers {
    /// Of each material.
    kinds: Vec<Option<u32>>,
    /// Of each kind.
    parts: Vec<Part>,
}

/// What a surface leaves of light.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// What its material says.
    Stated(Vec3),
    /// `1 - sigma` of its brightest colour.
    Colored(Vec3),
}

impl Absorbers {
    pub(super) fn new(scene: &Scene, is_colored: bool) -> Self {
        let mut parts: Vec<Part> = Vec::new();
        let kind = |material: &Material| {
            let part = match material.absorber {
                Some(left) => Part::Stated(left),
                None if is_colored => Part::Colored(color(scene, material)),
                None => Part::Colored(Vec3::ONE),
            };
            if !is_thin(material) {
                return None;
            }
            if let Some(known) = parts.iter().position(|p| *p == part) {
                return Some(known as u32);
            }
            if parts.len() < KINDS {
                parts.push(part);
            }
            Some(parts.len() as u32 - 1)
        };
        let kinds = scene.materials.iter().map(kind).collect();
        Self { kinds, parts }
    }

    pub(super) fn kind(&self, material: usize) -> Option<u32> {
        self.kinds.get(material).copied().flatten()
    }

    pub(super) fn kinds(&self) -> u32 {
        self.parts.len().max(1) as u32
    }

    /// What a surface of each kind leaves.
    pub(super) fn through(&self, sigma: f32) -> [Vec3; KINDS] {
        let mut through = [Vec3::ONE; KINDS];
        for (through, part) in through.iter_mut().zip(&self.parts) {
            *through = match *part {
                Part::Stated(left) => left,
                Part::Colored(color) => (1.0 - sigma.clamp(0.0, 1.0)) * color,
            };
        }
        through
    }
}

/// The mean colour of a material where it is opaque, as bright as can be.
fn color(scene: &Scene, material: &Material) -> Vec3 {
    let cutoff = match material.alpha {
        AlphaMode::Mask { cutoff } => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.5,
    };
    let texture = material.base_color_texture.and_then(|t| scene.textures.get(t));
    let mean = texture.map_or(Vec3::ONE, |texture| mean(texture, cutoff)) * material.base_color.truncate();
    if mean.max_element() > 0.0 { mean / mean.max_element() } else { Vec3::ONE }
}

/// Of a texture's texels that are not holes; of some thousand, if there are more.
fn mean(texture: &Texture, cutoff: f32) -> Vec3 {
    let linear = |c: u8| {
        let c = f32::from(c) / 255.0;
        match texture.srgb {
            true if c <= 0.04045 => c / 12.92,
            true => ((c + 0.055) / 1.055).powf(2.4),
            false => c,
        }
    };
    let texels = texture.pixels.chunks_exact(4);
    let step = (texels.len() / 4096).max(1);
    let solid = texels.step_by(step).filter(|t| f32::from(t[3]) / 255.0 >= cutoff);
    let (sum, count) = solid.fold((Vec3::ZERO, 0u32), |(sum, count), t| {
        (sum + Vec3::new(linear(t[0]), linear(t[1]), linear(t[2])), count + 1)
    });
    if count > 0 { sum / count as f32 } else { Vec3::ONE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_told_apart_by_what_they_leave() {
        let mut scene = Scene::default();
        let mut add = |color: Vec3, alpha, absorber| {
            let material = Material { alpha, absorber, ..Material::matte("", color) };
            scene.materials.push(material);
        };
        let mask = AlphaMode::Mask { cutoff: 0.5 };
        add(Vec3::new(0.1, 0.2, 0.0), mask, None);
        add(Vec3::new(0.2, 0.4, 0.0), mask, None);
        add(Vec3::splat(0.5), AlphaMode::Opaque, None);
        add(Vec3::splat(0.5), AlphaMode::Opaque, Some(Vec3::new(0.9, 0.1, 0.1)));
        let plain = Absorbers::new(&scene, false);
        assert_eq!((plain.kinds(), plain.kind(0), plain.kind(1), plain.kind(2)), (2, Some(0), Some(0), None));
        assert_eq!(plain.through(0.25)[..2], [Vec3::splat(0.75), Vec3::new(0.9, 0.1, 0.1)]);
        let colored = Absorbers::new(&scene, true);
        assert_eq!((colored.kinds(), colored.kind(1), colored.kind(3)), (2, Some(0), Some(1)));
        assert!((colored.through(0.5)[0] - Vec3::new(0.25, 0.5, 0.0)).abs().max_element() < 1e-6);
    }
}
