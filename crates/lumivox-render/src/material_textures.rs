//! The textures and samplers that materials share.
//!
//! | | filtered | at a point |
//! | --- | --- | --- |
//! | for | pictures | comparison with a path tracer |
//! | mip levels | all, averaged in linear light | the finest |
//! | sampler | trilinear, anisotropic | nearest, which wraps |
//! | sRGB | decoded by the hardware | stored as it is, decoded by `surface.wgsl` |
//! | weights | of the hardware, often eight bits | 32-bit floats |
//!
//! Hardware need not decode sRGB exactly: Mesa's software driver uses a polynomial that is 0.25 % too dark for bright texels
//! and 0.5 % too bright for dark ones.

use lumivox::gpu::{Gpu, GpuError, Sampler, Texture, TextureOptions};
use lumivox::wgpu;
use lumivox_scene::{AlphaMode, Material, Scene, Texture as Image, Wrap};

/// Textures of a scene, and a sampler for every way to wrap.
#[derive(Debug)]
pub struct MaterialTextures {
    /// The scene's, with a white one behind them.
    textures: Vec<Texture>,
    /// In the order of [`WRAPS`].
    samplers: Vec<Sampler>,
    /// Likewise, without anisotropy, which means nothing where there are no pixels.
    volume_samplers: Vec<Sampler>,
    filtered: bool,
}

impl MaterialTextures {
    /// Uploads a scene's textures to be filtered, or to be looked up at a point.
    pub fn new(gpu: &Gpu, scene: &Scene, filtered: bool) -> Result<Self, GpuError> {
        let is_mask = |m: &Material, n| m.alpha != AlphaMode::Opaque && m.base_color_texture == Some(n);
        let mut textures = Vec::new();
        for (n, image) in scene.textures.iter().enumerate() {
            let masks = scene.materials.iter().any(|m| is_mask(m, n));
            textures.push(upload(gpu, image, filtered, masks)?);
        }
        textures.push(upload(gpu, &white(), filtered, false)?);
        Ok(Self {
            textures,
            // Floors seen at a grazing angle keep their tiles.
            samplers: WRAPS
                .iter()
                .map(|w| sampler(gpu, *w, filtered, if filtered { 8 } else { 1 }))
                .collect(),
            volume_samplers: WRAPS.iter().map(|wrap| sampler(gpu, *wrap, filtered, 1)).collect(),
            filtered,
        })
    }

    /// A texture of the scene, or white.
    pub(crate) fn texture(&self, index: Option<usize>) -> &Texture {
        &self.textures[index.unwrap_or(self.textures.len() - 1)]
    }

    pub(crate) fn sampler(&self, wrap: [Wrap; 2]) -> &Sampler {
        &self.samplers[WRAPS.iter().position(|w| *w == wrap).unwrap_or(0)]
    }

    /// For stages that voxelize.
    pub(crate) fn volume_sampler(&self, wrap: [Wrap; 2]) -> &Sampler {
        &self.volume_samplers[WRAPS.iter().position(|w| *w == wrap).unwrap_or(0)]
    }

    /// Whether they have mip levels, and are linear light to shaders.
    pub(crate) fn is_filtered(&self) -> bool {
        self.filtered
    }

    /// The constants of fragment stages that look materials up.
    pub(crate) fn constants(&self) -> &'static [(&'static str, f64)] {
        if self.filtered { &[("LOOKS_UP_POINTS", 0.0)] } else { &[("LOOKS_UP_POINTS", 1.0)] }
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

fn sampler(gpu: &Gpu, wrap: [Wrap; 2], filtered: bool, anisotropy: u16) -> Sampler {
    let (filter, mipmap_filter) = match filtered {
        true => (wgpu::FilterMode::Linear, wgpu::MipmapFilterMode::Linear),
        false => (wgpu::FilterMode::Nearest, wgpu::MipmapFilterMode::Nearest),
    };
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
            mag_filter: filter,
            min_filter: filter,
            mipmap_filter,
            anisotropy_clamp: anisotropy,
            ..Default::default()
        },
    )
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
fn upload(gpu: &Gpu, image: &Image, filtered: bool, masks: bool) -> Result<Texture, GpuError> {
    let format = match image.srgb && filtered {
        true => wgpu::TextureFormat::Rgba8UnormSrgb,
        false => wgpu::TextureFormat::Rgba8Unorm,
    };
    let size = [image.width, image.height];
    let mips = if filtered { image.width.max(image.height).max(1).ilog2() + 1 } else { 1 };
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = Texture::new(gpu, &image.name, TextureOptions { size, format, usage, mips })?;
    let mut level = (size, image.pixels.clone());
    for mip_level in 0..mips {
        if mip_level > 0 {
            level = halved(&level.1, level.0, image.srgb, masks);
        }
        let ([width, height], pixels) = &level;
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level, ..texture.raw.as_image_copy() },
            pixels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
            wgpu::Extent3d { width: *width, height: *height, depth_or_array_layers: 1 },
        );
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
