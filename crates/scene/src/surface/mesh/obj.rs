//! Meshes from .obj files: the lines `v`, `vt`, `vn` and `f`; groups and materials of the file are left aside.
//!
//! A corner `place/texture/normal` counts from 1, or from the end if negative. Format: Wavefront Technologies, "Object
//! Files (.obj)", appendix B1 of the Advanced Visualizer manual.

use std::collections::HashMap;

use glam::DVec3;

use super::Mesh;
use super::polygons::Polygons;

/// Numbers of the place, the texture coordinates and the normal of a corner.
type Corner = (u32, Option<u32>, Option<u32>);

/// Reads a whole file.
///
/// # Errors
/// One line that names the line of the file.
pub(super) fn read(bytes: &[u8], notes: &mut Vec<String>) -> Result<Mesh, String> {
    let text = String::from_utf8_lossy(bytes);
    let mut file = ObjFile::default();
    let mut continued = String::new();
    for (index, line) in text.lines().enumerate() {
        let wrong = |what: String| format!("line {}: {what}", index + 1);
        let line = line.split('#').next().unwrap_or_default().trim_end();
        if let Some(part) = line.strip_suffix('\\') {
            continued.push_str(part);
            continued.push(' ');
        } else if continued.is_empty() {
            file.line(line).map_err(wrong)?;
        } else {
            continued.push_str(line);
            file.line(&std::mem::take(&mut continued)).map_err(wrong)?;
        }
    }
    file.finish(notes)
}

#[derive(Default)]
struct ObjFile {
    places: Vec<DVec3>,
    uvs: Vec<[f64; 2]>,
    normals: Vec<DVec3>,
    /// Numbers of the vertices that corners became.
    vertices: HashMap<Corner, u32>,
    corners: Vec<Corner>,
    polygons: Polygons,
    /// Vertices of the present face.
    face: Vec<u32>,
    materials: usize,
    unread: Option<String>,
}

impl ObjFile {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => self.places.push(DVec3::from_array(numbers(words)?)),
            Some("vn") => self.normals.push(DVec3::from_array(numbers(words)?)),
            // A second coordinate is optional, and so is a third, which only solid textures have.
            Some("vt") => {
                let mut words = words;
                let u = number(words.next())?;
                let v = words.next().map_or(Ok(0.0), |word| number(Some(word)))?;
                self.uvs.push([u, v]);
            }
            Some("f") => {
                self.face.clear();
                for word in words {
                    let corner = self.corner(word)?;
                    let next = self.corners.len() as u32;
                    let vertex = *self.vertices.entry(corner).or_insert(next);
                    if vertex == next {
                        self.corners.push(corner);
                    }
                    self.face.push(vertex);
                }
                self.polygons.push(&self.face);
            }
            Some("usemtl") => self.materials += 1,
            Some(word @ ("curv" | "curv2" | "surf" | "cstype")) => self.unread = Some(word.to_owned()),
            _ => {}
        }
        Ok(())
    }

    fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/');
        let place = index(parts.next().unwrap_or_default(), self.places.len(), "vertices")?;
        let mut optional = |count: usize, what: &str| match parts.next() {
            None | Some("") => Ok(None),
            Some(part) => index(part, count, what).map(Some),
        };
        let uv = optional(self.uvs.len(), "texture coordinates")?;
        let normal = optional(self.normals.len(), "normals")?;
        Ok((place, uv, normal))
    }

    fn finish(self, notes: &mut Vec<String>) -> Result<Mesh, String> {
        if self.materials > 0 {
            notes.push("the materials that the file names are not read: the shape's is used".into());
        }
        if let Some(word) = self.unread {
            notes.push(format!("curves and curved surfaces (`{word}`) are not read"));
        }
        let place = |&(place, _, _): &Corner| self.places[place as usize];
        let uvs = self.corners.iter().map(|corner| corner.1.map(|uv| self.uvs[uv as usize])).collect();
        let normals: Option<Vec<DVec3>> =
            self.corners.iter().map(|corner| corner.2.map(|normal| self.normals[normal as usize])).collect();
        for (what, is_left, has_some) in [
            ("texture coordinates", Option::is_none(&uvs), self.corners.iter().any(|c| c.1.is_some())),
            ("normals", normals.is_none(), self.corners.iter().any(|c| c.2.is_some())),
        ] {
            if is_left && has_some {
                notes.push(format!("some faces have no {what}: none are used"));
            }
        }
        Ok(Mesh {
            positions: self.corners.iter().map(place).collect(),
            normals,
            uvs,
            triangles: self.polygons.finish(notes),
        })
    }
}

/// A number that counts from 1, or backwards from the last; as one from 0.
fn index(word: &str, count: usize, what: &str) -> Result<u32, String> {
    let wrong = || format!("`{word}` is none of the {count} {what} before it, which count from 1");
    let number: i64 = word.parse().map_err(|_| wrong())?;
    let from_zero = if number < 0 { count as i64 + number } else { number - 1 };
    let is_there = from_zero >= 0 && from_zero < count as i64;
    u32::try_from(from_zero).ok().filter(|_| is_there).ok_or_else(wrong)
}

fn numbers<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], String> {
    Ok([number(words.next())?, number(words.next())?, number(words.next())?])
}

fn number(word: Option<&str>) -> Result<f64, String> {
    let word = word.ok_or("a number is missing")?;
    word.parse().map_err(|_| format!("`{}` is not a number", word.chars().take(20).collect::<String>()))
}
