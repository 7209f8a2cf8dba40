//! Triangle meshes, and the files they come from: .ply and .obj.

mod file;
mod obj;
mod ply;
mod ply_header;
mod ply_write;
mod polygons;

use glam::DVec3;

pub use self::file::read_mesh;
pub use self::ply_write::write_ply;

/// Coordinates beyond this are taken for a mistake; their products still are finite.
pub(super) const GREATEST_COORDINATE: f64 = 1e30;

/// Triangles that share vertices. The outer side is the one from which a triangle's vertices run counter-clockwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Places of the vertices.
    pub positions: Vec<DVec3>,
    /// A normal for each vertex, of any length; 0 where there is none.
    pub normals: Option<Vec<DVec3>>,
    /// Texture coordinates for each vertex.
    pub uvs: Option<Vec<[f64; 2]>>,
    /// The three vertices of each triangle, by number from 0.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The mesh without triangles of no area, if it is sound: every vertex finite, every triangle of vertices that there
    /// are, and some triangle left.
    ///
    /// # Errors
    /// One line that says what is wrong with which vertex or triangle. What is left out or unused is said in `notes`.
    pub fn checked(mut self, notes: &mut Vec<String>) -> Result<Self, String> {
        let count = self.positions.len();
        let is_sound = |p: &DVec3| p.is_finite() && p.abs().max_element() <= GREATEST_COORDINATE;
        if let Some(vertex) = self.positions.iter().position(|p| !is_sound(p)) {
            let place = self.positions[vertex];
            return Err(format!(
                "vertex {vertex} (from 0) is at {place}: coordinates must be finite and at most 1e30"
            ));
        }
        let names_no_vertex = |corners: &[u32; 3]| corners.iter().any(|&corner| corner as usize >= count);
        if let Some(triangle) = self.triangles.iter().position(names_no_vertex) {
            let corner = self.triangles[triangle].iter().max().copied().unwrap_or(0);
            return Err(format!(
                "triangle {triangle} (from 0) names vertex {corner}, but the {count} vertices are numbered from 0"
            ));
        }
        for (what, length) in [
            ("normals", self.normals.as_ref().map(Vec::len)),
            ("texture coordinates", self.uvs.as_ref().map(Vec::len)),
        ] {
            if length.is_some_and(|length| length != count) {
                return Err(format!("there are {} {what} for {count} vertices", length.unwrap_or(0)));
            }
        }
        if self.uvs.as_ref().is_some_and(|uvs| uvs.iter().flatten().any(|u| !u.is_finite())) {
            notes.push("some texture coordinates are not finite: none are used".into());
            self.uvs = None;
        }
        for normal in self.normals.iter_mut().flatten() {
            *normal = normal.normalize_or_zero();
        }
        let before = self.triangles.len();
        let positions = &self.positions;
        self.triangles.retain(|corners| {
            let [a, b, c] = corners.map(|corner| positions[corner as usize]);
            (b - a).cross(c - a) != DVec3::ZERO
        });
        match before - self.triangles.len() {
            _ if self.triangles.is_empty() => {
                return Err("has no triangle that has an area: nothing of it can be seen".into());
            }
            0 => {}
            1 => notes.push("1 triangle has no area and is left out".into()),
            dropped => notes.push(format!("{dropped} triangles have no area and are left out")),
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn a_mesh_that_cannot_be_traced_is_refused_and_the_fault_named() {
        let refused = |change: fn(&mut Mesh)| {
            let mut mesh = tetrahedron();
            change(&mut mesh);
            mesh.checked(&mut Vec::new()).unwrap_err()
        };
        assert!(refused(|mesh| mesh.positions[2].y = f64::NAN).starts_with("vertex 2 (from 0) is at"));
        assert!(refused(|mesh| mesh.positions[2].y = 1e31).starts_with("vertex 2"));
        let message = refused(|mesh| mesh.triangles[1] = [0, 9, 1]);
        assert!(message.starts_with("triangle 1 (from 0) names vertex 9, but the 4 vertices"), "{message}");
        assert!(refused(|mesh| mesh.triangles.truncate(0)).contains("no triangle"));
        assert!(refused(|mesh| mesh.triangles = vec![[0, 1, 1]]).contains("no triangle"));
        assert!(refused(|mesh| mesh.normals = Some(vec![DVec3::X])).starts_with("there are 1 normals for 4"));
    }

    #[test]
    fn triangles_without_area_are_left_out_and_counted() {
        let mut mesh = tetrahedron();
        mesh.triangles.push([1, 1, 2]);
        let mut notes = Vec::new();
        assert_eq!(mesh.checked(&mut notes).unwrap(), tetrahedron());
        assert_eq!(notes, ["1 triangle has no area and is left out"]);
    }
}
