//! Normals of meshes that have none.
//!
//! Mitsuba gives a mesh without normals those of its vertices: the mean of the normals of the triangles around, weighted
//! with their angles there (Thürmer and Wüthrich 1998); only with `face_normals` does it look flat.

use std::collections::HashMap;
use std::path::Path;

use glam::DVec3;
use tyndall_scene::angle_between;
use tyndall_scene::surface::read_mesh;

use crate::{ImportError, Mesh, Sidecar};

/// A file with the mesh and normals, if the file of the mesh has none. With `joins` vertices at one place share theirs.
pub(super) fn with_normals(
    path: &Path,
    joins: bool,
    sidecar: &Sidecar,
) -> Result<Option<String>, ImportError> {
    let mesh = read_mesh(path, &mut Vec::new()).map_err(|error| {
        let message = error.to_string();
        let prefix = format!("{}: ", path.display());
        ImportError::of(path, message.strip_prefix(&prefix).unwrap_or(&message))
    })?;
    if mesh.normals.is_some() {
        return Ok(None);
    }
    let normals = normals(&mesh.positions, &mesh.triangles, joins);
    let mesh = Mesh {
        vertices: mesh.positions.iter().map(|place| place.as_vec3().to_array()).collect(),
        normals: normals.iter().map(|normal| normal.as_vec3().to_array()).collect(),
        uvs: mesh.uvs.unwrap_or_default().into_iter().map(|uv| uv.map(|x| x as f32)).collect(),
        triangles: mesh.triangles,
    };
    let stem = path.file_stem().map_or("mesh".into(), |stem| stem.to_string_lossy().into_owned());
    let file = sidecar.write_mesh(&format!("{stem}-smooth"), &mesh)?;
    Ok(Some(file.to_string_lossy().into_owned()))
}

fn normals(positions: &[DVec3], triangles: &[[u32; 3]], joins: bool) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|vertex| positions[vertex as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero();
        for at in 0..3 {
            let edges = [1, 2].map(|step| corners[(at + step) % 3] - corners[at]);
            sums[triangle[at] as usize] += normal * angle_between(edges[0], edges[1]);
        }
    }
    if joins {
        let key = |place: &DVec3| place.to_array().map(|x| (x + 0.0).to_bits());
        let mut at_place: HashMap<[u64; 3], DVec3> = HashMap::new();
        for (place, sum) in positions.iter().zip(&sums) {
            *at_place.entry(key(place)).or_default() += *sum;
        }
        for (place, sum) in positions.iter().zip(&mut sums) {
            *sum = at_place.get(&key(place)).copied().unwrap_or_default();
        }
    }
    // A vertex without a direction of its own is lit as its triangles are.
    sums.into_iter().map(DVec3::normalize_or_zero).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares at a right angle that share an edge, twice as many triangles in one as in the other.
    #[test]
    fn normals_do_not_depend_on_how_a_face_is_cut() {
        let positions = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1]];
        let positions = positions.map(|[x, y, z]| DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
        // The left face is met by one triangle at vertex 0, the lower one by two.
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [3, 5, 4]];
        let normals = normals(&positions, &triangles, false);
        let expected = DVec3::new(1.0, 0.0, 1.0).normalize();
        assert!((normals[0] - expected).length() < 1e-12, "{}", normals[0]);
        assert_eq!(normals[1], DVec3::Z);
    }

    #[test]
    fn vertices_at_one_place_share_a_normal_if_asked() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::Y, DVec3::Z];
        let triangles = [[0, 1, 2], [3, 4, 5]];
        assert_eq!(normals(&positions, &triangles, false)[3], DVec3::X);
        let joined = normals(&positions, &triangles, true);
        assert!((joined[3] - DVec3::new(1.0, 0.0, 1.0).normalize()).length() < 1e-12);
        assert_eq!(joined[0], joined[3]);
    }
}
