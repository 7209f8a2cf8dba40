//! Scenes of other renderers as Tyndall's own.
//!
//! An importer reads a scene file of another program and says the same as a [`SceneDescription`], which is then built,
//! rendered or written like any other. What has no file of its own in the other's format (meshes and grids written out
//! in the scene file) is put into files beside it ([`Sidecar`]). What cannot be said is told in a [`Note`] each.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod affine;
mod error;
mod include_chain;
mod mesh;
pub mod mitsuba;
mod note;
mod packed;
pub mod pbrt;
mod sidecar;

use tyndall_scene::SceneDescription;

pub use error::ImportError;
pub use mesh::Mesh;
pub use mitsuba::import_mitsuba;
pub use note::{Note, NoteKind, Notes};
pub use pbrt::import_pbrt;
pub use sidecar::Sidecar;

/// A scene of another program.
#[derive(Debug, Clone)]
pub struct Imported {
    /// The scene, with all files named by absolute path.
    pub description: SceneDescription,
    /// What was left out or decided on the way, in the order of the file.
    pub notes: Vec<Note>,
}
