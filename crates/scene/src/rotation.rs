//! Rotations, and angles between directions, with the same bits on every processor: glam's take sine and cosine from the system.

use glam::{DMat3, DVec3};

/// The rotation about `axis`, of length 1, by `angle` in radians, right-handed (Rodrigues' formula).
pub fn rotation(axis: DVec3, angle: f64) -> DMat3 {
    let (sin, cos) = libm::sincos(angle);
    let along = axis * (1.0 - cos);
    let turned = |unit: DVec3| unit * cos + axis.cross(unit) * sin + along * axis.dot(unit);
    DMat3::from_cols(turned(DVec3::X), turned(DVec3::Y), turned(DVec3::Z))
}

/// The angle between two vectors of any length, in radians.
pub fn angle_between(a: DVec3, b: DVec3) -> f64 {
    libm::acos((a.dot(b) / (a.length_squared() * b.length_squared()).sqrt()).clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_turns_right_handed_and_keeps_its_axis() {
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!((rotation(DVec3::Z, quarter) * DVec3::X - DVec3::Y).length() < 1e-15);
        let axis = DVec3::new(1.0, -2.0, 3.0).normalize();
        let turned = rotation(axis, 2.0);
        assert!((turned * axis - axis).length() < 1e-15);
        let reference = DMat3::from_axis_angle(axis, 2.0);
        assert!(turned.abs_diff_eq(reference, 1e-15), "{turned} {reference}");
    }

    #[test]
    fn the_angle_between_vectors_knows_no_length() {
        let (a, b) = (DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.5, 0.5, 0.0));
        assert!((angle_between(a, b) - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        assert_eq!(angle_between(a, -a), std::f64::consts::PI);
    }
}
