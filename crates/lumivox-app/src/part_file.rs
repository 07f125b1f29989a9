//! Files on their way: written under a temporary name, renamed when they are whole, and removed when they never will be.
//!
//! All temporary names are known in one place, so that an interrupt can remove what they stand for. A file is made and renamed
//! while that list is held; whoever holds it and ends the program leaves either the old file or the new one.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of paths is sound wherever a panic struck.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all files that are not whole, then ends the program. No other file is begun or finished in between.
pub(crate) fn remove_all_and(end: impl FnOnce()) {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // The program ends either way.
        let _ = fs::remove_file(path);
    }
    end();
}

/// A file that takes its place with [`Self::finish`] and is gone without.
#[derive(Debug)]
pub(crate) struct PartFile {
    file: BufWriter<Watched>,
    target: PathBuf,
    /// None where writing goes straight into a device or a pipe.
    temporary: Option<PathBuf>,
}

impl PartFile {
    /// Begins a file. What a link leads to is replaced, not the link; devices and pipes are written into.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        if is_device(path) {
            // Not while the list is held: a pipe waits here for its reader.
            let file = File::options().write(true).open(path)?;
            return Ok(Self { file: Watched::buffered(file), target: path.to_owned(), temporary: None });
        }
        let target = target_of(path)?;
        let mut unfinished = unfinished();
        let (file, temporary) = create_beside(&target)?;
        unfinished.push(temporary.clone());
        Ok(Self { file: Watched::buffered(file), target, temporary: Some(temporary) })
    }

    /// Whether a file of this name could be written, as far as that can be known without harm to one that is there.
    pub(crate) fn check(path: &Path) -> io::Result<()> {
        if is_device(path) { Ok(()) } else { Self::create(path).map(drop) }
    }

    /// The first write that failed, for an error in better words than those of a library on top.
    pub(crate) fn failure(&mut self) -> Option<io::Error> {
        self.file.get_mut().failure.take()
    }

    /// Writes what is left, waits until it is on the disk, and gives the file its name.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.file.flush()?;
        if let Some(failure) = self.failure() {
            return Err(failure);
        }
        let Some(temporary) = &self.temporary else { return Ok(()) };
        // Some disks tell only now that they are full.
        self.file.get_ref().file.sync_all()?;
        let mut unfinished = unfinished();
        fs::rename(temporary, &self.target)?;
        unfinished.retain(|path| path != temporary);
        Ok(())
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let Some(temporary) = &self.temporary else { return };
        let mut unfinished = unfinished();
        if let Some(n) = unfinished.iter().position(|path| path == temporary) {
            unfinished.swap_remove(n);
            // Whatever was written is of no use; that it cannot be removed either changes nothing.
            let _ = fs::remove_file(temporary);
        }
    }
}

impl Write for PartFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for PartFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// A file that remembers its first failure, since encoders that end in a destructor cannot tell of theirs.
#[derive(Debug)]
struct Watched {
    file: File,
    failure: Option<io::Error>,
}

impl Watched {
    fn buffered(file: File) -> BufWriter<Self> {
        BufWriter::with_capacity(1 << 16, Self { file, failure: None })
    }

    fn watch<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result
            && error.kind() != io::ErrorKind::Interrupted
            && self.failure.is_none()
        {
            self.failure = Some(copy(error));
        }
        result
    }
}

impl Write for Watched {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.file.write(bytes);
        self.watch(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.file.flush();
        self.watch(result)
    }
}

impl Seek for Watched {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let result = self.file.seek(to);
        self.watch(result)
    }
}

fn copy(error: &io::Error) -> io::Error {
    error.raw_os_error().map_or_else(|| io::Error::from(error.kind()), io::Error::from_raw_os_error)
}

/// Whether there is something that is neither a file nor a folder.
fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir())
}

/// The file itself behind any links.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_symlink() => fs::canonicalize(path).map_err(|error| {
            io::Error::new(error.kind(), format!("it is a link that leads nowhere ({error})"))
        }),
        Ok(_) => Ok(path.to_owned()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(path.to_owned()),
        Err(error) => Err(error),
    }
}

/// A new file in the same folder. Its name does not grow with the target's, which may be as long as names can be.
fn create_beside(target: &Path) -> io::Result<(File, PathBuf)> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let temporary = target.with_file_name(format!(".lumivox-{}-{number}.part", std::process::id()));
        match File::options().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((file, temporary)),
            // Left behind by a program of the same number that was killed.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}
