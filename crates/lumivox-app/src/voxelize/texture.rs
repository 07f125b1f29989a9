//! Textures as a voxelizer asks them: averages over squares of texels, in linear space.
//!
//! A cell may see a thousand texels or a thousandth of one. A chain of halved images, each texel the mean of those
//! below it, holds the averages; a square is then summed over at most three by three texels of the level at which it is
//! one to two of them wide, each with the share that the square covers. So a texel is a square of one colour, and a cell
//! within it gets exactly that colour.

use glam::{Vec2, Vec4};
use lumivox_scene::{Texture, Wrap};

/// Steps of a linear value in one.
const STEPS: f32 = u16::MAX as f32;

/// A square of a piece's whole area reaches beyond it if the piece is a triangle. One of this share of it lies within half a
/// cell, which is the most common triangle and whose neighbour in the texture may be another picture.
const SHARE: f32 = 8.0 / 9.0;

/// A halved image: linear RGBA.
struct Level {
    width: u32,
    height: u32,
    texels: Vec<[u16; 4]>,
}

/// A texture with its averages.
pub(super) struct Sampler<'a> {
    texture: &'a Texture,
    linear_from_byte: [f32; 256],
    /// Colours count by their opacity, for what has holes: nothing else should see the colour of a hole.
    by_opacity: bool,
    /// Levels above the image itself; none if the nearest texel is wanted.
    levels: Vec<Level>,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(texture: &'a Texture, by_opacity: bool, averages: bool) -> Self {
        let linear_from_byte = std::array::from_fn(|byte| {
            let value = byte as f32 / 255.0;
            match texture.srgb {
                false => value,
                true if value <= 0.040_45 => value / 12.92,
                true => ((value + 0.055) / 1.055).powf(2.4),
            }
        });
        let mut sampler = Self { texture, linear_from_byte, by_opacity, levels: Vec::new() };
        while averages && sampler.size(sampler.levels.len()) != [1, 1] {
            let level = sampler.levels.len();
            sampler.levels.push(sampler.halved(level, sampler.size(level).map(|side| side.div_ceil(2))));
        }
        sampler
    }

    /// The image and, for averages, its mip levels as a GPU has them, odd sides halved downwards: sides and RGBA8, encoded as the
    /// image is.
    pub(super) fn mip_levels(
        texture: &'a Texture,
        by_opacity: bool,
        averages: bool,
    ) -> Vec<([u32; 2], Vec<u8>)> {
        let mut sampler = Self::new(texture, by_opacity, false);
        let mut mips = vec![(sampler.size(0), texture.pixels.clone())];
        while averages && sampler.size(sampler.levels.len()) != [1, 1] {
            let level = sampler.levels.len();
            let size = sampler.size(level).map(|side| (side / 2).max(1));
            sampler.levels.push(sampler.halved(level, size));
            mips.push((size, sampler.bytes(level + 1)));
        }
        mips
    }

    /// The texels of a level, encoded as the image is.
    fn bytes(&self, level: usize) -> Vec<u8> {
        let [width, height] = self.size(level);
        let mut bytes = Vec::with_capacity(4 * width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let texel = self.texel(level, x, y);
                let share = if self.by_opacity && texel.w > 0.0 { texel.w } else { 1.0 };
                let color = (texel / share).to_array();
                bytes.extend(color[..3].iter().map(|&value| self.byte_from_linear(value)));
                bytes.push((255.0 * texel.w + 0.5) as u8);
            }
        }
        bytes
    }

    /// The byte whose value is nearest.
    fn byte_from_linear(&self, value: f32) -> u8 {
        let above = self.linear_from_byte.partition_point(|known| *known < value).min(255);
        let below = above.saturating_sub(1);
        let is_lower = value - self.linear_from_byte[below] < self.linear_from_byte[above] - value;
        if is_lower { below as u8 } else { above as u8 }
    }

    fn size(&self, level: usize) -> [u32; 2] {
        match level.checked_sub(1) {
            None => [self.texture.width, self.texture.height],
            Some(n) => [self.levels[n].width, self.levels[n].height],
        }
    }

    /// A texel of a level; colours by opacity are multiplied with it.
    fn texel(&self, level: usize, x: u32, y: u32) -> Vec4 {
        match level.checked_sub(1) {
            None => {
                let at = 4 * (y as usize * self.texture.width as usize + x as usize);
                let [r, g, b, a] = [0, 1, 2, 3].map(|n| self.texture.pixels[at + n]);
                let [r, g, b] = [r, g, b].map(|byte| self.linear_from_byte[usize::from(byte)]);
                let opacity = f32::from(a) / 255.0;
                let share = if self.by_opacity { opacity } else { 1.0 };
                Vec4::new(share * r, share * g, share * b, opacity)
            }
            Some(n) => {
                let level = &self.levels[n];
                let texel = level.texels[y as usize * level.width as usize + x as usize];
                Vec4::from_array(texel.map(f32::from)) / STEPS
            }
        }
    }

    /// A level with fewer texels.
    fn halved(&self, level: usize, [width, height]: [u32; 2]) -> Level {
        let [from_width, from_height] = self.size(level);
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                // Odd sizes do not halve: texels then cover parts of others.
                let columns = shares(x, width, from_width);
                let mut sum = Vec4::ZERO;
                for (row, high) in shares(y, height, from_height) {
                    for (column, wide) in columns.clone() {
                        sum += high * wide * self.texel(level, column, row);
                    }
                }
                texels.push((STEPS * sum + 0.5).to_array().map(|v| v as u16));
            }
        }
        Level { width, height, texels }
    }

    /// Linear colour averaged over a square of `area` in texture coordinates around `uv`, and the opacity at `uv`.
    pub(super) fn sample(&self, uv: Vec2, area: f32) -> Vec4 {
        let [width, height] = self.size(0);
        let at = Vec2::new(wrapped(uv.x, self.texture.wrap[0]), wrapped(uv.y, self.texture.wrap[1]));
        let index = |v: f32, size: u32, wrap| tile((v * size as f32).floor() as i64, size, wrap);
        let here = self.texel(
            0,
            index(at.x, width, self.texture.wrap[0]),
            index(at.y, height, self.texture.wrap[1]),
        );
        let opacity = here.w;
        let mut sum = here;
        if !self.levels.is_empty() && area > 0.0 {
            sum = self.average(at, (SHARE * area * width as f32 * height as f32).sqrt());
        }
        let share = if self.by_opacity { sum.w } else { 1.0 };
        let color = if share > 0.0 { sum / share } else { sum };
        color.with_w(opacity)
    }

    /// The mean over a square of `side` texels of the image.
    fn average(&self, at: Vec2, side: f32) -> Vec4 {
        let level = (side.max(1.0).log2() as usize).min(self.levels.len());
        let size = self.size(level);
        let [full_width, full_height] = self.size(0);
        // In texels of the level; beyond the last level's there is nothing more to average.
        let wide = (side * size[0] as f32 / full_width as f32).min(2.0);
        let high = (side * size[1] as f32 / full_height as f32).min(2.0);
        let middle = at * Vec2::new(size[0] as f32, size[1] as f32);
        let mut sum = Vec4::ZERO;
        let mut total = 0.0;
        for (y, share_y) in covered(middle.y, high) {
            for (x, share_x) in covered(middle.x, wide) {
                let [wrap_x, wrap_y] = self.texture.wrap;
                let share = share_x * share_y;
                sum += share * self.texel(level, tile(x, size[0], wrap_x), tile(y, size[1], wrap_y));
                total += share;
            }
        }
        sum / total
    }
}

