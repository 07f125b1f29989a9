//! What shines on objects where polished surfaces mirror them, and what they are made of.

use glam::Vec3;
use lumivox::visibility::{HitLamp, HitLight};
use lumivox_scene::{Light, Material, Mesh, Scene, Texture};

/// The part of the sky's light that comes back from below, as from a floor of middling brightness.
const FROM_BELOW: f32 = 0.4;

/// The scene's lights without their extent, and the mean of its sky.
pub(super) fn hit_light(lights: &[Light], sky: Vec3) -> HitLight {
    let lamps = lights.iter().map(lamp).collect();
    HitLight { above: sky, below: FROM_BELOW * sky, lamps, shadows: true }
}

fn lamp(light: &Light) -> HitLamp {
    match *light {
        Light::Directional { direction, irradiance } => HitLamp::Sun { direction, irradiance },
        Light::Point { position, intensity } => HitLamp::Point { position, intensity },
        Light::Spot { position, direction, intensity, beam, cutoff, .. } => {
            HitLamp::Spot { position, direction, intensity, beam, cutoff }
        }
        Light::Rect { origin, u, v, radiance } => {
            let normal = u.cross(v);
            HitLamp::Panel {
                position: origin + 0.5 * (u + v),
                direction: normal,
                intensity: radiance * normal.length(),
            }
        }
    }
}

/// The mean albedo of a mesh: its material's colour, times the mean of its vertices' and of the texture.
pub(super) fn mean_albedo(scene: &Scene, mesh: &Mesh) -> Vec3 {
    let Some(material) = scene.materials.get(mesh.material) else { return Vec3::ONE };
    let count = mesh.colors.len().max(1) as f32;
    let painted: Vec3 = mesh.colors.iter().map(|c| Vec3::new(c[0], c[1], c[2])).sum();
    let painted = if mesh.colors.is_empty() { Vec3::ONE } else { painted / count };
    (material.base_color.truncate() * painted * texture_mean(scene, material)).clamp(Vec3::ZERO, Vec3::ONE)
}

fn texture_mean(scene: &Scene, material: &Material) -> Vec3 {
    let texture = material.base_color_texture.and_then(|n| scene.textures.get(n));
    texture.filter(|t| t.pixels.len() >= 4).map_or(Vec3::ONE, mean)
}

fn mean(texture: &Texture) -> Vec3 {
    let linear = |byte: u8| {
        let c = f32::from(byte) / 255.0;
        // IEC 61966-2-1.
        let decoded = if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        if texture.srgb { decoded } else { c }
    };
    let levels: Vec<f32> = (0..=255).map(linear).collect();
    let sum = texture
        .pixels
        .chunks_exact(4)
        .fold([0.0f64; 3], |sum, texel| [0, 1, 2].map(|i| sum[i] + f64::from(levels[usize::from(texel[i])])));
    let count = (texture.pixels.len() / 4) as f64;
    Vec3::from(sum.map(|s| (s / count) as f32))
}
