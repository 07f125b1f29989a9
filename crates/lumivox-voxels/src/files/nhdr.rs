//! NRRD: `NAME.nhdr` with `NAME.raw` for occupancy (bytes, 1 where occupied), and `NAME.CHANNEL.nhdr` with
//! `NAME.CHANNEL.raw` for each channel.
//!
//! Axes run component, x, y, z, the first fastest. Samples stand in the middles of cells: `space origin` is the middle
//! of cell `(0, 0, 0)`, and the cell size is the length of the `space directions`. The key `lumivox_origin` repeats the
//! grid's corner.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::{FileError, FileReport, Place, create, format::beside, layers};
use crate::{ChannelData, Format, SparseVolume};

pub(super) fn write(
    place: &mut dyn Place,
    path: &Path,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    let mut files = Vec::new();
    let raw = raw(path);
    create(place, &raw, |out| layers::occupancy(volume, 1, out))?;
    header(place, path, &raw, volume, None)?;
    files.extend([path.to_owned(), raw]);
    for channel in volume.channels() {
        let raw = beside(path, channel.name(), "raw");
        let own = beside(path, channel.name(), "nhdr");
        create(place, &raw, |out| layers::channel(volume, channel, 0, out))?;
        header(place, &own, &raw, volume, Some(channel))?;
        files.extend([own, raw]);
    }
    Ok(FileReport { files, ..FileReport::default() })
}

/// The data of occupancy.
pub(super) fn raw(path: &Path) -> PathBuf {
    path.with_extension("raw")
}

fn header(
    place: &mut dyn Place,
    path: &Path,
    raw: &Path,
    volume: &SparseVolume,
    channel: Option<&ChannelData>,
) -> Result<(), FileError> {
    let grid = volume.grid();
    let (n, side) = (grid.dims, f64::from(grid.cell_size));
    let center = grid.origin.as_dvec3() + 0.5 * side;
    let (name, kind, components) = match channel {
        None => ("occupancy", "uint8", 1),
        Some(channel) => {
            let kind = match channel.values().format() {
                Format::U8 => "uint8",
                // The format has no half floats.
                Format::F16 => "uint16",
                Format::F32 => "float",
            };
            (channel.name(), kind, channel.components())
        }
    };
    let data = raw.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    create(place, path, |out| {
        writeln!(out, "NRRD0005")?;
        writeln!(out, "# Voxels of the channel {name}")?;
        writeln!(out, "type: {kind}")?;
        let directions = format!("({side:?},0,0) (0,{side:?},0) (0,0,{side:?})");
        if components == 1 {
            writeln!(out, "dimension: 3\nspace dimension: 3\nsizes: {} {} {}", n.x, n.y, n.z)?;
            writeln!(out, "space directions: {directions}\nkinds: domain domain domain")?;
        } else {
            writeln!(out, "dimension: 4\nspace dimension: 3\nsizes: {components} {} {} {}", n.x, n.y, n.z)?;
            writeln!(out, "space directions: none {directions}\nkinds: vector domain domain domain")?;
        }
        writeln!(out, "space origin: ({:?},{:?},{:?})", center.x, center.y, center.z)?;
        writeln!(out, "endian: little\nencoding: raw\ndata file: {data}")?;
        writeln!(out, "lumivox_channel:={name}\nlumivox_axis_order:=xyz, the first fastest")?;
        if let Some(channel) = channel {
            let [low, high] = channel.range();
            match channel.values().format() {
                Format::U8 => writeln!(out, "lumivox_range:={low:?} {high:?}")?,
                Format::F16 => writeln!(out, "lumivox_numbers:=half floats in 16-bit words")?,
                Format::F32 => {}
            }
        }
        let [x, y, z] = grid.origin.to_array();
        writeln!(out, "lumivox_origin:={x:?} {y:?} {z:?}\nlumivox_cell_size:={:?}", grid.cell_size)
    })
}
