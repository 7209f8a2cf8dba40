//! Files for what has none of its own: meshes and grids that a scene file writes out.

use std::cell::RefCell;
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf, absolute};

use tyndall_volumes::{Grid, WriteOptions};

use crate::{ImportError, Mesh};

/// A folder for meshes and grids; it is made when the first is written.
#[derive(Debug)]
pub struct Sidecar {
    folder: PathBuf,
    names: RefCell<HashSet<String>>,
}

impl Sidecar {
    /// Files will be put into `folder`.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), names: RefCell::default() }
    }

    /// Writes a mesh as a binary .ply file named after `name`; returns its absolute path.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_mesh(&self, name: &str, mesh: &Mesh) -> Result<PathBuf, ImportError> {
        let path = self.path(name, "ply")?;
        let written = File::create(&path).map(BufWriter::new).and_then(|mut out| {
            mesh.write_ply(&mut out)?;
            out.flush()
        });
        written.map_err(|error| unwritable(&path, &error.to_string()))?;
        Ok(path)
    }

    /// Writes a grid as an OpenVDB file named after `name`; returns its absolute path.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_grid(&self, name: &str, grid: &Grid) -> Result<PathBuf, ImportError> {
        let path = self.path(name, "vdb")?;
        tyndall_volumes::write(&path, std::slice::from_ref(grid), &WriteOptions::default())
            .map_err(|error| ImportError::of(&self.folder, error.to_string()))
    }

    /// Writes all that `source` holds into a file named after `name`; returns its absolute path.
    ///
    /// # Errors
    /// If the source cannot be read or the file cannot be written.
    pub fn write_copy(
        &self,
        name: &str,
        extension: &str,
        source: &mut impl Read,
    ) -> Result<PathBuf, ImportError> {
        let path = self.path(name, extension)?;
        let written = File::create(&path).and_then(|mut out| io::copy(source, &mut out));
        written.map_err(|error| unwritable(&path, &error.to_string()))?;
        Ok(path)
    }

    /// An absolute path that no other file of this sidecar has.
    fn path(&self, name: &str, extension: &str) -> Result<PathBuf, ImportError> {
        fs::create_dir_all(&self.folder)
            .and_then(|()| absolute(&self.folder))
            .map_err(|error| unwritable(&self.folder, &error.to_string()))
            .map(|folder| folder.join(self.unique(name, extension)))
    }

    fn unique(&self, name: &str, extension: &str) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let stem: String = name.chars().take(60).map(plain).collect();
        let stem = if stem.is_empty() { "unnamed".to_owned() } else { stem };
        let mut names = self.names.borrow_mut();
        let mut candidate = format!("{stem}.{extension}");
        let mut number = 1;
        // Names that differ by case alone are one file on some systems.
        while !names.insert(candidate.to_ascii_lowercase()) {
            number += 1;
            candidate = format!("{stem}_{number}.{extension}");
        }
        candidate
    }
}

fn unwritable(path: &Path, error: &str) -> ImportError {
    ImportError::of(path, format!("cannot be written: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_differ() {
        let sidecar = Sidecar::new("nowhere");
        assert_eq!(sidecar.unique("../a b", "ply"), "___a_b.ply");
        assert_eq!(sidecar.unique("../a b", "ply"), "___a_b_2.ply");
        assert_eq!(sidecar.unique("../A b", "ply"), "___A_b_3.ply");
        assert_eq!(sidecar.unique("", "vdb"), "unnamed.vdb");
    }
}
