//! Where a scene's bytes come from, and how it reaches the files beside it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::{Limits, SceneError};

/// A named file, with its folder if it lies on disk.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    name: String,
    path: Option<PathBuf>,
}

impl Source {
    pub(crate) fn of_path(path: &Path) -> Self {
        Self { name: path.display().to_string(), path: Some(path.to_owned()) }
    }

    pub(crate) fn of_memory(name: &str) -> Self {
        Self { name: name.to_owned(), path: None }
    }

    /// The name that messages use.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// An error of this file's content.
    pub(crate) fn malformed(&self, reason: impl Into<String>) -> SceneError {
        SceneError::Malformed { file: self.name.clone(), reason: reason.into() }
    }

    /// An error of a format's part that is not read here.
    pub(crate) fn unsupported(&self, reason: impl Into<String>) -> SceneError {
        SceneError::Unsupported { file: self.name.clone(), reason: reason.into() }
    }

    /// The bytes of the file itself.
    pub(crate) fn read_self(&self, limits: &Limits) -> Result<Vec<u8>, SceneError> {
        match &self.path {
            Some(path) => read(path, limits),
            None => Err(self.malformed("is in memory and has no file")),
        }
    }

    /// The source that `relative` means in this file. Backslashes count as slashes, as exporters on Windows write them.
    ///
    /// Only paths relative to this file's folder are followed: a scene must not name arbitrary places or hosts.
    pub(crate) fn beside(&self, relative: &str) -> Result<Self, SceneError> {
        let unreadable = |reason: &str| {
            Err(SceneError::Unreadable { file: relative.to_owned(), reason: reason.to_owned() })
        };
        let Some(path) = &self.path else {
            return unreadable(&format!("'{}' was read from memory, without a folder", self.name));
        };
        let relative_path = PathBuf::from(relative.replace('\\', "/"));
        if relative.is_empty() || relative_path.has_root() || relative.contains(':') {
            return unreadable("only paths relative to the scene's folder are followed");
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        Ok(Self::of_path(&folder.join(relative_path)))
    }
}

/// A whole file, refused before it is read if it is too large or no regular file (a pipe or device never ends).
fn read(path: &Path, limits: &Limits) -> Result<Vec<u8>, SceneError> {
    let file = path.display().to_string();
    let unreadable = |reason: String| SceneError::Unreadable { file: file.clone(), reason };
    let info = std::fs::metadata(path).map_err(|e| unreadable(e.to_string()))?;
    if !info.is_file() {
        return Err(unreadable("it is not a regular file".to_owned()));
    }
    crate::mesh::check_limit(&file, "the size in bytes", info.len(), limits.file_bytes)?;
    let mut bytes = Vec::with_capacity(info.len() as usize);
    let opened = File::open(path).map_err(|e| unreadable(e.to_string()))?;
    // `take`: the file may grow between the look at its size and the reading.
    opened.take(info.len()).read_to_end(&mut bytes).map_err(|e| unreadable(e.to_string()))?;
    Ok(bytes)
}
