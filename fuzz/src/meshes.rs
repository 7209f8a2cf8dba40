//! Meshes from files, and their tree of boxes.

use tyndall_scene::surface::read_mesh;

use crate::folder::Folder;
use crate::{Outcome, assert_message};

/// Polygon files, in text and in both byte orders.
pub(crate) fn ply(bytes: &[u8]) -> Outcome {
    mesh("a.ply", bytes)
}

/// Wavefront's text files.
pub(crate) fn obj(bytes: &[u8]) -> Outcome {
    mesh("a.obj", bytes)
}

fn mesh(name: &str, bytes: &[u8]) -> Outcome {
    let folder = Folder::with(name, bytes);
    let mut notes = Vec::new();
    match read_mesh(&folder.path(name), &mut notes) {
        Ok(mesh) => {
            let vertex = size_of_val(&mesh.positions[0]) + if mesh.normals.is_some() { 24 } else { 0 };
            let content = mesh.positions.len() * (vertex + 16) + size_of_val(&*mesh.triangles);
            notes.iter().for_each(|note| assert_message(note));
            Outcome::Read(content)
        }
        Err(error) => Outcome::refused(&error),
    }
}