/// The texels that an interval around `middle` covers, and how much of each; at least a little of one.
fn covered(middle: f32, length: f32) -> impl Iterator<Item = (i64, f32)> + Clone {
    let half = 0.5 * length.max(1e-3);
    let (low, high) = (middle - half, middle + half);
    let first = low.floor() as i64;
    (first..=high.floor() as i64).take(4).filter_map(move |n| {
        let share = high.min(n as f32 + 1.0) - low.max(n as f32);
        (share > 0.0).then_some((n, share))
    })
}

/// Of `from` texels in a row those that texel `n` of `to` covers, with shares that sum to one.
fn shares(n: u32, to: u32, from: u32) -> impl Iterator<Item = (u32, f32)> + Clone {
    // In whole numbers of 1 / (from * to).
    let (low, high) = (u64::from(n) * u64::from(from), u64::from(n + 1) * u64::from(from));
    let to = u64::from(to);
    (low / to..high.div_ceil(to)).map(move |k| {
        let covered = high.min((k + 1) * to) - low.max(k * to);
        (k as u32, covered as f32 / from as f32)
    })
}

/// A coordinate brought near the image, so that no precision is lost.
fn wrapped(v: f32, wrap: Wrap) -> f32 {
    let v = if v.is_finite() { v } else { 0.0 };
    match wrap {
        Wrap::Repeat => v - v.floor(),
        Wrap::Mirror => v.rem_euclid(2.0),
        Wrap::Clamp => v.clamp(0.0, 1.0),
    }
}

