//! Fresnel's equations: what part of unpolarised light the smooth face of a material reflects.
//!
//!   r_s = (cos θ − m cos θ_t)/(cos θ + m cos θ_t),   r_p = (m cos θ − cos θ_t)/(m cos θ + cos θ_t),
//!   F = (|r_s|² + |r_p|²)/2,   sin θ = m sin θ_t,
//!
//! with the index m = n + ik of the far side over that of the side that the light comes from; of a metal, with
//! a + ib = √(m² − sin² θ) in the place of m cos θ_t. Source: Born & Wolf 1999, "Principles of optics", sections 1.5.2
//! and 14.2.

use glam::DVec4;

/// Reflectance of a dielectric face for light that meets it under the cosine `cos` ≥ 0; `index` is that of the far side
/// over that of the near one. And the cosine on the far side, 0 where the reflection is total.
pub fn dielectric(cos: f64, index: f64) -> (f64, f64) {
    let sin_squared = (1.0 - cos * cos) / (index * index);
    if sin_squared >= 1.0 {
        return (1.0, 0.0);
    }
    let beyond = (1.0 - sin_squared).sqrt();
    let across = (cos - index * beyond) / (cos + index * beyond);
    let along = (index * cos - beyond) / (index * cos + beyond);
    (0.5 * (across * across + along * along), beyond)
}

/// Reflectance of a conductor of index n + ik over that of the side that the light comes from, under the cosine
/// `cos` ≥ 0.
pub fn conductor(cos: f64, n: f64, k: f64) -> f64 {
    if cos <= 0.0 {
        return 1.0;
    }
    let (cos_squared, sin_squared) = (cos * cos, 1.0 - cos * cos);
    // The root of x + iy in the form that does not cancel.
    let (x, y) = (n * n - k * k - sin_squared, 2.0 * n * k);
    let length = libm::hypot(x, y);
    let (a, b) = if x >= 0.0 {
        let a = (0.5 * (length + x)).sqrt();
        (a, if a > 0.0 { 0.5 * y / a } else { 0.0 })
    } else {
        let b = (0.5 * (length - x)).sqrt();
        (0.5 * y / b, b)
    };
    let across = ((cos - a).powi(2) + b * b) / ((cos + a).powi(2) + b * b);
    let ratio = ((a * cos - sin_squared).powi(2) + b * b * cos_squared)
        / ((a * cos + sin_squared).powi(2) + b * b * cos_squared);
    // 0/0 of no matter at all, n = k = 0, at normal incidence.
    let ratio = if ratio.is_nan() { 1.0 } else { ratio };
    0.5 * across * (1.0 + ratio)
}

/// [`conductor`] in every channel.
pub fn conductor_channels(cos: f64, n: DVec4, k: DVec4) -> DVec4 {
    let (n, k) = (n.to_array(), k.to_array());
    DVec4::from_array([0, 1, 2, 3].map(|channel| conductor(cos, n[channel], k[channel])))
}

/// The k with which a conductor of n = 1 reflects the fraction `reflectance` at normal incidence: r = k²/(4 + k²).
pub fn k_of_reflectance(reflectance: f64) -> f64 {
    // A perfect mirror has no finite k; this one lacks 4e-12.
    let reflectance = reflectance.clamp(0.0, 1.0);
    (2.0 * (reflectance / (1.0 - reflectance)).sqrt()).min(1e6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dielectric_has_its_textbook_values() {
        assert!((dielectric(1.0, 1.5).0 - 0.04).abs() < 1e-15);
        // At Brewster's angle only the perpendicular part is left: ((n² − 1)/(n² + 1))²/2.
        let brewster = 1.5_f64.atan();
        let (reflectance, beyond) = dielectric(brewster.cos(), 1.5);
        assert!((reflectance - 0.5 * (1.25_f64 / 3.25).powi(2)).abs() < 1e-15);
        // There the two rays are at right angles.
        assert!((beyond.acos() + brewster - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(dielectric(0.5, 1.0 / 1.5), (1.0, 0.0));
        assert_eq!(dielectric(0.0, 1.5).0, 1.0);
        assert!(dielectric(0.3, 1.0).0 < 1e-30);
    }

    #[test]
    fn light_takes_the_same_way_back_with_the_same_loss() {
        for cos in [0.01, 0.3, 0.8, 1.0] {
            let (there, beyond) = dielectric(cos, 1.33);
            let (back, outside) = dielectric(beyond, 1.0 / 1.33);
            assert!((there - back).abs() < 1e-12 && (outside - cos).abs() < 1e-12, "{cos}");
        }
    }

    #[test]
    fn a_conductor_that_does_not_absorb_is_a_dielectric() {
        for index in [0.7, 1.0, 1.5, 2.4] {
            for cos in [0.0, 1e-3, 0.2, 0.6, 0.9, 1.0] {
                let (expected, _) = dielectric(cos, index);
                let reflectance = conductor(cos, index, 0.0);
                assert!((reflectance - expected).abs() < 1e-12, "{index} {cos}: {reflectance} {expected}");
            }
        }
    }

    /// ((n − 1)² + k²)/((n + 1)² + k²) at normal incidence, 1 at grazing incidence, and 1 for k → ∞.
    #[test]
    fn a_conductor_has_its_limits() {
        let (n, k): (f64, f64) = (0.27, 2.95);
        let normal = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert!((conductor(1.0, n, k) - normal).abs() < 1e-14);
        assert!((conductor(0.0, n, k) - 1.0).abs() < 1e-14);
        for cos in [0.0, 0.1, 0.5, 1.0] {
            assert!((conductor(cos, 1.0, k_of_reflectance(1.0)) - 1.0).abs() < 1e-5);
            assert!((0.0..=1.0 + 1e-15).contains(&conductor(cos, 3.0, 3.0)));
        }
        for reflectance in [0.0, 0.2, 0.9, 0.999] {
            assert!((conductor(1.0, 1.0, k_of_reflectance(reflectance)) - reflectance).abs() < 1e-12);
        }
    }
}
