//! Why something cannot be rendered or written: one line that names the file or option, and the mend.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use tyndall_film::{FileError, SizeError};
use tyndall_import::ImportError;
use tyndall_scene::SceneError;
use tyndall_volumes::ReadError;

/// Why a session cannot go on. Displays as one line.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SessionError {
    /// A scene is wrong; as a [`Diagnostic`] it shows the place in the file.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// A scene of another renderer is wrong.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// What is not supported of a scene of another renderer that was to be read strictly, one line each.
    #[error("{}", .0.join("; "))]
    Unsupported(Vec<String>),
    /// A volume file cannot be read.
    #[error(transparent)]
    Volume(#[from] ReadError),
    /// A picture or its sums cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The picture is too large.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A thread of a render ended by a mistake in Tyndall.
    #[error("a part of the render failed by a mistake in Tyndall, as told above; please report it")]
    Panicked,
    /// A file is not there.
    #[error("{}: there is no such file; check its name and folder", .0.display())]
    NotFound(PathBuf),
    /// A file, scene or option cannot be used for what was asked.
    #[error("{what}: {why}")]
    Refused {
        /// Its name.
        what: String,
        /// The reason, and the mend.
        why: String,
    },
}

impl SessionError {
    /// The refusal of a file, scene or option of this name.
    pub fn refuse(what: impl Display, why: impl Into<String>) -> Self {
        Self::Refused { what: what.to_string(), why: why.into() }
    }

    /// The refusal of a file.
    pub(crate) fn refuse_file(path: &Path, why: impl Into<String>) -> Self {
        Self::refuse(path.display(), why)
    }
}
