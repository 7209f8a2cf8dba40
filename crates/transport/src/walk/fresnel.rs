//! A smooth face between air and a layer of refractive index n: how much light it reflects, and where the rest goes.
//!
//!   n₁ sin θ₁ = n₂ sin θ₂
//!
//! The light is taken as unpolarised at every bounce. Source: Born & Wolf 1999, "Principles of optics", section 1.5.2.

use glam::DVec3;
use tyndall_optics::bsdf::fresnel;

/// Reflectance of a face for light that meets it under the cosine `cos` to its normal, going from the index `n1` into
/// `n2`; and the cosine on the other side, 0 where the reflection is total.
pub fn reflectance(cos: f64, n1: f64, n2: f64) -> (f64, f64) {
    fresnel::dielectric(cos, n2 / n1)
}

/// The direction behind a horizontal face, where it makes the cosine `beyond` with the vertical; `ratio` is n₁/n₂.
pub fn refracted(direction: DVec3, ratio: f64, beyond: f64) -> DVec3 {
    DVec3::new(direction.x * ratio, beyond.copysign(direction.y), direction.z * ratio).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_has_its_textbook_values() {
        let (normal, _) = reflectance(1.0, 1.0, 1.5);
        assert!((normal - 0.04).abs() < 1e-15);
        // At Brewster's angle only the perpendicular part is left: ((n² − 1)/(n² + 1))²/2.
        let brewster = 1.5_f64.atan();
        let (at_brewster, _) = reflectance(brewster.cos(), 1.0, 1.5);
        assert!((at_brewster - 0.5 * (1.25_f64 / 3.25).powi(2)).abs() < 1e-15);
        assert_eq!(reflectance(0.5, 1.5, 1.0), (1.0, 0.0));
        assert_eq!(reflectance(0.0, 1.0, 1.33).0, 1.0);
        assert!(reflectance(0.3, 1.0, 1.0).0 < 1e-30);
    }

    #[test]
    fn light_takes_the_same_way_back_with_the_same_loss() {
        for cos in [0.05, 0.3, 0.8, 1.0] {
            let (there, beyond) = reflectance(cos, 1.0, 1.33);
            let (back, outside) = reflectance(beyond, 1.33, 1.0);
            assert!((there - back).abs() < 1e-12 && (outside - cos).abs() < 1e-12, "{cos}");
        }
        let direction = DVec3::new(0.6, -0.8, 0.0);
        let (_, beyond) = reflectance(0.8, 1.0, 1.33);
        let inside = refracted(direction, 1.0 / 1.33, beyond);
        assert!((inside.x * 1.33 - 0.6).abs() < 1e-12 && inside.y < 0.0);
    }
}
