//! What can go wrong on the way to a scene. Each message is one sentence with the file and the reason.

use crate::{builtin, import};

/// Why a scene could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// `builtin:NAME` with a name that is not in [`builtin::NAMES`].
    #[error("there is no built-in scene '{name}'; known are {}", builtin::NAMES.join(", "))]
    UnknownBuiltin {
        /// The name asked for.
        name: String,
    },
    /// `builtin:NAME:DETAIL` with something other than a number from 0 to 4.
    #[error(
        "'{given}' is no detail level of '{name}'; give a whole number from 0 to {}",
        builtin::MAX_DETAIL
    )]
    BadDetail {
        /// The built-in scene.
        name: String,
        /// The text given as its detail level.
        given: String,
    },
    /// A file name whose extension no importer claims.
    #[error("{file}: unknown file type '{extension}'; supported are {}", import::EXTENSIONS.join(" "))]
    UnknownExtension {
        /// The file.
        file: String,
        /// Its extension, without the dot; empty if it has none.
        extension: String,
    },
    /// The file, or one that it needs, cannot be read.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system said.
        reason: String,
    },
    /// The bytes do not follow their format.
    #[error("{file}: {reason}")]
    Malformed {
        /// The file.
        file: String,
        /// What is wrong, and where.
        reason: String,
    },
    /// The file is within its format but uses a part of it that is not read here.
    #[error("{file}: {reason} is not supported")]
    Unsupported {
        /// The file.
        file: String,
        /// The part.
        reason: String,
    },
    /// The file asks for more than the [`Limits`](crate::Limits) allow; nothing was allocated for it.
    #[error("{file}: {what} is {found}, more than the limit of {limit}")]
    TooLarge {
        /// The file.
        file: String,
        /// What there is too much of, with its unit.
        what: &'static str,
        /// How much the file asks for.
        found: u64,
        /// How much is allowed.
        limit: u64,
    },
    /// A third-party parser gave up in a way that is its own fault.
    #[error("{file}: the {parser} reader failed on this file: {reason}")]
    Parser {
        /// The file.
        file: String,
        /// The parser.
        parser: &'static str,
        /// The message of its panic.
        reason: String,
    },
}
