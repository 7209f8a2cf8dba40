//! Errors as Python exceptions, with the same one line that the command prints.
//!
//! `tyndall.Error` is a `ValueError`; `tyndall.FileError`, for what the operating system refuses, is an `OSError` as well. Both are
//! written in Python (`_errors.py`), as only there a class can have two such bases.

use std::fmt::Display;

use pyo3::PyErr;
use tyndall_session::SessionError;

mod classes {
    use pyo3::import_exception;

    import_exception!(tyndall._errors, Error);
    import_exception!(tyndall._errors, FileError);
}

/// Something that the user gave is wrong.
pub(crate) fn wrong(message: impl Display) -> PyErr {
    classes::Error::new_err(message.to_string())
}

/// A file cannot be read or written.
pub(crate) fn file(message: impl Display) -> PyErr {
    classes::FileError::new_err(message.to_string())
}

/// What is wrong with a volume file.
pub(crate) fn of_volume(error: tyndall_volumes::ReadError) -> PyErr {
    match &error {
        tyndall_volumes::ReadError::Io { .. } => file(error),
        _ => wrong(error),
    }
}

/// Why a volume cannot be written.
pub(crate) fn of_writing(error: tyndall_volumes::WriteError) -> PyErr {
    match &error {
        tyndall_volumes::WriteError::Io { .. } => file(error),
        tyndall_volumes::WriteError::Unwritable { .. } => wrong(error),
    }
}

/// What is wrong with a file of sums or a picture.
pub(crate) fn of_picture(error: tyndall_film::FileError) -> PyErr {
    match &error {
        tyndall_film::FileError::Io { .. } => file(error),
        tyndall_film::FileError::Unusable { .. } => wrong(error),
    }
}

/// Why something cannot be opened, rendered or written.
pub(crate) fn of_session(error: SessionError) -> PyErr {
    match error {
        SessionError::Volume(error) => of_volume(error),
        SessionError::File(error) => of_picture(error),
        SessionError::NotFound(_) => file(error),
        error => wrong(error),
    }
}
