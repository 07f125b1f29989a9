//! The first 64 bytes of a file.

use std::path::Path;

use glam::Vec3;
use xxhash_rust::xxh3::xxh3_64;

use crate::bake::{RADII, Sphere};
use crate::{FieldError, Mapping, Settings, Storage};

/// The version of the format that is written, and the only one read.
pub const VERSION: u32 = 1;

/// Bytes of the header.
pub const HEADER_BYTES: usize = 64;

/// Not ASCII, and broken by transfers that change line ends.
const MAGIC: [u8; 8] = *b"\x89LVF\r\n\x1a\n";

/// Bytes before the checksum.
const CHECKED: usize = 56;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Header {
    pub(crate) settings: Settings,
    pub(crate) sphere: Sphere,
    pub(crate) mesh_key: u128,
}

impl Header {
    pub(crate) fn to_bytes(self) -> [u8; HEADER_BYTES] {
        let Settings { points, directions, mapping, storage, normals } = self.settings;
        let mapping = Mapping::ALL.iter().position(|m| *m == mapping).unwrap_or_default();
        let kinds = [mapping as u8, storage.bits() as u8, u8::from(normals), 0];
        let Sphere { center, radius } = self.sphere;
        let mut bytes = [0; HEADER_BYTES];
        let mut at = 0;
        let mut put = |part: &[u8]| {
            bytes[at..at + part.len()].copy_from_slice(part);
            at += part.len();
        };
        put(&MAGIC);
        [VERSION, points, directions].iter().for_each(|n| put(&n.to_le_bytes()));
        put(&kinds);
        center.extend(radius).to_array().iter().for_each(|v| put(&v.to_le_bytes()));
        put(&self.mesh_key.to_le_bytes());
        let checksum = xxh3_64(&bytes[..CHECKED]);
        bytes[CHECKED..].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// The checksum at the header's end.
    pub(crate) fn checksum(self) -> u64 {
        number(&self.to_bytes(), CHECKED, u64::from_le_bytes)
    }

    /// Reads a header, of which `bytes` may be only a part.
    pub(crate) fn from_bytes(file: &Path, bytes: &[u8], file_bytes: u64) -> Result<Self, FieldError> {
        let name = || file.display().to_string();
        if !bytes.starts_with(&MAGIC) {
            return Err(FieldError::NotAField { file: name() });
        }
        let Ok(bytes) = <&[u8; HEADER_BYTES]>::try_from(bytes) else {
            let expected = HEADER_BYTES as u64;
            return Err(FieldError::Size { file: name(), expected, found: file_bytes });
        };
        let word = |at| number(bytes, at, u32::from_le_bytes);
        // Another version may have its checksum elsewhere, so it is told first.
        if word(8) != VERSION {
            return Err(FieldError::Version { file: name(), found: word(8), known: VERSION });
        }
        if xxh3_64(&bytes[..CHECKED]) != number(bytes, CHECKED, u64::from_le_bytes) {
            return Err(FieldError::damaged(file, "its header does not have its checksum"));
        }
        let unknown = |what: &str| FieldError::damaged(file, format!("its header has an unknown {what}"));
        let [mapping, bits, normals, reserved] = word(20).to_le_bytes();
        let settings = Settings {
            points: word(12),
            directions: word(16),
            mapping: *Mapping::ALL.get(usize::from(mapping)).ok_or_else(|| unknown("mapping"))?,
            storage: Storage::from_bits(u32::from(bits)).map_err(|_| unknown("number of bits"))?,
            normals: normals == 1,
        };
        if normals > 1 || reserved != 0 {
            return Err(unknown("kind of normals"));
        }
        settings.check().map_err(|_| unknown("number of points or directions"))?;
        let float = |at| number(bytes, at, f32::from_le_bytes);
        let sphere = Sphere { center: Vec3::new(float(24), float(28), float(32)), radius: float(36) };
        if !(sphere.center.is_finite() && RADII.contains(&sphere.radius)) {
            return Err(unknown("sphere"));
        }
        Ok(Self { settings, sphere, mesh_key: number(bytes, 40, u128::from_le_bytes) })
    }
}

fn number<const N: usize, T>(bytes: &[u8; HEADER_BYTES], at: usize, from: impl Fn([u8; N]) -> T) -> T {
    let mut part = [0; N];
    part.copy_from_slice(&bytes[at..at + N]);
    from(part)
}
