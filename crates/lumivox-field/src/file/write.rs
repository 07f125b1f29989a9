//! Writing a file, run by run, under a name of its own until it is whole.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{BufReader, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::header::{HEADER_BYTES, Header};
use super::part_path;
use super::read::{read_chunk, read_header};
use crate::field::maps::Maps;
use crate::{Baker, Field, FieldError, MAPS_PER_CHUNK, Progress};

impl Baker {
    /// Bakes the field into a file, holding no more than one run of maps in memory. `observe` is called after each run
    /// and may stop the bake; the next one with the same mesh and settings then goes on where this one was, as it does
    /// after an interrupt.
    ///
    /// # Errors
    /// [`FieldError::Io`], [`FieldError::Cancelled`], and [`FieldError::Busy`] while another bake writes this file.
    pub fn bake_to_file(
        &self,
        path: impl AsRef<Path>,
        observe: impl FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(), FieldError> {
        let header = Header { settings: *self.settings(), sphere: self.sphere(), mesh_key: self.mesh_key() };
        let mut writer = Writer::open(path.as_ref(), header)?;
        let first = writer.resume()? * MAPS_PER_CHUNK;
        self.bake_from(first, observe, |maps| writer.append(&maps))?;
        writer.finish()
    }
}

impl Field {
    /// Writes the field to a file, which is replaced whole or not at all.
    ///
    /// # Errors
    /// [`FieldError::Io`], and [`FieldError::Busy`] while a bake writes this file.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), FieldError> {
        let header = Header { settings: self.settings, sphere: self.sphere, mesh_key: self.mesh_key };
        let mut writer = Writer::open(path.as_ref(), header)?;
        writer.restart()?;
        for chunk in 0..header.chunks() {
            let first = (chunk * MAPS_PER_CHUNK) as usize;
            let maps = first..first + header.maps_of_chunk(chunk) as usize;
            writer.append(&self.maps.slice(&self.settings, maps))?;
        }
        writer.finish()
    }
}

/// A file in the making.
struct Writer {
    file: File,
    part: PathBuf,
    path: PathBuf,
    header: Header,
    chunk: u32,
}

impl Writer {
    /// Opens the part and locks it, whatever it holds.
    fn open(path: &Path, header: Header) -> Result<Self, FieldError> {
        let part = part_path(path);
        let busy = || FieldError::Busy { file: path.display().to_string() };
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&part)
            .map_err(|error| FieldError::io(&part, "opening", &error))?;
        // A file system without locks has no protection against two bakes at once.
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(busy());
        }
        // The other bake may have renamed the file between our opening and our locking it.
        if !part.exists() {
            return Err(busy());
        }
        Ok(Self { file, part, path: path.to_owned(), header, chunk: 0 })
    }

    /// Keeps what is whole in the part, if it is of the same field, and tells how many runs that are.
    fn resume(&mut self) -> Result<u32, FieldError> {
        let bytes = self.file.metadata().map_or(0, |m| m.len());
        let mut reader = BufReader::new(&self.file);
        // Whatever is wrong with a part, it is only worth less.
        if read_header(&self.part, bytes, &mut reader) != Ok(self.header) {
            self.restart()?;
            return Ok(0);
        }
        let mut good = HEADER_BYTES as u64;
        let mut buffer = Vec::new();
        while self.chunk < self.header.chunks()
            && read_chunk(&self.part, &self.header, self.chunk, &mut reader, &mut buffer).is_ok()
        {
            good += self.header.chunk_bytes(self.chunk);
            self.chunk += 1;
        }
        self.cut(good)?;
        Ok(self.chunk)
    }

    /// Begins anew with the header.
    fn restart(&mut self) -> Result<(), FieldError> {
        self.cut(0)?;
        self.chunk = 0;
        let header = self.header.to_bytes();
        self.write(&header)
    }

    fn append(&mut self, maps: &Maps) -> Result<(), FieldError> {
        let mut bytes = maps.to_bytes();
        let checksum = self.header.chunk_checksum(self.chunk, &bytes);
        bytes.extend(checksum.to_le_bytes());
        self.chunk += 1;
        self.write(&bytes)
    }

    /// Gives the whole file its name.
    fn finish(self) -> Result<(), FieldError> {
        self.file.sync_all().map_err(|error| FieldError::io(&self.part, "writing", &error))?;
        fs::rename(&self.part, &self.path).map_err(|error| FieldError::io(&self.path, "renaming", &error))
    }

    fn cut(&mut self, bytes: u64) -> Result<(), FieldError> {
        let cut = self.file.set_len(bytes).and_then(|()| self.file.seek(SeekFrom::Start(bytes)));
        cut.map(drop).map_err(|error| FieldError::io(&self.part, "writing", &error))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), FieldError> {
        self.file.write_all(bytes).map_err(|error| FieldError::io(&self.part, "writing", &error))
    }
}
