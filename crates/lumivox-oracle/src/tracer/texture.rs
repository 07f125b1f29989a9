//! Texture lookups: bilinear, of linear values, texel centres at half-integers, no mip levels.

use glam::{Vec2, Vec4};

use crate::scene::{Texture, Wrap};

/// The linear value of an sRGB-encoded one (IEC 61966-2-1), both 0..=1.
pub(crate) fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// A texture whose bytes are looked up in a table of linear values.
pub(crate) struct Sampler<'a> {
    texture: &'a Texture,
    linear: [f32; 256],
}

impl<'a> Sampler<'a> {
    pub(crate) fn new(texture: &'a Texture) -> Self {
        let linear = std::array::from_fn(|byte| {
            let value = byte as f32 / 255.0;
            if texture.srgb { linear_from_srgb(value) } else { value }
        });
        Self { texture, linear }
    }

    /// Linear colour and opacity.
    pub(crate) fn at(&self, uv: Vec2) -> Vec4 {
        let size = Vec2::new(self.texture.width as f32, self.texture.height as f32);
        let turns =
            |x: f32, wrap| if wrap == Wrap::Clamp { x.clamp(-1.0, 2.0) } else { x - 2.0 * (x * 0.5).floor() };
        let uv = Vec2::new(turns(uv.x, self.texture.wrap[0]), turns(uv.y, self.texture.wrap[1]));
        let p = uv * size - 0.5;
        let (low, t) = (p.floor(), p - p.floor());
        let texel = |dx: i64, dy: i64| self.texel(low.x as i64 + dx, low.y as i64 + dy);
        texel(0, 0).lerp(texel(1, 0), t.x).lerp(texel(0, 1).lerp(texel(1, 1), t.x), t.y)
    }

    fn texel(&self, x: i64, y: i64) -> Vec4 {
        let x = wrapped(x, self.texture.width, self.texture.wrap[0]);
        let y = wrapped(y, self.texture.height, self.texture.wrap[1]);
        let at = 4 * (y * self.texture.width as usize + x);
        let [r, g, b, a] = std::array::from_fn(|i| self.texture.pixels[at + i]);
        let [r, g, b] = [r, g, b].map(|byte| self.linear[usize::from(byte)]);
        Vec4::new(r, g, b, f32::from(a) / 255.0)
    }
}

fn wrapped(index: i64, count: u32, wrap: Wrap) -> usize {
    let n = i64::from(count);
    let index = match wrap {
        Wrap::Repeat => index.rem_euclid(n),
        Wrap::Clamp => index.clamp(0, n - 1),
        Wrap::Mirror => {
            let within = index.rem_euclid(2 * n);
            within.min(2 * n - 1 - within)
        }
    };
    index as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(wrap: Wrap) -> Texture {
        let pixels = [0, 100, 200].into_iter().flat_map(|r| [r, 0, 0, 255]).collect();
        Texture { width: 3, height: 1, srgb: false, pixels, wrap: [wrap; 2] }
    }

    #[test]
    fn texel_centres_are_exact_and_what_is_beyond_wraps() {
        for (wrap, left, right) in
            [(Wrap::Repeat, 200.0, 0.0), (Wrap::Clamp, 0.0, 200.0), (Wrap::Mirror, 0.0, 200.0)]
        {
            let texture = ramp(wrap);
            let red = |u: f32| 255.0 * Sampler::new(&texture).at(Vec2::new(u, 0.5)).x;
            for (texel, expected) in [(-1, left), (0, 0.0), (1, 100.0), (2, 200.0), (3, right)] {
                let u = (texel as f32 + 0.5) / 3.0;
                assert!((red(u) - expected).abs() < 1e-2, "{wrap:?} {texel}: {}", red(u));
            }
            assert!((red(1.0 / 3.0) - 50.0).abs() < 1e-2);
        }
    }

    #[test]
    fn srgb_is_decoded_before_filtering_and_alpha_never() {
        let texture = Texture {
            width: 2,
            height: 1,
            srgb: true,
            pixels: vec![0, 0, 0, 0, 255, 188, 0, 128],
            wrap: [Wrap::Clamp; 2],
        };
        let value = Sampler::new(&texture).at(Vec2::new(0.5, 0.5));
        assert!((value.x - 0.5).abs() < 1e-6);
        // ((188 / 255 + 0.055) / 1.055)^2.4 = 0.5029
        assert!((value.y - 0.5 * 0.5029).abs() < 1e-4);
        assert!((value.w - 64.0 / 255.0).abs() < 1e-6);
    }
}
