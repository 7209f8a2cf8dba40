//! What went wrong inside a reader, before the file's name is known to the message.
//!
//! Readers work on streams and buffers; the dispatcher, which knows the path, turns a [`Fault`] into a
//! [`ReadError`].

use std::io;
use std::path::Path;

use tyndall_machine::memory::MemoryError;

use crate::ReadError;

/// A [`ReadError`] that lacks its path.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The operating system refused.
    Io(io::Error),
    /// The bytes contradict the format.
    Damaged(String),
    /// Sound, but not read here; the text holds the mend.
    Unsupported(String),
}

impl Fault {
    /// A fault of the bytes.
    pub(crate) fn damaged(what: impl Into<String>) -> Self {
        Self::Damaged(what.into())
    }

    /// A fault of our reader.
    pub(crate) fn unsupported(what: impl Into<String>) -> Self {
        Self::Unsupported(what.into())
    }

    /// The error a user sees, with the file it is about.
    pub(crate) fn at(self, path: &Path) -> ReadError {
        let path = path.to_path_buf();
        match self {
            Self::Io(error) => ReadError::Io { path, error },
            Self::Damaged(what) => ReadError::Damaged { path, what: one_line(&what) },
            Self::Unsupported(what) => ReadError::Unsupported { path, what: one_line(&what) },
        }
    }
}

impl From<MemoryError> for Fault {
    fn from(error: MemoryError) -> Self {
        Self::Io(error.into())
    }
}

/// Letters of a text of a file in a message at most.
const LONGEST: usize = 500;

/// A text of a file as part of a message.
pub(crate) fn one_line(text: &str) -> String {
    tyndall_machine::one_line(text, LONGEST)
}

/// An early end and undecodable compressed data are damage, not failures of the system.
impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::damaged("truncated: the file ends before its data do"),
            io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => Self::Damaged(error.to_string()),
            _ => Self::Io(error),
        }
    }
}
