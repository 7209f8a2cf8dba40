//! What can be told of an affine map, for both dialects.

use glam::{DAffine3, DMat3, DVec3};

/// The factor of a map that scales all directions alike.
pub(crate) fn uniform_scale(affine: &DAffine3) -> Option<f64> {
    let m = affine.matrix3;
    let gram = m.transpose() * m;
    let square = gram.x_axis.x;
    let off = (gram - DMat3::from_diagonal(DVec3::splat(square))).to_cols_array();
    let is_similarity = square > 0.0 && off.iter().all(|number| number.abs() <= 1e-9 * square);
    is_similarity.then(|| square.sqrt())
}

/// Volume of what a map makes of a cube over that of a box with edges as long, below which the map is flat: products of maps that
/// are flat have one that is as good as 0, but seldom 0.
const FLAT: f64 = 1e-12;

/// Whether a map takes all things to a plane, a line or a point, or is none.
pub(crate) fn is_flat(affine: &DAffine3) -> bool {
    let m = &affine.matrix3;
    let edges = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let is_open = m.determinant().abs() > FLAT * edges;
    !is_open || !affine.is_finite() || !affine.inverse().is_finite()
}

/// Whether a map takes axes to axes, so that boxes along them stay such boxes.
pub(crate) fn keeps_axes(affine: &DAffine3) -> bool {
    let columns = [affine.matrix3.x_axis, affine.matrix3.y_axis, affine.matrix3.z_axis];
    columns.iter().all(|column| {
        let greatest = column.abs().max_element();
        column.to_array().iter().filter(|number| number.abs() > 1e-9 * greatest).count() == 1
    })
}

/// The box around a box after a map.
pub(crate) fn map_box(affine: &DAffine3, [min, max]: [DVec3; 2]) -> [DVec3; 2] {
    let corners = (0..8).map(|corner| {
        let choose = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
        affine.transform_point3(DVec3::new(choose(0), choose(1), choose(2)))
    });
    corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[least, greatest], corner| {
        [least.min(corner), greatest.max(corner)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_that_are_flat_but_for_rounding_are_flat() {
        let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
        let turn = DAffine3::from_rotation_y(0.3) * DAffine3::from_rotation_x(1.1);
        for map in [flat, flat * turn, turn * flat, turn * flat * turn.inverse()] {
            assert!(is_flat(&map), "{map}");
        }
        assert!(is_flat(&DAffine3::from_scale(DVec3::NAN)));
        let thin = DAffine3::from_scale(DVec3::new(1e3, 1e-3, 1.0));
        for map in [DAffine3::IDENTITY, turn, thin, thin * turn, turn * thin] {
            assert!(!is_flat(&map), "{map}");
        }
    }
}
