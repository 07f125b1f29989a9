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
mod ktx2;
mod layers;
mod nhdr;
mod npz;
mod palette;
mod ply;
mod vdb;
mod vox;
mod zip;

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

pub use palette::srgb_from_linear;

use crate::SparseVolume;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// NumPy arrays in a zip file.
    Npz,
    /// NRRD with raw files beside it.
    Nhdr,
    /// Khronos textures.
    Ktx2,
    /// OpenVDB.
    Vdb,
    /// Stanford PLY with a point per cell.
    PlyPoints,
    /// Stanford PLY with the outer faces of the cells.
    PlyCubes,
    /// MagicaVoxel.
    Vox,
    /// Run-length encoded occupancy.
    Binvox,
}

impl FileFormat {
    /// The format of a file's name, by its end; points for `.ply`.
    pub fn of_path(path: &Path) -> Option<Self> {
        Some(match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "npz" => Self::Npz,
            "nhdr" => Self::Nhdr,
            "ktx2" => Self::Ktx2,
            "vdb" => Self::Vdb,
            "ply" => Self::PlyPoints,
            "vox" => Self::Vox,
            "binvox" => Self::Binvox,
            _ => return None,
        })
    }
}

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
    match format {
        FileFormat::Npz => npz::write(path, volume),
        FileFormat::Nhdr => nhdr::write(path, volume),
        FileFormat::Ktx2 => ktx2::write(path, volume),
        FileFormat::Vdb => vdb::write(path, volume),
        FileFormat::PlyPoints => ply::write(path, volume),
        FileFormat::PlyCubes => cubes::write(path, volume),
        FileFormat::Vox => vox::write(path, volume),
        FileFormat::Binvox => binvox::write(path, volume),
    }
}

/// Creates a file, lets `body` fill it, and gives it its name.
fn create(
    path: &Path,
    body: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), FileError> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    let fill = || {
        let mut file = BufWriter::with_capacity(1 << 18, File::create(&part)?);
        body(&mut file)?;
        file.flush()?;
        drop(file);
        std::fs::rename(&part, path)
    };
    fill().map_err(|source| {
        // What is left of it is of no use; that it cannot be removed is no news.
        let _ = std::fs::remove_file(&part);
        FileError::Io { path: path.to_owned(), source }
    })
}

/// `model.nhdr` and `albedo` to `model.albedo.nhdr`.
fn beside(path: &Path, channel: &str, extension: &str) -> PathBuf {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    // A channel's name may hold anything; in a file's name only what all systems take.
    let safe = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let channel: String = channel.chars().map(safe).collect();
    path.with_file_name(format!("{stem}.{channel}.{extension}"))
}

/// Names of all channels but `kept`.
fn left_out(volume: &SparseVolume, kept: &[&str]) -> Vec<String> {
    let names = volume.channels().iter().map(|channel| channel.name());
    names.filter(|name| !kept.contains(name)).map(str::to_owned).collect()
}
