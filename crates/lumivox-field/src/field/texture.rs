//! All maps of a field in one 3D texture, several maps per slice (Figure 28), within the limits of the core tier.

use super::{Distances, Field};

/// The longest side of a 3D texture on the core tier: WebGPU's default `maxTextureDimension3D`.
pub const MAX_TEXTURE_SIDE: u32 = 2048;

/// Where the maps lie: row by row in a slice, slice after slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureLayout {
    /// Texels of one map along x and y. With one bit per direction a texel holds 32 directions along x.
    pub map: [u32; 2],
    /// Maps along x.
    pub columns: u32,
    /// Maps along y.
    pub rows: u32,
    /// Slices, along z. The last may be part empty.
    pub slices: u32,
}

impl TextureLayout {
    /// The layout with the smallest longest side among those that leave at most 1/64 of the room unused; if there is
    /// none, that with the least unused. `None` if no layout fits [`MAX_TEXTURE_SIDE`].
    pub fn new(maps: u32, map: [u32; 2]) -> Option<Self> {
        let most = map.map(|side| MAX_TEXTURE_SIDE / side.max(1));
        let all = (1..=most[1]).flat_map(|rows| (1..=most[0]).map(move |columns| (columns, rows)));
        let layouts = all.map(|(columns, rows)| {
            let slices = maps.div_ceil(columns * rows);
            Self { map, columns, rows, slices }
        });
        layouts.filter(|l| l.slices > 0 && l.slices <= MAX_TEXTURE_SIDE).min_by_key(|l| {
            let room = l.columns * l.rows * l.slices;
            let unused = room - maps;
            let longest = l.size().into_iter().max().unwrap_or(0);
            let much = if unused > room / 64 { unused } else { 0 };
            (much, longest, unused, l.columns.abs_diff(l.rows))
        })
    }

    /// Texels of the texture along x, y and z.
    pub fn size(&self) -> [u32; 3] {
        [self.map[0] * self.columns, self.map[1] * self.rows, self.slices]
    }

    /// The first texel of a map.
    pub fn origin(&self, map: u32) -> [u32; 3] {
        let (slice, place) = (map / (self.columns * self.rows), map % (self.columns * self.rows));
        [place % self.columns * self.map[0], place / self.columns * self.map[1], slice]
    }

    /// Spreads maps that lie one after the other.
    fn packed<T: Copy>(&self, maps: &[T], empty: T) -> Vec<T> {
        let [width, height, depth] = self.size().map(|side| side as usize);
        let [map_width, map_height] = self.map.map(|side| side as usize);
        let mut texels = vec![empty; width * height * depth];
        for (n, map) in maps.chunks(map_width * map_height).enumerate() {
            let [x, y, z] = self.origin(n as u32).map(|v| v as usize);
            for (t, row) in map.chunks(map_width).enumerate() {
                let start = x + width * (y + t + height * z);
                texels[start..start + row.len()].copy_from_slice(row);
            }
        }
        texels
    }
}

/// The texels of a packed texture, x fastest, then y, then z.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// `r8unorm`: the value times 255/254 times 2 R is the distance, and above 254.5/255 nothing is met.
    Byte(Vec<u8>),
    /// `r32float`: the value times 2 R is the distance, and at 1 nothing is met.
    Float(Vec<f32>),
    /// `r32uint`: bit `s % 32` of texel `s / 32` of row t.
    Bit(Vec<u32>),
}

/// A field as one texture.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldTexture {
    /// Where the maps lie.
    pub layout: TextureLayout,
    /// The distances. Room that no map uses reads as nothing met.
    pub texels: Texels,
    /// `rg8snorm`, octahedral normals of the object's space, of the same size; empty without normals.
    pub normals: Vec<[i8; 2]>,
    /// Mean depth over 2 R of each map, with one bit per direction; empty otherwise.
    pub depths: Vec<f32>,
}

impl Field {
    /// Where the maps lie in the texture of the distances.
    pub fn texture_layout(&self) -> Option<TextureLayout> {
        let side = self.settings.directions;
        let width = if matches!(self.maps.distances, Distances::Bit { .. }) { side / 32 } else { side };
        TextureLayout::new(self.settings.points, [width, side])
    }

    /// The field as one texture, a copy; `None` if it does not fit the core tier's sides. With one bit per direction
    /// and normals, the normals have a texel per direction and stay a layout of 32 times the width.
    pub fn texture(&self) -> Option<FieldTexture> {
        let layout = self.texture_layout()?;
        let mut depths = Vec::new();
        let texels = match &self.maps.distances {
            Distances::Byte(codes) => Texels::Byte(layout.packed(codes, super::BYTE_MISS)),
            Distances::Float(values) => Texels::Float(layout.packed(values, 1.0)),
            Distances::Bit { words, depths: kept } => {
                depths.clone_from(kept);
                Texels::Bit(layout.packed(words, 0))
            }
        };
        let normals = if self.maps.normals.is_empty() {
            Vec::new()
        } else {
            self.normal_layout()?.packed(&self.maps.normals, [0; 2])
        };
        Some(FieldTexture { layout, texels, normals, depths })
    }

    /// Where the maps lie in the texture of the normals: as in that of the distances, but for one bit per direction.
    pub fn normal_layout(&self) -> Option<TextureLayout> {
        TextureLayout::new(self.settings.points, [self.settings.directions; 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::directions::MAP_SIDES;
    use crate::points::POINT_COUNTS;

    #[test]
    fn the_texts_volume_holds_four_maps_per_slice() {
        let layout = TextureLayout::new(2048, [256; 2]).unwrap();
        assert_eq!((layout.columns, layout.rows, layout.size()), (2, 2, [512; 3]));
    }

    #[test]
    fn all_fields_fit_and_waste_little() {
        for points in POINT_COUNTS {
            for side in MAP_SIDES {
                for map in [[side; 2], [side / 32, side]] {
                    let layout = TextureLayout::new(points, map).unwrap();
                    assert!(layout.size().iter().all(|s| *s <= MAX_TEXTURE_SIDE), "{layout:?}");
                    let room = layout.columns * layout.rows * layout.slices;
                    assert!(room >= points && room - points <= room / 64, "{points} {layout:?}");
                }
            }
        }
        assert!(TextureLayout::new(10_000, [2048; 2]).is_none());
        assert!(TextureLayout::new(1, [4096; 2]).is_none());
        assert!(TextureLayout::new(0, [64; 2]).is_none());
    }

    #[test]
    fn every_texel_lies_where_its_map_begins() {
        let layout = TextureLayout { map: [4, 3], columns: 3, rows: 2, slices: 2 };
        let maps: Vec<u32> = (0..8 * 12).collect();
        let texels = layout.packed(&maps, u32::MAX);
        assert_eq!(texels.len(), 12 * 6 * 2);
        for (n, &value) in maps.iter().enumerate() {
            let (map, s, t) = (n as u32 / 12, n as u32 % 4, n as u32 % 12 / 4);
            let [x, y, z] = layout.origin(map);
            assert_eq!(texels[(x + s + 12 * (y + t + 6 * z)) as usize], value);
        }
        assert_eq!(texels.iter().filter(|t| **t == u32::MAX).count(), 4 * 12);
    }
}