/// The texel that stands at place `n` of the endless plane.
fn tile(n: i64, size: u32, wrap: Wrap) -> u32 {
    let count = i64::from(size);
    (match wrap {
        Wrap::Repeat => n.rem_euclid(count),
        Wrap::Mirror => {
            let n = n.rem_euclid(2 * count);
            n.min(2 * count - 1 - n)
        }
        Wrap::Clamp => n.clamp(0, count - 1),
    }) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
        let pixels = (0..width * height).flat_map(|n| pixel(n % width, n / width)).collect();
        Texture { name: String::new(), width, height, srgb: true, pixels, wrap: [Wrap::Repeat; 2] }
    }

    #[test]
    fn averages_are_of_light_and_not_of_bytes() {
        let board = texture(8, 8, |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
        let sampler = Sampler::new(&board, false, true);
        for side in [0.25, 0.5, 1.0, 3.0] {
            let mean = sampler.sample(Vec2::new(0.5, 0.25), side * side);
            assert!((mean.x - 0.5).abs() < 1e-3, "{side} {mean}");
        }
        // Within one texel exactly its colour, whatever its neighbours.
        let white = sampler.sample(Vec2::new(0.5 / 8.0, 0.5 / 8.0), 0.9 / 64.0);
        assert_eq!(white, Vec4::ONE);
        let nearest = Sampler::new(&board, false, false);
        assert_eq!(nearest.sample(Vec2::new(0.5 / 8.0, 0.5 / 8.0), 1.0), Vec4::ONE);
    }

    #[test]
    fn every_size_keeps_its_mean() {
        for (width, height) in [(5, 3), (1, 7), (6, 10), (33, 1)] {
            let ramp = texture(width, height, |x, y| [(7 * x) as u8, (20 * y) as u8, 9, 255]);
            let sampler = Sampler::new(&ramp, false, true);
            let texels = (0..width * height).map(|n| sampler.texel(0, n % width, n / width));
            let mean = texels.sum::<Vec4>() / (width * height) as f32;
            let found = sampler.texel(sampler.levels.len(), 0, 0);
            assert!((found - mean).abs().max_element() < 1e-3, "{width} x {height}: {found} {mean}");
        }
    }

    #[test]
    fn mip_levels_keep_means_and_the_colours_of_leaves() {
        let board = texture(7, 4, |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
        let mips = Sampler::mip_levels(&board, false, true);
        assert_eq!(mips.iter().map(|mip| mip.0).collect::<Vec<_>>(), [[7, 4], [3, 2], [1, 1]]);
        // Half of all light is 188 in sRGB.
        assert_eq!(mips[2].1, [188, 188, 188, 255]);
        let leaves = texture(4, 4, |x, _| if x < 2 { [255, 0, 0, 255] } else { [0, 0, 0, 0] });
        assert_eq!(Sampler::mip_levels(&leaves, true, true)[2].1, [255, 0, 0, 128]);
    }

    #[test]
    fn holes_lend_no_colour() {
        // Red leaves on transparent black.
        let leaves = texture(4, 4, |x, _| if x < 2 { [255, 0, 0, 255] } else { [0, 0, 0, 0] });
        let mean = Sampler::new(&leaves, true, true).sample(Vec2::new(0.1, 0.5), 1.0 / SHARE);
        assert!((mean.x - 1.0).abs() < 1e-3 && mean.w == 1.0, "{mean}");
        let plain = Sampler::new(&leaves, false, true).sample(Vec2::new(0.1, 0.5), 1.0 / SHARE);
        assert!((plain.x - 0.5).abs() < 1e-3, "{plain}");
    }

    #[test]
    fn wild_coordinates_find_a_texel() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            let mut image = texture(3, 2, |x, _| [x as u8, 0, 0, 255]);
            image.wrap = [wrap; 2];
            let sampler = Sampler::new(&image, true, true);
            for v in [f32::NAN, f32::INFINITY, -1e30, 1e30, -0.0, 1.0, 2.0, -1e-9] {
                for area in [f32::NAN, f32::INFINITY, 0.0, 1e-30, 1e30] {
                    assert!(sampler.sample(Vec2::splat(v), area).is_finite(), "{v} {area}");
                }
            }
        }
    }
}
