//! What several tests ask of grids, and where the shared volumes are.

use std::path::PathBuf;

use tyndall_volumes::{Codec, Grid, GridValues, Tree, WriteOptions};

/// The tree of a grid of floats.
#[track_caller]
pub fn float(grid: &Grid) -> &Tree<f32> {
    match &grid.values {
        GridValues::Float(tree) => tree,
        other => panic!("not a float grid: {other:?}"),
    }
}

/// A file of the shared folder, or `None` (said on stderr) if the folder is absent.
pub fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there", path.display());
    None
}

/// Floats in full, compressed by `codec`.
pub fn options(codec: Codec) -> WriteOptions {
    WriteOptions { codec, half: false }
}
