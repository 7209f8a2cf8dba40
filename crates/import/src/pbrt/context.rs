//! What all parts of an import share: where files are, where files go, and what the user is told.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use super::directives::Entity;
use super::place::Place;
use crate::{ImportError, Note, Notes, Sidecar};

/// Shared by all parts of an import.
#[derive(Debug)]
pub(super) struct Context<'a> {
    /// Folder of the scene file: all file names are relative to it, those in included files too.
    folder: PathBuf,
    /// Where meshes and grids go.
    pub sidecar: &'a Sidecar,
    notes: RefCell<Notes>,
}

impl<'a> Context<'a> {
    /// For the scene file at an absolute path.
    pub(super) fn new(path: &Path, sidecar: &'a Sidecar) -> Self {
        let folder = path.parent().unwrap_or(Path::new("/")).to_path_buf();
        Self { folder, sidecar, notes: RefCell::default() }
    }

    /// Tells of something that is not supported.
    pub(super) fn unsupported(&self, place: &Place, message: impl Into<String>) {
        self.notes.borrow_mut().unsupported(&place.file, place.line, message);
    }

    /// Tells of a decision that leaves the picture what it is.
    pub(super) fn choice(&self, place: &Place, message: impl Into<String>) {
        self.notes.borrow_mut().choice(&place.file, place.line, message);
    }

    /// Tells which parameters of a thing were left out.
    pub(super) fn tell_unused(&self, what: &str, entity: &Entity) {
        for parameter in entity.parameters.unused() {
            let message = format!("`{}` of {what} \"{}\" is left out", parameter.name, entity.kind);
            self.unsupported(&parameter.place, message);
        }
    }

    /// Absolute path of a file that the scene names.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        let joined = self.folder.join(name);
        std::path::absolute(&joined).unwrap_or(joined)
    }

    /// The same for a file that must be there, as a string for a description.
    pub(super) fn file(&self, name: &str, place: &Place) -> Result<String, ImportError> {
        let path = self.path(name);
        match path.metadata() {
            Ok(found) if found.is_file() => text_of(&path, place),
            Ok(_) => Err(place.error(format!("{} is no file: name one", path.display()))),
            Err(error) => Err(place.error(format!("{} cannot be read: {error}", path.display()))),
        }
    }

    /// All that was told.
    pub(super) fn into_notes(self) -> Vec<Note> {
        self.notes.into_inner().into_vec()
    }
}

/// A path for a description, which is text.
pub(super) fn text_of(path: &Path, place: &Place) -> Result<String, ImportError> {
    let text = path.to_str().map(str::to_owned);
    text.ok_or_else(|| place.error(format!("{} is no UTF-8: rename the file or folder", path.display())))
}
