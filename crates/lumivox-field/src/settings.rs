//! What a field is made of.

use crate::directions::{Directions, Mapping};
use crate::{FieldError, points};

/// How the distance of one direction is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Storage {
    /// One byte: 0 to 254 for a distance of 0 to 2 R in steps of 2 R / 254, rounded, and 255 for none (4.6.1.2).
    #[default]
    Byte,
    /// Four bytes: the distance over 2 R as a float, below 1, and 1 for none (4.6.1.1).
    Float,
    /// One bit: whether anything is met. Each map keeps one depth along its normal, the mean of what it meets (4.6.1.3).
    Bit,
}

impl Storage {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Byte, Self::Float, Self::Bit];

    /// Bits per direction.
    pub fn bits(self) -> u32 {
        match self {
            Self::Byte => 8,
            Self::Float => 32,
            Self::Bit => 1,
        }
    }

    /// The storage with so many bits per direction.
    ///
    /// # Errors
    /// [`FieldError::Unsupported`] for a number that is not 1, 8 or 32.
    pub fn from_bits(bits: u32) -> Result<Self, FieldError> {
        Self::ALL.into_iter().find(|s| s.bits() == bits).ok_or_else(|| FieldError::Unsupported {
            what: "number of bits per direction",
            given: bits.to_string(),
            allowed: "1, 8 and 32",
        })
    }
}

/// What a field is made of. The default is the text's compromise: 4226 points of 64 x 64 directions, one byte each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Settings {
    /// Number of sample points on the sphere, one of [`points::POINT_COUNTS`].
    pub points: u32,
    /// Directions along the side of a map, one of [`directions::MAP_SIDES`](crate::directions::MAP_SIDES).
    pub directions: u32,
    /// How directions are spread over a map.
    pub mapping: Mapping,
    /// How distances are kept.
    pub storage: Storage,
    /// Whether each direction also keeps the surface normal that it meets, two bytes, for reflections (4.5.2).
    pub normals: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            points: 4226,
            directions: 64,
            mapping: Mapping::default(),
            storage: Storage::default(),
            normals: false,
        }
    }
}

impl Settings {
    /// Refuses numbers outside their choices.
    ///
    /// # Errors
    /// [`FieldError::Unsupported`].
    pub fn check(&self) -> Result<(), FieldError> {
        points::check_count(self.points)?;
        Directions::new(self.mapping, self.directions)?;
        Ok(())
    }

    /// Directions of one map.
    pub fn texels(&self) -> u64 {
        u64::from(self.directions) * u64::from(self.directions)
    }

    /// Rays that a bake traces at most: one per direction that the mapping uses.
    pub fn rays(&self) -> u64 {
        u64::from(self.points) * self.texels()
    }

    /// Bytes of one map: its distances, its mean depth and its normals.
    pub fn map_bytes(&self) -> u64 {
        let depth = if self.storage == Storage::Bit { 4 } else { 0 };
        let normals = if self.normals { 2 * self.texels() } else { 0 };
        self.texels() * u64::from(self.storage.bits()) / 8 + depth + normals
    }

    /// Bytes of all maps, in memory and, but for some thousands, in a file.
    pub fn bytes(&self) -> u64 {
        u64::from(self.points) * self.map_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_those_of_the_text() {
        let mib = |points, directions, storage| {
            let settings = Settings { points, directions, storage, ..Settings::default() };
            settings.bytes() as f64 / f64::from(1 << 20)
        };
        // Figures 42, 46 and 47: MB of 2^20 bytes.
        assert!((mib(4226, 64, Storage::Byte) - 16.508).abs() < 1e-3);
        assert!((mib(16642, 32, Storage::Byte) - 16.252).abs() < 1e-3);
        assert!((mib(1090, 128, Storage::Byte) - 17.031).abs() < 1e-3);
        assert!((mib(4226, 32, Storage::Float) - 16.508).abs() < 1e-3);
        assert_eq!(Settings { storage: Storage::Bit, ..Settings::default() }.map_bytes(), 4096 / 8 + 4);
        assert_eq!(Settings { normals: true, ..Settings::default() }.map_bytes(), 3 * 4096);
    }

    #[test]
    fn choices_are_checked() {
        assert!(Settings::default().check().is_ok());
        assert!(Settings { points: 80, ..Settings::default() }.check().is_err());
        assert!(Settings { directions: 65, ..Settings::default() }.check().is_err());
        for bits in [0, 2, 16, 64] {
            assert!(Storage::from_bits(bits).is_err());
        }
        assert_eq!(Storage::from_bits(32).unwrap(), Storage::Float);
    }
}
