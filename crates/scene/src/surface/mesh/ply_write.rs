//! Meshes written as .ply files: binary, least byte first, in doubles, so that what is read back is identical.

use std::io::{self, Write};
use std::path::Path;

use tyndall_machine::write_atomically;

use super::Mesh;
use crate::SceneError;

/// Writes `mesh` to `path`; the file takes its name when it is whole.
///
/// # Errors
/// If the file cannot be written.
pub fn write_ply(path: &Path, mesh: &Mesh) -> Result<(), SceneError> {
    let refuse = |error: io::Error| SceneError::file(path, format!("cannot be written: {error}"));
    write_atomically(path, |file| write_to(file, mesh)).map_err(refuse)
}

fn write_to(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    let mut columns = vec!["x", "y", "z"];
    if mesh.normals.is_some() {
        columns.extend(["nx", "ny", "nz"]);
    }
    if mesh.uvs.is_some() {
        columns.extend(["u", "v"]);
    }
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", mesh.positions.len())?;
    for column in columns {
        writeln!(out, "property double {column}")?;
    }
    writeln!(out, "element face {}", mesh.triangles.len())?;
    writeln!(out, "property list uchar uint vertex_indices\nend_header")?;
    for (vertex, position) in mesh.positions.iter().enumerate() {
        // A list that is too short is the caller's mistake; the file is whole all the same.
        let normal = mesh.normals.as_ref().map(|normals| normals.get(vertex).copied().unwrap_or_default());
        let uv = mesh.uvs.as_ref().map(|uvs| uvs.get(vertex).copied().unwrap_or_default());
        let numbers = position.to_array().into_iter();
        let numbers = numbers.chain(normal.into_iter().flat_map(|normal| normal.to_array()));
        for number in numbers.chain(uv.into_iter().flatten()) {
            out.write_all(&number.to_le_bytes())?;
        }
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for corner in triangle {
            out.write_all(&corner.to_le_bytes())?;
        }
    }
    Ok(())
}
