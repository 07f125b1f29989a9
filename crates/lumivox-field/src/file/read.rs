//! Reading a file. Its size is held against its header before anything is allocated for its maps.

use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::Path;

use super::CHECKSUM_BYTES;
use super::header::{HEADER_BYTES, Header};
use crate::field::maps::Maps;
use crate::{Field, FieldError};

impl Field {
    /// Reads a field from a file.
    ///
    /// # Errors
    /// [`FieldError::Io`], [`FieldError::NotAField`], [`FieldError::Version`], [`FieldError::Size`],
    /// [`FieldError::Damaged`] and [`FieldError::OutOfMemory`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FieldError> {
        let path = path.as_ref();
        let failed = |error: std::io::Error| FieldError::io(path, "opening", &error);
        // A pipe would be waited for, for ever.
        let found = fs::metadata(path).map_err(failed)?;
        if !found.is_file() {
            return Err(failed(std::io::Error::other("it is not a regular file")));
        }
        Self::read_file(path, found.len(), BufReader::new(File::open(path).map_err(failed)?))
    }

    /// Reads a field from the bytes of a file. `name` is for messages.
    ///
    /// # Errors
    /// As [`Field::load`], but for [`FieldError::Io`].
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, FieldError> {
        Self::read_file(Path::new(name), bytes.len() as u64, bytes)
    }

    fn read_file(path: &Path, file_bytes: u64, mut reader: impl Read) -> Result<Self, FieldError> {
        let header = read_header(path, file_bytes, &mut reader)?;
        let expected = header.file_bytes();
        if file_bytes != expected {
            let file = path.display().to_string();
            return Err(FieldError::Size { file, expected, found: file_bytes });
        }
        let mut maps = Maps::empty(&header.settings);
        maps.reserve(&header.settings).ok_or(FieldError::OutOfMemory { bytes: header.settings.bytes() })?;
        let mut buffer = Vec::new();
        for chunk in 0..header.chunks() {
            maps.append(read_chunk(path, &header, chunk, &mut reader, &mut buffer)?);
        }
        Self::new(header.settings, header.sphere, header.mesh_key, maps)
    }
}

pub(super) fn read_header(
    path: &Path,
    file_bytes: u64,
    reader: &mut impl Read,
) -> Result<Header, FieldError> {
    let mut bytes = Vec::with_capacity(HEADER_BYTES);
    let read = reader.by_ref().take(HEADER_BYTES as u64).read_to_end(&mut bytes);
    read.map_err(|error| FieldError::io(path, "reading", &error))?;
    Header::from_bytes(path, &bytes, file_bytes)
}

/// Reads the maps of one run and holds them against their checksum.
pub(super) fn read_chunk(
    path: &Path,
    header: &Header,
    chunk: u32,
    reader: &mut impl Read,
    buffer: &mut Vec<u8>,
) -> Result<Maps, FieldError> {
    let bytes = header.chunk_bytes(chunk);
    buffer.clear();
    let size = usize::try_from(bytes).map_err(|_| FieldError::OutOfMemory { bytes })?;
    buffer.try_reserve(size).map_err(|_| FieldError::OutOfMemory { bytes })?;
    buffer.resize(size, 0);
    reader.read_exact(buffer).map_err(|error| FieldError::io(path, "reading", &error))?;
    let first = chunk * crate::MAPS_PER_CHUNK;
    let damaged = |what: &str| FieldError::damaged(path, format!("the maps from number {first} on {what}"));
    let (maps, checksum) = buffer.split_at(size - CHECKSUM_BYTES);
    if header.chunk_checksum(chunk, maps).to_le_bytes() != checksum {
        return Err(damaged("do not have their checksum"));
    }
    Maps::from_bytes(&header.settings, header.maps_of_chunk(chunk) as usize, maps)
        .ok_or_else(|| damaged("hold impossible numbers"))
}
