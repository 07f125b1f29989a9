//! Just enough of a zip file: deflated entries of any size, with 64-bit fields throughout.

use std::io::{self, Seek, SeekFrom, Write};

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};

struct Entry {
    name: String,
    crc: u32,
    compressed: u64,
    size: u64,
    offset: u64,
}

/// A zip file being written.
pub(super) struct Zip<'a, W: Write + Seek> {
    out: &'a mut W,
    entries: Vec<Entry>,
}

/// Counts and sums what passes.
struct Checked<W> {
    out: W,
    crc: Crc,
}

impl<W: Write> Write for Checked<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.crc.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Counts what passes.
struct Counted<'a, W> {
    out: &'a mut W,
    bytes: u64,
}

impl<W: Write> Write for Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Version 4.5, which is what 64-bit fields need; no flags; deflate; 1 January 1980.
const COMMON: [u8; 10] = [45, 0, 0, 0, 8, 0, 0, 0, 0x21, 0];

impl<'a, W: Write + Seek> Zip<'a, W> {
    pub(super) fn new(out: &'a mut W) -> Self {
        Self { out, entries: Vec::new() }
    }

    /// Adds an entry of `size` bytes that `body` writes.
    pub(super) fn entry(
        &mut self,
        name: &str,
        body: impl FnOnce(&mut dyn Write) -> io::Result<u64>,
    ) -> io::Result<()> {
        let offset = self.out.stream_position()?;
        let header = |entry: &Entry| {
            let mut bytes = b"PK\x03\x04".to_vec();
            bytes.extend(COMMON);
            bytes.extend(entry.crc.to_le_bytes());
            bytes.extend([0xff; 8]);
            bytes.extend((entry.name.len() as u16).to_le_bytes());
            bytes.extend(20u16.to_le_bytes());
            bytes.extend(entry.name.as_bytes());
            bytes.extend([1, 0, 16, 0]);
            bytes.extend(entry.size.to_le_bytes());
            bytes.extend(entry.compressed.to_le_bytes());
            bytes
        };
        let mut entry = Entry { name: name.to_owned(), crc: 0, compressed: 0, size: 0, offset };
        self.out.write_all(&header(&entry))?;
        {
            let counted = Counted { out: &mut *self.out, bytes: 0 };
            let encoder = DeflateEncoder::new(counted, Compression::fast());
            let mut checked = Checked { out: encoder, crc: Crc::new() };
            entry.size = body(&mut checked)?;
            entry.crc = checked.crc.sum();
            entry.compressed = checked.out.finish()?.bytes;
        }
        let end = self.out.stream_position()?;
        self.out.seek(SeekFrom::Start(offset))?;
        self.out.write_all(&header(&entry))?;
        self.out.seek(SeekFrom::Start(end))?;
        self.entries.push(entry);
        Ok(())
    }

    /// Writes the directory.
    pub(super) fn finish(self) -> io::Result<()> {
        let start = self.out.stream_position()?;
        for entry in &self.entries {
            self.out.write_all(b"PK\x01\x02")?;
            self.out.write_all(&[45, 0])?;
            self.out.write_all(&COMMON)?;
            self.out.write_all(&entry.crc.to_le_bytes())?;
            self.out.write_all(&[0xff; 8])?;
            self.out.write_all(&(entry.name.len() as u16).to_le_bytes())?;
            self.out.write_all(&28u16.to_le_bytes())?;
            // Comment, disk, attributes.
            self.out.write_all(&[0; 10])?;
            self.out.write_all(&[0xff; 4])?;
            self.out.write_all(entry.name.as_bytes())?;
            self.out.write_all(&[1, 0, 24, 0])?;
            for number in [entry.size, entry.compressed, entry.offset] {
                self.out.write_all(&number.to_le_bytes())?;
            }
        }
        let end = self.out.stream_position()?;
        let count = self.entries.len() as u64;
        self.out.write_all(b"PK\x06\x06")?;
        self.out.write_all(&44u64.to_le_bytes())?;
        self.out.write_all(&[45, 0, 45, 0, 0, 0, 0, 0, 0, 0, 0, 0])?;
        for number in [count, count, end - start, start] {
            self.out.write_all(&number.to_le_bytes())?;
        }
        self.out.write_all(b"PK\x06\x07\0\0\0\0")?;
        self.out.write_all(&end.to_le_bytes())?;
        self.out.write_all(&1u32.to_le_bytes())?;
        self.out.write_all(b"PK\x05\x06\0\0\0\0")?;
        self.out.write_all(&[0xff; 12])?;
        self.out.write_all(&[0, 0])
    }
}
