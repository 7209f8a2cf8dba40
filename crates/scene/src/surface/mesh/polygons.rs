//! Polygons cut into triangles that share the first corner, which is exact for convex flat ones.

/// Triangles, collected from polygons.
#[derive(Debug, Default)]
pub(super) struct Polygons {
    /// The triangles so far.
    pub triangles: Vec<[u32; 3]>,
    /// Polygons of fewer than three corners.
    without_area: usize,
}

impl Polygons {
    /// Adds the polygon of these corners.
    pub fn push(&mut self, corners: &[u32]) {
        match corners {
            [first, second, rest @ ..] if !rest.is_empty() => {
                let mut before = *second;
                for &corner in rest {
                    self.triangles.push([*first, before, corner]);
                    before = corner;
                }
            }
            _ => self.without_area += 1,
        }
    }

    /// The triangles; tells of polygons that were none.
    pub fn finish(self, notes: &mut Vec<String>) -> Vec<[u32; 3]> {
        match self.without_area {
            0 => {}
            1 => notes.push("1 face has fewer than 3 corners and is left out".into()),
            faces => notes.push(format!("{faces} faces have fewer than 3 corners and are left out")),
        }
        self.triangles
    }
}
