//! Opening a mesh file of whichever format its name says.

use std::path::Path;

use tyndall_machine::{files, memory};

use super::{Mesh, obj, ply};
use crate::SceneError;

/// How much larger a mesh is in memory than in its file, with the tree that finds its triangles: a binary .ply of
/// 32-bit floats has 12 bytes a vertex, which become 24, and 13 a triangle, which become 12, and 64 in the making of its tree.
const GROWTH: u64 = 4;

/// Reads the triangles of a .ply or .obj file. Polygons are cut into triangles; what is left out is said in `notes`.
///
/// Memory is in proportion to the size of the file.
///
/// # Errors
/// If there is no such file, its format is another, or it is damaged: one line that says where.
pub fn read_mesh(path: &Path, notes: &mut Vec<String>) -> Result<Mesh, SceneError> {
    let refuse = |message: String| SceneError::file(path, message);
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let read = match extension.to_ascii_lowercase().as_str() {
        "ply" => ply::read,
        "obj" => obj::read,
        "gltf" | "glb" => {
            return Err(refuse("glTF is not read: export the mesh as .ply, binary, or .obj".into()));
        }
        _ => return Err(refuse("is no mesh by its name: meshes are read from .ply and .obj files".into())),
    };
    let bytes = files::read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            refuse("there is no such file; mend the key `file`, which is relative to the scene file".into())
        }
        _ => refuse(error.to_string()),
    })?;
    let bytes_as_mesh = (bytes.len() as u64).saturating_mul(GROWTH);
    memory::ask(bytes_as_mesh, || format!("the mesh in {} bytes and its tree", bytes.len()))
        .map_err(|error| refuse(error.to_string()))?;
    let mut own = Vec::new();
    let mesh = read(&bytes, &mut own).and_then(|mesh| mesh.checked(&mut own)).map_err(refuse)?;
    notes.extend(own.into_iter().map(|note| format!("{}: {note}", path.display())));
    Ok(mesh)
}
