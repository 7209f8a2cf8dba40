//! What can be wrong with a volume file.

use std::path::PathBuf;

/// Why a volume file cannot be read, as one line a user can act on.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said; part of the message, and so not its `source` as well.
        error: std::io::Error,
    },
    /// The bytes contradict the format: truncated, corrupted, or not such a file.
    #[error("{}: {what}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong and where.
        what: String,
    },
    /// The file is sound, but uses something that is not read here.
    #[error("{}: {what}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not read, and what the user can do instead.
        what: String,
    },
    /// A grid was asked for that the file does not have.
    #[error("{}: no grid named `{name}`; the file has {}", path.display(), available.join(", "))]
    NoSuchGrid {
        /// The file.
        path: PathBuf,
        /// The name asked for.
        name: String,
        /// The names there are, quoted.
        available: Vec<String>,
    },
}

/// Why a volume file cannot be written, as one line a user can act on.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said; part of the message, and so not its `source` as well.
        error: std::io::Error,
    },
    /// What is to be written has no place in the format.
    #[error("{}: {what}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What cannot be written, and what the user can do instead.
        what: String,
    },
}
