//! The transforms of pbrt, all of which are affine; directives multiply from the right.

use glam::{DAffine3, DMat3, DVec3};
use tyndall_scene::description::TransformDescription;

/// From the world to a camera at `eye` that looks at `target`: its x is to the right as pbrt sees it (left of the
/// view in a right-handed world), y up, z forward. `None` if the three are degenerate.
pub(super) fn look_at(numbers: [f64; 9]) -> Option<DAffine3> {
    let [eye, target, up] = [0, 3, 6].map(|i| DVec3::new(numbers[i], numbers[i + 1], numbers[i + 2]));
    let forward = (target - eye).try_normalize()?;
    let right = up.try_normalize()?.cross(forward).try_normalize()?;
    let camera_to_world =
        DAffine3 { matrix3: DMat3::from_cols(right, forward.cross(right), forward), translation: eye };
    Some(camera_to_world.inverse())
}

/// A rotation about an axis, by degrees. `None` if the axis is 0.
pub(super) fn rotation([angle, x, y, z]: [f64; 4]) -> Option<DAffine3> {
    let axis = DVec3::new(x, y, z).try_normalize()?;
    Some(DAffine3::from_mat3(tyndall_scene::rotation(axis, angle.to_radians())))
}

/// Sixteen numbers column by column. `None` if they are no affine map.
pub(super) fn matrix(m: [f64; 16]) -> Option<DAffine3> {
    let is_affine = m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && m[15] != 0.0;
    let columns = m.map(|number| number / m[15]);
    let affine = DAffine3::from_cols_array(&[
        columns[0],
        columns[1],
        columns[2],
        columns[4],
        columns[5],
        columns[6],
        columns[8],
        columns[9],
        columns[10],
        columns[12],
        columns[13],
        columns[14],
    ]);
    (is_affine && affine.is_finite()).then_some(affine)
}

/// The transform in the words of a scene file; `None` for the identity.
pub(super) fn description(affine: &DAffine3) -> Option<TransformDescription> {
    if *affine == DAffine3::IDENTITY {
        return None;
    }
    let DAffine3 { matrix3: m, translation: t } = *affine;
    if m == DMat3::IDENTITY {
        return Some(TransformDescription { translate: Some(t.to_array()), ..Default::default() });
    }
    let rows = [m.row(0), m.row(1), m.row(2)];
    let row = |i: usize| [rows[i].x, rows[i].y, rows[i].z, t[i]];
    let [a, b, c] = [row(0), row(1), row(2)];
    let matrix = [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3], c[0], c[1], c[2], c[3], 0.0, 0.0, 0.0, 1.0];
    Some(TransformDescription { matrix: Some(matrix), ..Default::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn look_at_puts_the_target_on_the_z_axis_and_the_up_vector_above() {
        let to_camera = look_at([0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
        let moved = |x: f64, y: f64, z: f64| to_camera.transform_point3(DVec3::new(x, y, z));
        assert!((moved(0.0, 0.0, 0.0) - DVec3::new(0.0, 0.0, 4.0)).length() < 1e-12);
        assert!((moved(0.0, 1.0, 0.0) - DVec3::new(0.0, 1.0, 4.0)).length() < 1e-12);
        // pbrt's camera space is left-handed.
        assert!((moved(1.0, 0.0, 0.0) - DVec3::new(-1.0, 0.0, 4.0)).length() < 1e-12);
        assert_eq!(look_at([0.0; 9]), None);
    }

    #[test]
    fn matrices_are_written_column_by_column() {
        let numbers = [1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.0, 7.0, 8.0, 10.0, 0.0, 10.0, 20.0, 30.0, 1.0];
        let affine = matrix(numbers).unwrap();
        assert_eq!(affine.transform_point3(DVec3::X), DVec3::new(11.0, 22.0, 33.0));
        assert_eq!(description(&affine).unwrap().to_affine(), affine);
        assert_eq!(matrix([1.0; 16]), None);
    }
}
