//! The phase function of molecules for unpolarised light: 3/(16π)·(1 + cos² θ).
//!
//! Source: Rayleigh 1871; the inversion of its cumulative distribution, whose cubic x³ + 3x = 8u − 4 has the one real
//! root 2 sinh(arsinh(4u − 2)/3), is Frisvad's 2011 ("Importance sampling the Rayleigh phase function").

use std::f64::consts::PI;

pub(super) fn value(cos_theta: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos_theta * cos_theta)
}

pub(super) fn sample(u: f64) -> f64 {
    2.0 * libm::sinh(libm::asinh(4.0 * u - 2.0) / 3.0)
}
