//! NumPy: one array per channel, C order `[z][y][x]`, or `[z][y][x][c]` for more than one component.
//!
//! - `occupancy`: bytes, 1 where occupied, first in the file;
//! - the channels under their names, in their own formats; for bytes also `NAME_range`, what 0 and 255 stand for;
//! - `origin`: three doubles, the lower corner of cell `(0, 0, 0)` in metres; `cell_size`: a double; `axis_order`: `"zyx"`.
//!
//! A point of the world `p` lies in `occupancy[k, j, i]` with `(i, j, k) = floor((p - origin) / cell_size)`.

use std::io::{self, Write};
use std::path::Path;

use super::zip::Zip;
use super::{FileError, FileReport, Place, create, layers};
use crate::{Format, SparseVolume};

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    create(place, path, |out| {
        let mut zip = Zip::new(out);
        let grid = volume.grid();
        let n = grid.dims;
        array(&mut zip, "occupancy", "|u1", &[n.z, n.y, n.x], grid.cell_count(), |out| {
            layers::occupancy(volume, 1, out)
        })?;
        for channel in volume.channels() {
            let (kind, width) = match channel.values().format() {
                Format::U8 => ("|u1", 1),
                Format::F16 => ("<f2", 2),
                Format::F32 => ("<f4", 4),
            };
            let components = channel.components() as u32;
            let shape = [n.z, n.y, n.x, components];
            let shape = if components == 1 { &shape[..3] } else { &shape[..] };
            let bytes = grid.cell_count() * u64::from(components) * width;
            array(&mut zip, channel.name(), kind, shape, bytes, |out| {
                layers::channel(volume, channel, 0, out)
            })?;
            if channel.values().format() == Format::U8 {
                let range = channel.range().map(f32::to_le_bytes).concat();
                array(&mut zip, &format!("{}_range", channel.name()), "<f4", &[2], 8, |out| {
                    out.write_all(&range)
                })?;
            }
        }
        let origin = grid.origin.as_dvec3().to_array().map(f64::to_le_bytes).concat();
        array(&mut zip, "origin", "<f8", &[3], 24, |out| out.write_all(&origin))?;
        let cell_size = f64::from(grid.cell_size).to_le_bytes();
        array(&mut zip, "cell_size", "<f8", &[], 8, |out| out.write_all(&cell_size))?;
        let order: Vec<u8> = "zyx".chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        array(&mut zip, "axis_order", "<U3", &[], 12, |out| out.write_all(&order))?;
        zip.finish()
    })?;
    Ok(FileReport { files: vec![path.to_owned()], ..FileReport::default() })
}

/// One array of `bytes` bytes that `body` writes.
fn array<W: Write + io::Seek>(
    zip: &mut Zip<'_, W>,
    name: &str,
    kind: &str,
    shape: &[u32],
    bytes: u64,
    body: impl FnOnce(&mut &mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    // Magic, version and length take ten bytes; the whole is a multiple of 64 and ends in a line break.
    header.push_str(&" ".repeat(64 - (header.len() + 11) % 64));
    header.push('\n');
    zip.entry(&format!("{name}.npy"), |mut out| {
        out.write_all(b"\x93NUMPY\x01\x00")?;
        out.write_all(&(header.len() as u16).to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        body(&mut out)?;
        Ok(bytes + header.len() as u64 + 10)
    })
}
