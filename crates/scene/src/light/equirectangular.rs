//! The equirectangular map between directions and the unit square.
//!
//! v = θ / π from +y (0, the top row) to -y (1, the bottom row); u = 1/2 + φ / 2π with the azimuth φ from -z
//! (north, the middle of the picture) through +x (east, to the right), so that the picture is seen from
//! inside unmirrored.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// The unit vector of a place in the picture.
pub fn uv_to_direction(u: f64, v: f64) -> DVec3 {
    let (sin_polar, cos_polar) = libm::sincos(PI * v);
    let (sin_azimuth, cos_azimuth) = libm::sincos(TAU * (u - 0.5));
    DVec3::new(sin_polar * sin_azimuth, cos_polar, -sin_polar * cos_azimuth)
}

/// The place (u, v) of a direction, each in [0, 1].
pub fn direction_to_uv(direction: DVec3) -> [f64; 2] {
    let azimuth = libm::atan2(direction.x, -direction.z);
    // Near the poles an arc cosine of y would lose half the digits.
    let polar = libm::atan2(libm::hypot(direction.x, direction.z), direction.y);
    [0.5 + azimuth / TAU, polar / PI]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn north_is_in_the_middle_and_east_to_the_right_of_it() {
        for (u, v, direction) in [
            (0.5, 0.5, DVec3::NEG_Z),
            (0.75, 0.5, DVec3::X),
            (0.25, 0.5, DVec3::NEG_X),
            (0.0, 0.5, DVec3::Z),
            (0.5, 0.0, DVec3::Y),
            (0.5, 1.0, DVec3::NEG_Y),
        ] {
            assert!((uv_to_direction(u, v) - direction).length() < 1e-15, "{u} {v}");
        }
    }

    #[test]
    fn both_maps_are_inverse() {
        for i in 0..1000 {
            let (u, v) = (f64::from(i % 37) / 37.0 + 0.01, f64::from(i % 29) / 29.0 + 0.003);
            let [u_back, v_back] = direction_to_uv(uv_to_direction(u, v));
            assert!((u - u_back).abs() < 1e-12 && (v - v_back).abs() < 1e-12, "{u} {v} {u_back} {v_back}");
        }
    }
}
