//! Meshes from .ply files: text, and binary of both byte orders.
//!
//! Of the element `vertex` the properties x, y, z, nx, ny, nz and (u, v), (s, t), (texture_u, texture_v) or
//! (texture_s, texture_t) are read, of `face` the list `vertex_indices` or `vertex_index`. Format: Greg Turk, "The PLY
//! Polygon File Format" (1994).

use glam::DVec3;

use super::Mesh;
use super::ply_header::{Element, Encoding, Header, Number};
use super::polygons::Polygons;

/// Reads a whole file.
///
/// # Errors
/// One line that says which row of which element is wrong.
pub(super) fn read(bytes: &[u8], notes: &mut Vec<String>) -> Result<Mesh, String> {
    let header = Header::parse(bytes)?;
    let mut body = Body { encoding: header.encoding, bytes: &bytes[header.length..] };
    let mut mesh = Mesh::default();
    let mut polygons = Polygons::default();
    let (mut has_vertices, mut has_faces) = (false, false);
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" if !has_vertices => {
                has_vertices = true;
                vertices(&mut body, element, &mut mesh)?;
            }
            "face" if !has_faces => {
                has_faces = true;
                faces(&mut body, element, &mut polygons)?;
            }
            "tristrips" => {
                return Err("holds strips of triangles (`tristrips`): export it with faces instead".into());
            }
            _ => body.rows(element, |_, _| Ok(()))?,
        }
    }
    match (has_vertices, has_faces) {
        (false, _) => return Err("has no element `vertex`: it is not a mesh".into()),
        (_, false) => return Err("has no element `face`: it is a cloud of points, not a mesh".into()),
        _ => {}
    }
    mesh.triangles = polygons.finish(notes);
    Ok(mesh)
}

fn vertices(body: &mut Body<'_>, element: &Element, mesh: &mut Mesh) -> Result<(), String> {
    let all = |names: [&str; 3]| {
        let [a, b, c] = names.map(|name| element.find(&[name], false));
        Some([a?, b?, c?])
    };
    let place = all(["x", "y", "z"]).ok_or("the element `vertex` lacks one of x, y, z")?;
    let normal = all(["nx", "ny", "nz"]);
    let uv = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]]
        .into_iter()
        .find_map(|[u, v]| Some([element.find(&[u], false)?, element.find(&[v], false)?]));
    let capacity = body.capacity(element);
    mesh.positions.reserve_exact(capacity);
    let mut normals = normal.map(|_| Vec::with_capacity(capacity));
    let mut uvs = uv.map(|_| Vec::with_capacity(capacity));
    body.rows(element, |row, _| {
        let vector = |columns: [usize; 3]| DVec3::from_array(columns.map(|column| row.numbers[column]));
        mesh.positions.push(vector(place));
        if let (Some(normals), Some(columns)) = (&mut normals, normal) {
            normals.push(vector(columns));
        }
        if let (Some(uvs), Some(columns)) = (&mut uvs, uv) {
            uvs.push(columns.map(|column| row.numbers[column]));
        }
        Ok(())
    })?;
    (mesh.normals, mesh.uvs) = (normals, uvs);
    Ok(())
}

fn faces(body: &mut Body<'_>, element: &Element, polygons: &mut Polygons) -> Result<(), String> {
    let column = element
        .find(&["vertex_indices", "vertex_index"], true)
        .ok_or("the element `face` lacks the list `vertex_indices`")?;
    polygons.triangles.reserve_exact(body.capacity(element));
    let mut corners = Vec::new();
    body.rows(element, |row, number| {
        corners.clear();
        for &index in &row.lists[column] {
            // Larger ones are no vertices either; the check of the whole mesh names those that fit.
            if !(0.0..=f64::from(u32::MAX)).contains(&index) || index.fract() != 0.0 {
                return Err(format!("face {number} (from 0) names vertex {index}, and there is none such"));
            }
            corners.push(index as u32);
        }
        polygons.push(&corners);
        Ok(())
    })
}

/// The values of one row; a column has a number or a list.
struct Row {
    numbers: Vec<f64>,
    lists: Vec<Vec<f64>>,
}

/// What is left of a file.
struct Body<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
}

impl Body<'_> {
    /// Rows of `element` that there can be in what is left.
    fn capacity(&self, element: &Element) -> usize {
        element.count.min(self.bytes.len() / element.least_size(self.encoding).max(1) + 1)
    }

    /// Shows each row of `element`, with its number, to `visit`.
    fn rows(
        &mut self,
        element: &Element,
        mut visit: impl FnMut(&Row, usize) -> Result<(), String>,
    ) -> Result<(), String> {
        // Rows without columns take no bytes, so that their number could be anything.
        if element.properties.is_empty() {
            return Ok(());
        }
        let columns = element.properties.len();
        let mut row = Row { numbers: vec![0.0; columns], lists: vec![Vec::new(); columns] };
        for number in 0..element.count {
            self.row(element, &mut row).map_err(|what| {
                format!("{what} in `{}` {number} (from 0) of {}", element.name, element.count)
            })?;
            visit(&row, number)?;
        }
        Ok(())
    }

    fn row(&mut self, element: &Element, row: &mut Row) -> Result<(), String> {
        for (column, property) in element.properties.iter().enumerate() {
            let Some(length) = property.length else {
                row.numbers[column] = self.number(property.number)?;
                continue;
            };
            let length = self.number(length)?;
            let list = &mut row.lists[column];
            list.clear();
            // The list grows with what is read: a length that the file does not hold ends at its end.
            if !(0.0..=f64::from(u32::MAX)).contains(&length) || length.fract() != 0.0 {
                return Err(format!("a list has the length {length}"));
            }
            for _ in 0..length as u64 {
                list.push(self.number(property.number)?);
            }
        }
        Ok(())
    }

    fn number(&mut self, kind: Number) -> Result<f64, String> {
        match self.encoding {
            Encoding::Ascii => self.word(),
            Encoding::LittleEndian => Ok(self.binary(kind, false).ok_or("the file ends")?),
            Encoding::BigEndian => Ok(self.binary(kind, true).ok_or("the file ends")?),
        }
    }

    fn word(&mut self) -> Result<f64, String> {
        let start = self.bytes.trim_ascii_start();
        let length = start.iter().position(u8::is_ascii_whitespace).unwrap_or(start.len());
        let (word, rest) = start.split_at(length);
        self.bytes = rest;
        if word.is_empty() {
            return Err("the file ends".into());
        }
        let parsed = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        parsed.ok_or_else(|| {
            let shown: String = String::from_utf8_lossy(word).chars().take(20).collect();
            format!("`{shown}` is not a number")
        })
    }

    fn binary(&mut self, kind: Number, is_big: bool) -> Option<f64> {
        let (word, rest) = self.bytes.split_at_checked(kind.size())?;
        self.bytes = rest;
        let mut bytes = [0_u8; 8];
        bytes[..word.len()].copy_from_slice(word);
        if is_big {
            bytes[..word.len()].reverse();
        }
        let [a, b, c, d, ..] = bytes;
        Some(match kind {
            Number::I8 => f64::from(a as i8),
            Number::U8 => f64::from(a),
            Number::I16 => f64::from(i16::from_le_bytes([a, b])),
            Number::U16 => f64::from(u16::from_le_bytes([a, b])),
            Number::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Number::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Number::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Number::F64 => f64::from_le_bytes(bytes),
        })
    }
}
