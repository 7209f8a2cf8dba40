//! Why a scene cannot be imported: one line that names the file, the line and the mend.

use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};

/// Why a scene cannot be imported.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct ImportError {
    /// The file that is wrong.
    pub file: PathBuf,
    /// Its line, from 1, if the fault has one.
    pub line: Option<usize>,
    /// What is wrong, and the mend.
    pub message: String,
}

impl ImportError {
    /// A fault in a line, counted from 1, of a file.
    pub fn at(file: &Path, line: usize, message: impl Into<String>) -> Self {
        Self { file: file.to_path_buf(), line: Some(line), message: message.into() }
    }

    /// A fault of a whole file.
    pub fn of(file: &Path, message: impl Into<String>) -> Self {
        Self { file: file.to_path_buf(), line: None, message: message.into() }
    }

    /// A file that cannot be read.
    pub fn unreadable(file: &Path, error: &io::Error) -> Self {
        Self::of(file, format!("cannot be read: {error}"))
    }
}

impl Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let message = one_line(&self.message);
        match self.line {
            Some(line) => write!(f, "{}:{line}: {message}", self.file.display()),
            None => write!(f, "{}: {message}", self.file.display()),
        }
    }
}

/// A message that may quote what a scene says, which may be of any length and hold line breaks.
pub(crate) fn one_line(message: &str) -> String {
    tyndall_machine::one_line(message, 1000)
}
