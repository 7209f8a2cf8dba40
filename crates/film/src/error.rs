//! What can be wrong with a file of pictures or sums.

use std::io;
use std::path::{Path, PathBuf};

use tyndall_machine::Unfinished;

/// Why a file cannot be read or written, as one line a user can act on.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said; part of the message, and so not its `source` as well.
        error: std::io::Error,
    },
    /// The file cannot be used for what was asked.
    #[error("{}: {what}", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and what to do.
        what: String,
    },
}

impl FileError {
    pub(crate) fn io(path: &Path, error: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), error }
    }

    pub(crate) fn unusable(path: &Path, what: impl Into<String>) -> Self {
        // It may quote what the file says.
        Self::Unusable { path: path.to_owned(), what: what.into().replace(char::is_control, " ") }
    }
}

/// Writes a file through `fill`, replacing what was there in one step.
///
/// # Errors
/// If it cannot be written; what was there is then as before.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut Unfinished<'_>) -> io::Result<()>,
) -> Result<(), FileError> {
    tyndall_machine::write_atomically(path, fill).map_err(|error| FileError::io(path, error))
}
