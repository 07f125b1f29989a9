//! How the numbers of a channel lie in words.

use glam::Vec4;
use half::f16;

/// How a channel's numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// A byte each, four to a word: 0 to 255 stand for the channel's range.
    U8,
    /// A half float each, two to a word.
    F16,
    /// A float each.
    F32,
}

/// A channel of a volume: its name, and how its numbers are stored.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelFormat {
    /// Name.
    pub name: String,
    /// Numbers per cell, 1 to 4.
    pub components: u32,
    /// How each is stored. Unused bytes of the last word are zero, unless the channel's maker says otherwise.
    pub format: Format,
    /// What 0 and 255 stand for in [`Format::U8`]; other formats ignore it.
    pub range: [f32; 2],
}

impl ChannelFormat {
    /// Four half floats, what light works with.
    pub fn half4(name: &str) -> Self {
        Self { name: name.to_owned(), components: 4, format: Format::F16, range: [0.0, 1.0] }
    }

    /// Words of 32 bits per cell.
    pub fn words(&self) -> u32 {
        match self.format {
            Format::U8 => self.components.div_ceil(4),
            Format::F16 => self.components.div_ceil(2),
            Format::F32 => self.components,
        }
    }

    /// Bytes per cell.
    pub fn bytes(&self) -> u64 {
        4 * u64::from(self.words())
    }

    /// The numbers in a cell's words, those in unused bytes too.
    pub fn unpack(&self, words: &[u32]) -> Vec4 {
        let mut values = [0.0; 4];
        let numbers = words.iter().flat_map(|&word| self.unpack_word(word));
        values.iter_mut().zip(numbers).for_each(|(value, number)| *value = number);
        Vec4::from(values)
    }

    fn unpack_word(&self, word: u32) -> impl Iterator<Item = f32> {
        let bytes = word.to_le_bytes();
        let [low, high] = self.range;
        let (numbers, count) = match self.format {
            Format::U8 => (bytes.map(|b| low + (high - low) * f32::from(b) / 255.0), 4),
            Format::F16 => {
                let half = |n: usize| f16::from_le_bytes([bytes[n], bytes[n + 1]]).to_f32();
                ([half(0), half(2), 0.0, 0.0], 2)
            }
            Format::F32 => ([f32::from_bits(word), 0.0, 0.0, 0.0], 1),
        };
        numbers.into_iter().take(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_hold_what_they_should() {
        let of = |components, format| ChannelFormat {
            name: "c".to_owned(),
            components,
            format,
            range: [-1.0, 1.0],
        };
        let sizes = [Format::U8, Format::F16, Format::F32].map(|f| [1, 2, 3, 4].map(|c| of(c, f).words()));
        assert_eq!(sizes, [[1, 1, 1, 1], [1, 1, 2, 2], [1, 2, 3, 4]]);
        assert_eq!(of(2, Format::U8).unpack(&[0x0000_ff00]), Vec4::new(-1.0, 1.0, -1.0, -1.0));
        assert_eq!(of(3, Format::F16).unpack(&[0x3c00_bc00, 0x0000_4000]), Vec4::new(-1.0, 1.0, 2.0, 0.0));
        assert_eq!(of(2, Format::F32).unpack(&[0x4000_0000, 0]), Vec4::new(2.0, 0.0, 0.0, 0.0));
    }
}
