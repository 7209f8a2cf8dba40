//! pbrt-v4's scene files.

use std::path::Path;

use crate::{ImportError, Imported, Sidecar};

/// Reads a pbrt-v4 scene; meshes and grids that it writes out are put into `sidecar`.
///
/// # Errors
/// If a file cannot be read, is no scene, or names what is not there; the message has file and line.
pub fn import_pbrt(path: &Path, sidecar: &Sidecar) -> Result<Imported, ImportError> {
    let _ = sidecar;
    Err(ImportError::of(path, "scenes of pbrt are not read yet"))
}
