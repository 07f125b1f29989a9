//! What can go wrong. Each message is one sentence with what was found and what is wanted.

use std::path::Path;

/// Why a field could not be baked, written or read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// A setting outside its choices.
    #[error("the {what} '{given}' is not supported; it must be one of {allowed}")]
    Unsupported {
        /// The setting.
        what: &'static str,
        /// The value given.
        given: String,
        /// The values there are.
        allowed: &'static str,
    },
    /// The mesh cannot be baked.
    #[error("the mesh cannot be baked: {reason}")]
    BadMesh {
        /// What is wrong with it, with numbers.
        reason: String,
    },
    /// The caller stopped the bake. What was written to a file waits for the next one.
    #[error("baking was cancelled after {done} of {total} maps")]
    Cancelled {
        /// Maps finished.
        done: u32,
        /// Maps of the field.
        total: u32,
    },
    /// The field does not fit in memory.
    #[error("a field of {bytes} bytes does not fit in memory")]
    OutOfMemory {
        /// Bytes asked for.
        bytes: u64,
    },
    /// The system refused to read or write a file.
    #[error("{file}: {action} failed: {reason}")]
    Io {
        /// The file.
        file: String,
        /// What was tried.
        action: &'static str,
        /// What the system said.
        reason: String,
    },
    /// Another bake is writing the same file.
    #[error("{file}: another bake is writing this file")]
    Busy {
        /// The file.
        file: String,
    },
    /// Not a field at all.
    #[error("{file}: not a visibility field")]
    NotAField {
        /// The file.
        file: String,
    },
    /// Written by a newer version of this library, or an older one whose files are no longer read.
    #[error("{file}: this field has version {found} of the format; version {known} is read here")]
    Version {
        /// The file.
        file: String,
        /// Its version.
        found: u32,
        /// Ours.
        known: u32,
    },
    /// The file is shorter or longer than its header says.
    #[error("{file}: the file has {found} bytes instead of {expected}")]
    Size {
        /// The file.
        file: String,
        /// Bytes by the header.
        expected: u64,
        /// Bytes there are.
        found: u64,
    },
    /// The bytes are not those that were written.
    #[error("{file}: the file is damaged: {reason}")]
    Damaged {
        /// The file.
        file: String,
        /// What disagrees, and where.
        reason: String,
    },
}

impl FieldError {
    pub(crate) fn io(file: &Path, action: &'static str, error: &std::io::Error) -> Self {
        Self::Io { file: file.display().to_string(), action, reason: error.to_string() }
    }

    pub(crate) fn damaged(file: &Path, reason: impl Into<String>) -> Self {
        Self::Damaged { file: file.display().to_string(), reason: reason.into() }
    }
}
