//! The file format `.lvf`, version 1. All numbers are little-endian.
//!
//! | bytes | what |
//! | --- | --- |
//! | 0..8 | `89 4C 56 46 0D 0A 1A 0A` |
//! | 8..12 | version of the format |
//! | 12..16, 16..20 | number of points, directions along a side |
//! | 20, 21, 22, 23 | mapping (0 uniform, 1 rejection, 2 concentric), bits per direction, normals (0 or 1), 0 |
//! | 24..40 | centre and radius of the bounding sphere, four floats, metres |
//! | 40..56 | hash of the mesh |
//! | 56..64 | xxh3 of bytes 0..56 |
//!
//! Then the maps in runs of 64, the last of which may be shorter: the distances of its maps, with one bit per direction
//! their mean depths, with normals these, and the xxh3 of all that with the header's xxh3 plus the run's number as its
//! seed. The runs end the file. A byte that is changed, left out, added or moved is noticed.
//!
//! A bake writes to the file's name with `.part` added and renames it at the end. What an interrupt leaves is such a
//! part, and the next bake of the same mesh and settings goes on from its last whole run.

mod header;
mod read;
mod write;

pub use header::{HEADER_BYTES, VERSION};

use std::path::{Path, PathBuf};

use xxhash_rust::xxh3::xxh3_64_with_seed;

use crate::MAPS_PER_CHUNK;
use header::Header;

/// Bytes after each run.
const CHECKSUM_BYTES: usize = 8;

/// The name of a file while it is written.
pub fn part_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

impl Header {
    fn chunks(&self) -> u32 {
        self.settings.points.div_ceil(MAPS_PER_CHUNK)
    }

    fn maps_of_chunk(&self, chunk: u32) -> u32 {
        (self.settings.points - chunk * MAPS_PER_CHUNK).min(MAPS_PER_CHUNK)
    }

    /// Bytes of the maps of a run and of its checksum.
    fn chunk_bytes(&self, chunk: u32) -> u64 {
        u64::from(self.maps_of_chunk(chunk)) * self.settings.map_bytes() + CHECKSUM_BYTES as u64
    }

    /// Bytes of the whole file.
    fn file_bytes(&self) -> u64 {
        let checksums = u64::from(self.chunks()) * CHECKSUM_BYTES as u64;
        HEADER_BYTES as u64 + self.settings.bytes() + checksums
    }

    fn chunk_checksum(&self, chunk: u32, maps: &[u8]) -> u64 {
        xxh3_64_with_seed(maps, self.checksum().wrapping_add(u64::from(chunk)))
    }
}

#[cfg(test)]
mod tests;
