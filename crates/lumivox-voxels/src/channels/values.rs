//! Numbers of a channel as they are stored.

use std::ops::Range;

use half::f16;
use half::slice::HalfFloatSliceExt;

/// How a channel's numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One byte: 0 to 255 stand for the channel's range.
    U8,
    /// Half float.
    F16,
    /// Single float.
    F32,
}

impl Format {
    /// Bytes of one number.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::F16 => 2,
            Self::F32 => 4,
        }
    }
}

/// Numbers in one of the formats.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Bytes.
    U8(Vec<u8>),
    /// Half floats.
    F16(Vec<f16>),
    /// Single floats.
    F32(Vec<f32>),
}

impl Values {
    pub(crate) fn new(format: Format) -> Self {
        match format {
            Format::U8 => Self::U8(Vec::new()),
            Format::F16 => Self::F16(Vec::new()),
            Format::F32 => Self::F32(Vec::new()),
        }
    }

    /// The format.
    pub fn format(&self) -> Format {
        match self {
            Self::U8(_) => Format::U8,
            Self::F16(_) => Format::F16,
            Self::F32(_) => Format::F32,
        }
    }

    /// How many numbers.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::F16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers' bytes, in the byte order of this machine.
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::U8(v) => v,
            Self::F16(v) => bytemuck::cast_slice(v),
            Self::F32(v) => bytemuck::cast_slice(v),
        }
    }

    /// Number `n`, where 0 to 255 stand for `range`; zero beyond the end.
    pub fn get(&self, n: usize, range: [f32; 2]) -> f32 {
        match self {
            Self::U8(v) => v.get(n).map_or(0.0, |&b| decode_u8(b, range)),
            Self::F16(v) => v.get(n).map_or(0.0, |h| h.to_f32()),
            Self::F32(v) => v.get(n).copied().unwrap_or(0.0),
        }
    }

    /// Appends numbers.
    #[inline]
    pub(crate) fn push(&mut self, values: &[f32], range: [f32; 2]) {
        match self {
            Self::U8(v) => v.extend(values.iter().map(|&value| encode_u8(value, range))),
            Self::F16(v) => {
                // Many at once where the processor can.
                let mut cut_off = [0.0; 96];
                for values in values.chunks(cut_off.len()) {
                    let cut_off = &mut cut_off[..values.len()];
                    cut_off
                        .iter_mut()
                        .zip(values)
                        .for_each(|(to, value)| *to = value.clamp(-65504.0, 65504.0));
                    let start = v.len();
                    v.resize(start + values.len(), f16::ZERO);
                    v[start..].convert_from_f32_slice(cut_off);
                }
            }
            Self::F32(v) => v.extend_from_slice(values),
        }
    }

    /// Appends the same numbers, at most four, so many times.
    pub(crate) fn push_copies(&mut self, values: &[f32], count: usize, range: [f32; 2]) {
        fn copies<T: Copy>(to: &mut Vec<T>, start: usize, count: usize) {
            // In doubling steps, each of them one copy of memory.
            let end = start + (to.len() - start) * count;
            while to.len() < end && to.len() > start {
                let more = (to.len() - start).min(end - to.len());
                to.extend_from_within(start..start + more);
            }
        }
        if count == 0 {
            return;
        }
        let start = self.len();
        self.push(values, range);
        match self {
            Self::U8(v) => copies(v, start, count),
            Self::F16(v) => copies(v, start, count),
            Self::F32(v) => copies(v, start, count),
        }
    }

    /// Makes room for so many numbers more.
    pub(crate) fn reserve(&mut self, more: usize) {
        match self {
            Self::U8(v) => v.reserve(more),
            Self::F16(v) => v.reserve(more),
            Self::F32(v) => v.reserve(more),
        }
    }

    /// Appends a part of numbers of the same format.
    pub(crate) fn extend_from(&mut self, other: &Self, range: Range<usize>) {
        match (self, other) {
            (Self::U8(to), Self::U8(from)) => to.extend_from_slice(&from[range]),
            (Self::F16(to), Self::F16(from)) => to.extend_from_slice(&from[range]),
            (Self::F32(to), Self::F32(from)) => to.extend_from_slice(&from[range]),
            (to, from) => range.for_each(|n| to.push(&[from.get(n, [0.0, 1.0])], [0.0, 1.0])),
        }
    }

    /// Appends numbers of the same format.
    pub(crate) fn append(&mut self, other: Self) {
        match (self, other) {
            (Self::U8(to), Self::U8(from)) => to.extend_from_slice(&from),
            (Self::F16(to), Self::F16(from)) => to.extend_from_slice(&from),
            (Self::F32(to), Self::F32(from)) => to.extend_from_slice(&from),
            (to, from) => (0..from.len()).for_each(|n| to.push(&[from.get(n, [0.0, 1.0])], [0.0, 1.0])),
        }
    }
}

fn encode_u8(value: f32, [low, high]: [f32; 2]) -> u8 {
    // `as` cuts off, takes NaN to zero, and is one instruction where `round` is a call.
    (255.0 * (value - low) / (high - low) + 0.5) as u8
}

fn decode_u8(byte: u8, [low, high]: [f32; 2]) -> f32 {
    low + (high - low) * f32::from(byte) / 255.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_gives_back_what_it_can_hold() {
        for (format, values, range, tolerance) in [
            (Format::U8, [-1.0, 0.25, 1.0], [-1.0, 1.0], 1.0 / 255.0),
            (Format::F16, [-1.0, 0.25, 1000.0], [0.0, 1.0], 0.0),
            (Format::F32, [-1.0e30, 0.1, 3.0e38], [0.0, 1.0], 0.0),
        ] {
            let mut stored = Values::new(format);
            stored.push(&values, range);
            assert_eq!((stored.format(), stored.len()), (format, 3));
            assert_eq!(stored.as_bytes().len(), 3 * format.bytes());
            for (n, &value) in values.iter().enumerate() {
                assert!((stored.get(n, range) - value).abs() <= tolerance, "{format:?} {value}");
            }
        }
    }

    #[test]
    fn copies_are_what_pushing_again_and_again_gives() {
        for format in [Format::U8, Format::F16, Format::F32] {
            for count in [0, 1, 2, 7, 100] {
                let mut expected = Values::new(format);
                expected.push(&[0.5], [0.0, 1.0]);
                let mut copies = expected.clone();
                (0..count).for_each(|_| expected.push(&[0.1, 0.7, 0.3], [0.0, 1.0]));
                copies.push_copies(&[0.1, 0.7, 0.3], count, [0.0, 1.0]);
                assert_eq!(copies, expected);
            }
        }
    }

    #[test]
    fn values_beyond_a_format_are_cut_off() {
        let mut bytes = Values::new(Format::U8);
        bytes.push(&[-3.0, 7.0, f32::NAN], [0.0, 1.0]);
        assert_eq!(bytes, Values::U8(vec![0, 255, 0]));
        let mut halves = Values::new(Format::F16);
        halves.push(&[1e9], [0.0, 1.0]);
        assert_eq!(halves.get(0, [0.0, 1.0]), 65504.0);
    }
}
