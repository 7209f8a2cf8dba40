//! Scenes of other renderers as Tyndall's own, with what they write out themselves in files of a folder.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use tyndall_import::{Imported, Note, NoteKind, Sidecar, import_mitsuba, import_pbrt};

use crate::SessionError;

/// How scenes of other renderers are read.
#[derive(Debug, Clone, Default)]
pub struct ImportOptions {
    /// Refuse a scene of which something is not supported.
    pub strict: bool,
    /// What `$NAME` stands for in a Mitsuba scene.
    pub define: Vec<(String, String)>,
}

impl ImportOptions {
    /// Refuses the options for `path`, which is no scene of another renderer.
    ///
    /// # Errors
    /// If any is given.
    pub fn refuse(&self, path: &Path) -> Result<(), SessionError> {
        let option = if self.strict { "--strict" } else { "--define" };
        if self.strict || !self.define.is_empty() {
            return Err(SessionError::refuse_file(
                path,
                format!("{option} is for scenes of other renderers (.pbrt .xml); leave it out"),
            ));
        }
        Ok(())
    }
}

/// Which renderer a scene is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dialect {
    Pbrt,
    Mitsuba,
}

fn dialect(path: &Path) -> Option<Dialect> {
    let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
    match name.strip_suffix(".gz").unwrap_or(&name).rsplit_once('.')?.1 {
        "pbrt" => Some(Dialect::Pbrt),
        "xml" if !name.ends_with(".gz") => Some(Dialect::Mitsuba),
        _ => None,
    }
}

/// Whether a file is a scene of another renderer, by its name.
pub fn is_foreign(path: &Path) -> bool {
    dialect(path).is_some()
}

/// Files that a scene of another renderer wrote out, and which its description names; they last as long as this.
#[derive(Debug)]
pub struct WrittenFiles(TempDir);

impl WrittenFiles {
    /// The files, in the order of their names.
    pub fn paths(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.0.path()).into_iter().flatten();
        let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        paths.sort();
        paths
    }
}

/// Imports the scene at `path`.
///
/// # Errors
/// If it cannot be read, or if something of it is not supported and the options are strict.
pub(crate) fn import(path: &Path, options: &ImportOptions) -> Result<(Imported, WrittenFiles), SessionError> {
    let folder = tempfile::Builder::new()
        .prefix("tyndall-")
        .tempdir()
        .map_err(|error| SessionError::refuse("no temporary folder can be made", error.to_string()))?;
    let sidecar = Sidecar::new(folder.path());
    let imported = match dialect(path) {
        Some(Dialect::Mitsuba) => import_mitsuba(path, &sidecar, &options.define),
        _ if !options.define.is_empty() => {
            return Err(SessionError::refuse_file(
                path,
                "--define is for Mitsuba scenes (.xml); leave it out",
            ));
        }
        _ => import_pbrt(path, &sidecar),
    }?;
    if options.strict {
        refuse_unsupported(&imported.notes)?;
    }
    Ok((imported, WrittenFiles(folder)))
}

fn refuse_unsupported(notes: &[Note]) -> Result<(), SessionError> {
    let is_unsupported = |note: &&Note| note.kind == NoteKind::Unsupported;
    let lines: Vec<String> =
        notes.iter().filter(is_unsupported).map(|note| format!("{note} (--strict)")).collect();
    if lines.is_empty() { Ok(()) } else { Err(SessionError::Unsupported(lines)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_by_their_names() {
        for (name, expected) in [
            ("a.pbrt", Some(Dialect::Pbrt)),
            ("a/b.PBRT.gz", Some(Dialect::Pbrt)),
            ("a.v2.XML", Some(Dialect::Mitsuba)),
            ("a.xml.gz", None),
            ("a.nii.gz", None),
            ("a.toml", None),
            ("pbrt", None),
        ] {
            assert_eq!(dialect(Path::new(name)), expected, "{name}");
        }
    }
}
