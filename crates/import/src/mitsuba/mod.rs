//! Scenes of Mitsuba 3 (XML), and of Mitsuba 0.x as far as they are alike.
//!
//! Two steps: `document` reads objects with their properties, `importer` says the same in Tyndall's terms, a file
//! for each class of objects. What Mitsuba's RGB variants render is taken for what the scene means: spectra keep their
//! wavelengths, `<rgb>` is linear Rec. 709.
//!
//! Source: Jakob et al., "Mitsuba 3 renderer", 2022: documentation of the plug-ins, and their code where that is silent.

mod boundaries;
mod document;
mod elements;
mod emitter;
mod grid;
mod importer;
mod material;
mod media;
mod object;
mod phase;
mod sensor;
mod shape;
mod smooth;
mod spectrum;
mod text;
mod texture;
mod transform;

use std::path::Path;

use document::Document;
use importer::Importer;

use crate::{ImportError, Imported, Notes, Sidecar};

/// Reads a Mitsuba scene. `parameters` are names and values that `$name` stands for, before any `<default>`; grids and
/// tables that have to be written anew go to `sidecar`.
///
/// # Errors
/// If a file cannot be read, is no scene, or says what no scene can: one line with file and line.
pub fn import_mitsuba(
    path: &Path,
    sidecar: &Sidecar,
    parameters: &[(String, String)],
) -> Result<Imported, ImportError> {
    let mut notes = Notes::default();
    let document = Document::read(path, parameters, &mut notes)?;
    let (description, notes) = Importer::new(&document, sidecar, notes).scene(path)?;
    Ok(Imported { description: description.with_counted_numbers(), notes: notes.into_vec() })
}
