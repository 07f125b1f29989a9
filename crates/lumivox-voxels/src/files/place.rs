//! Where files come to be.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use super::FileError;

/// Something that a file is written into.
pub trait Output: Write + Seek {}

impl<T: Write + Seek> Output for T {}

/// A way to make files.
pub trait Place {
    /// Makes the file of a name and lets `fill`, which is called once, write it.
    ///
    /// # Errors
    /// If the file cannot be made, or what `fill` answers.
    fn make(
        &mut self,
        path: &Path,
        fill: &mut dyn FnMut(&mut dyn Output) -> io::Result<()>,
    ) -> io::Result<()>;
}

/// Files that carry `.part` behind their names until they are complete.
pub(super) struct Renamed;

impl Place for Renamed {
    fn make(
        &mut self,
        path: &Path,
        fill: &mut dyn FnMut(&mut dyn Output) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        let mut write = || {
            let mut file = File::create(&part)?;
            fill(&mut file)?;
            drop(file);
            std::fs::rename(&part, path)
        };
        write().inspect_err(|_| {
            // What is left of it is of no use; that it cannot be removed is no news.
            let _ = std::fs::remove_file(&part);
        })
    }
}

/// Makes a file and lets `body` write it through a buffer.
pub(super) fn create(
    place: &mut dyn Place,
    path: &Path,
    body: impl FnOnce(&mut BufWriter<&mut dyn Output>) -> io::Result<()>,
) -> Result<(), FileError> {
    let mut body = Some(body);
    let mut fill = |out: &mut dyn Output| {
        let Some(body) = body.take() else { return Err(io::Error::other("a file is written once")) };
        let mut out = BufWriter::with_capacity(1 << 18, out);
        body(&mut out)?;
        out.flush()
    };
    place.make(path, &mut fill).map_err(|source| FileError::Io { path: path.to_owned(), source })
}
