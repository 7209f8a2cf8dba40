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
