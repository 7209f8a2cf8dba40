//! The equal-area map between directions and the unit square.
//!
//! Clarberg 2008, "Fast equal-area mapping of the (hemi)sphere using SIMD": the square inside |a| + |b| = 1, with a and b
//! from −1 to 1 across the picture, is the half sphere about +z, and its four corners, folded over, are the other one. With
//! r = 1 − |1 − |a| − |b||,
//!
//!   |z| = 1 − r²,   azimuth φ = (π/4) ((|b| − |a|)/r + 1) in each quadrant.
//!
//! a grows along the columns, with x; b along the rows, with y. Pbrt's pictures of the surroundings are of this kind.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

/// The unit vector of a place in the picture.
pub fn equal_area_to_direction(u: f64, v: f64) -> DVec3 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    // Above 0 in the half about +z, below in the corners.
    let fold = 1.0 - a.abs() - b.abs();
    let r = 1.0 - fold.abs();
    let azimuth = if r > 0.0 { FRAC_PI_4 * ((b.abs() - a.abs()) / r + 1.0) } else { 0.0 };
    let across = r * (2.0 - r * r).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(azimuth);
    DVec3::new((across * cos).copysign(a), (across * sin).copysign(b), (1.0 - r * r).copysign(fold))
}

/// The place (u, v) of a direction, each in [0, 1].
pub fn direction_to_equal_area(direction: DVec3) -> [f64; 2] {
    let [x, y, z] = direction.abs().to_array();
    // r = √(1 − |z|), without cancellation near the poles.
    let r = ((x * x + y * y) / (1.0 + z)).sqrt().min(1.0);
    // |b| in the half about +z; |a| + |b| is r there.
    let b = if x > 0.0 || y > 0.0 { r * libm::atan2(y, x) / (2.0 * FRAC_PI_4) } else { 0.0 };
    let a = r - b;
    let (a, b) = if direction.z < 0.0 { (1.0 - b, 1.0 - a) } else { (a, b) };
    [a.copysign(direction.x), b.copysign(direction.y)].map(|at| (0.5 * (at + 1.0)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_plus_z_and_the_corners_are_minus_z() {
        for (u, v, direction) in [
            (0.5, 0.5, DVec3::Z),
            (0.0, 0.0, DVec3::NEG_Z),
            (1.0, 0.0, DVec3::NEG_Z),
            (1.0, 0.5, DVec3::X),
            (0.0, 0.5, DVec3::NEG_X),
            (0.5, 1.0, DVec3::Y),
            (0.5, 0.0, DVec3::NEG_Y),
        ] {
            assert!((equal_area_to_direction(u, v) - direction).length() < 1e-12, "{u} {v}");
        }
    }

    #[test]
    fn both_maps_are_inverse_and_equal_areas_stay_equal() {
        let step = 1e-5;
        for i in 0..1000 {
            let (u, v) = (f64::from(i % 37) / 37.0 + 0.01, f64::from(i % 29) / 29.0 + 0.003);
            let direction = equal_area_to_direction(u, v);
            assert!((direction.length() - 1.0).abs() < 1e-12);
            let [u_back, v_back] = direction_to_equal_area(direction);
            assert!((u - u_back).abs() < 1e-9 && (v - v_back).abs() < 1e-9, "{u} {v} {u_back} {v_back}");
            let along_u = equal_area_to_direction(u + step, v) - direction;
            let along_v = equal_area_to_direction(u, v + step) - direction;
            let ratio = along_u.cross(along_v).length() / (step * step * 4.0 * std::f64::consts::PI);
            // Folds between the two places spoil a few of the differences.
            let is_smooth = (2.0 * u - 1.0).abs() > 1e-3 && (2.0 * v - 1.0).abs() > 1e-3;
            assert!((ratio - 1.0).abs() < 1e-3 || !is_smooth, "{u} {v}: {ratio}");
        }
    }
}
