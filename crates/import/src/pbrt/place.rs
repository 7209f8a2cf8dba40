//! Where in which file something stands: every message of the importer begins with it.

use std::path::Path;
use std::sync::Arc;

use crate::ImportError;

/// A line of a scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Place {
    /// The file.
    pub file: Arc<Path>,
    /// The line, from 1.
    pub line: usize,
}

impl Place {
    /// An error here.
    pub(super) fn error(&self, message: impl Into<String>) -> ImportError {
        ImportError::at(&self.file, self.line, message)
    }
}
