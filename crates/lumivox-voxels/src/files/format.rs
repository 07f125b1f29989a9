//! The file formats, and what can be known of their files beforehand.

use std::path::{Path, PathBuf};

use lumivox_core::Grid;

use super::{FileError, nhdr, vox};

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
    /// The ends of file names that are written, without the dot.
    pub const EXTENSIONS: [&str; 7] = ["npz", "vox", "binvox", "ply", "vdb", "nhdr", "ktx2"];

    /// The format of a file's name, by its end; points for `.ply`.
    pub fn of_path(path: &Path) -> Option<Self> {
        Self::of_extension(path.extension()?.to_str()?)
    }

    /// The format of the end of a file's name, without the dot, in upper or lower case; points for `ply`.
    pub fn of_extension(extension: &str) -> Option<Self> {
        Some(match extension.to_ascii_lowercase().as_str() {
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

    /// The end of its files' names, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Npz => "npz",
            Self::Nhdr => "nhdr",
            Self::Ktx2 => "ktx2",
            Self::Vdb => "vdb",
            Self::PlyPoints | Self::PlyCubes => "ply",
            Self::Vox => "vox",
            Self::Binvox => "binvox",
        }
    }

    /// Whether there is a place for a channel of this name.
    pub fn holds(self, channel: &str) -> bool {
        match self {
            Self::Vox => channel == "albedo",
            Self::Binvox => false,
            _ => true,
        }
    }

    /// Whether a grid can be written, as far as its size tells.
    ///
    /// # Errors
    /// If not, with the numbers.
    pub fn check(self, path: &Path, grid: &Grid) -> Result<(), FileError> {
        let n = grid.dims;
        if self == Self::Vox && n.max_element() > vox::WORLD {
            let world = vox::WORLD;
            let reason = format!(
                "{} x {} x {} cells, and a .vox file holds {world} along an axis at most",
                n.x, n.y, n.z
            );
            return Err(FileError::Limit { path: path.to_owned(), reason });
        }
        Ok(())
    }

    /// All files that are written for `path` and channels of these names.
    pub fn files(self, path: &Path, channels: &[&str]) -> Vec<PathBuf> {
        let mut files = vec![path.to_owned()];
        match self {
            Self::Nhdr => {
                files.push(nhdr::raw(path));
                for channel in channels {
                    files.extend([beside(path, channel, "nhdr"), beside(path, channel, "raw")]);
                }
            }
            Self::Ktx2 => files.extend(channels.iter().map(|channel| beside(path, channel, "ktx2"))),
            _ => {}
        }
        files
    }
}

/// `model.nhdr` and `albedo` to `model.albedo.nhdr`.
pub(super) fn beside(path: &Path, channel: &str, extension: &str) -> PathBuf {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    // A channel's name may hold anything; in a file's name only what all systems take.
    let safe = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let channel: String = channel.chars().map(safe).collect();
    path.with_file_name(format!("{stem}.{channel}.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_extension_has_its_format_and_leads_back() {
        for extension in FileFormat::EXTENSIONS {
            let format = FileFormat::of_extension(&extension.to_uppercase());
            assert_eq!(format.map(FileFormat::extension), Some(extension));
        }
        assert_eq!(FileFormat::of_path(Path::new("a.b/c.vdb")), Some(FileFormat::Vdb));
        assert_eq!(FileFormat::of_path(Path::new("vdb")), None);
    }
}
