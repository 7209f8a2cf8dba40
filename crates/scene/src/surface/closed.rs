//! Whether a mesh has an inside: along every edge as many triangles run one way as the other.

use std::collections::HashMap;

use super::Mesh;

/// Vertices at the same place, as along the seams of textures, count as one.
pub(super) fn is_closed(mesh: &Mesh) -> bool {
    let mut numbers = HashMap::new();
    // Adding 0 makes -0 a 0.
    let number_of: Vec<u32> = mesh
        .positions
        .iter()
        .map(|position| {
            let next = numbers.len() as u32;
            *numbers.entry(position.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let mut balance: HashMap<(u32, u32), i32> = HashMap::with_capacity(mesh.triangles.len() * 3 / 2);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|corner| number_of[corner as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *balance.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    balance.values().all(|balance| *balance == 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_tetrahedron_is_closed_until_a_triangle_is_missing_or_turned() {
        let mut mesh = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -0.0 * DVec3::X],
            triangles: vec![[0, 2, 1], [4, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        assert!(is_closed(&mesh));
        mesh.triangles[0].swap(1, 2);
        assert!(!is_closed(&mesh));
        mesh.triangles.remove(0);
        assert!(!is_closed(&mesh));
    }
}
