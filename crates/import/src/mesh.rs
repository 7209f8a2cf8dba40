//! Triangles that a scene file writes out, and the PLY file (Turk 1994, binary, little endian) they are put into.

use std::io::{self, Write};

/// Triangles. The outer side is the one from which a triangle's vertices run counter-clockwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Places of the vertices.
    pub vertices: Vec<[f32; 3]>,
    /// The three vertices of each triangle, by number from 0.
    pub triangles: Vec<[u32; 3]>,
    /// A normal for each vertex, or none at all.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates for each vertex, or none at all.
    pub uvs: Vec<[f32; 2]>,
}

impl Mesh {
    /// Writes the mesh as a PLY file with the properties `x y z`, `nx ny nz` and `u v` of vertices.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_ply(&self, out: &mut impl Write) -> io::Result<()> {
        let mut properties = vec!["x", "y", "z"];
        let has_normals = !self.normals.is_empty();
        let has_uvs = !self.uvs.is_empty();
        if has_normals {
            properties.extend(["nx", "ny", "nz"]);
        }
        if has_uvs {
            properties.extend(["u", "v"]);
        }
        writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", self.vertices.len())?;
        for name in properties {
            writeln!(out, "property float {name}")?;
        }
        writeln!(out, "element face {}", self.triangles.len())?;
        writeln!(out, "property list uchar uint vertex_indices\nend_header")?;
        for (number, vertex) in self.vertices.iter().enumerate() {
            write_floats(out, vertex)?;
            if has_normals {
                write_floats(out, self.normals.get(number).unwrap_or(&[0.0; 3]))?;
            }
            if has_uvs {
                write_floats(out, self.uvs.get(number).unwrap_or(&[0.0; 2]))?;
            }
        }
        for triangle in &self.triangles {
            out.write_all(&[3])?;
            for vertex in triangle {
                out.write_all(&vertex.to_le_bytes())?;
            }
        }
        Ok(())
    }
}

fn write_floats(out: &mut impl Write, values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
}
