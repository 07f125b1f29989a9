//! Volumes as files of the tools that take them.
//!
//! | format | holds | limits |
//! | --- | --- | --- |
//! | `.npz` | all channels, as arrays `[z][y][x]` or `[z][y][x][c]` | none; deflated |
//! | `.nhdr` | all channels, a header and a raw file each | none; as large as the box |
//! | `.ktx2` | all channels, a 3D texture each | three components become four, the last occupancy; as large as the box |
//! | `.vdb` | all channels as float or vector grids, sparse | two components become three |
//! | `.ply` | all channels, at points or on cubes | 2^31 points or corners |
//! | `.vox` | occupancy and `albedo` | 2000 cells a side, 255 colours |
//! | `.binvox` | occupancy | cubic: shorter sides are filled up with empty cells |
//!
//! All of them carry the grid's origin, its cell size and the order of axes, each in its own way; the writers' pages say
//! how. Output is streamed: a layer of cells, or a brick, is the most that is dense at a time. Cells without a value, empty
//! or filled, have zeros.

mod binvox;
mod cubes;
mod format;
mod ktx2;
mod layers;
mod nhdr;
mod npz;
mod palette;
mod place;
mod ply;
mod vdb;
mod vox;
mod zip;

use std::path::{Path, PathBuf};

pub use format::FileFormat;
pub use palette::srgb_from_linear;
pub use place::{Output, Place};
use place::{Renamed, create};

use crate::{ChannelData, SparseVolume};

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The format cannot hold the volume.
    #[error("{}: {reason}", path.display())]
    Limit {
        /// The file.
        path: PathBuf,
        /// Which limit, with numbers.
        reason: String,
    },
}

/// What was written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileReport {
    /// All files: `.nhdr` and `.ktx2` have more than one.
    pub files: Vec<PathBuf>,
    /// Channels that the format has no place for.
    pub left_out: Vec<String>,
    /// The largest difference of a colour from its place in the palette, in sRGB steps of 1/255; for `.vox`.
    pub color_error: Option<u8>,
}

/// Writes a volume. Files get their names when they are complete; until then they carry `.part` behind them.
///
/// # Errors
/// If the format cannot hold the volume or the system refuses.
pub fn write(path: &Path, format: FileFormat, volume: &SparseVolume) -> Result<FileReport, FileError> {
    write_into(&mut Renamed, path, format, volume)
}

/// As [`write()`], for a program with a way of its own to make files.
///
/// # Errors
/// As [`write()`].
pub fn write_into(
    place: &mut dyn Place,
    path: &Path,
    format: FileFormat,
    volume: &SparseVolume,
) -> Result<FileReport, FileError> {
    format.check(path, volume.grid())?;
    match format {
        FileFormat::Npz => npz::write(place, path, volume),
        FileFormat::Nhdr => nhdr::write(place, path, volume),
        FileFormat::Ktx2 => ktx2::write(place, path, volume),
        FileFormat::Vdb => vdb::write(place, path, volume),
        FileFormat::PlyPoints => ply::write(place, path, volume),
        FileFormat::PlyCubes => cubes::write(place, path, volume),
        FileFormat::Vox => vox::write(place, path, volume),
        FileFormat::Binvox => binvox::write(place, path, volume),
    }
}

/// Channels that a format has no place for.
fn left_out(format: FileFormat, volume: &SparseVolume) -> Vec<String> {
    let names = volume.channels().iter().map(ChannelData::name);
    names.filter(|name| !format.holds(name)).map(str::to_owned).collect()
}
