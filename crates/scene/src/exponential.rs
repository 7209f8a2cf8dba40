//! A quantity that is an exponential function of the distance along a ray, as is the density of an atmosphere along any
//! straight line: e^(logarithm − rate·t). Its integral and the inverse of that are closed forms.

use crate::Ray;

/// e^(logarithm − rate·t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    /// Natural logarithm of the value at t = 0, which itself may be too large or too small for a number.
    pub logarithm: f64,
    /// 1/length over which it falls by e; negative where it grows.
    pub rate: f64,
}

impl Exponential {
    /// The density exp(−(y − bottom)/scale_height) along a ray in its coordinates.
    pub fn of_atmosphere(local: &Ray, bottom: f64, scale_height: f64) -> Exponential {
        Exponential {
            logarithm: -(local.origin.y - bottom) / scale_height,
            rate: local.direction.y / scale_height,
        }
    }

    /// The value at the distance `t`.
    pub fn value(&self, t: f64) -> f64 {
        libm::exp(self.logarithm - self.rate * t)
    }

    /// The integral from `start` to `end`, which may be infinite.
    pub fn integral(&self, start: f64, end: f64) -> f64 {
        let first = self.value(start);
        let exponent = self.rate * (end - start);
        // (1 − e^−x)/x is 1 − x/2 to double precision below 1e-9, where the quotient loses its digits.
        if self.rate == 0.0 {
            first * (end - start)
        } else if exponent.abs() < 1e-9 {
            first * (end - start) * (1.0 - 0.5 * exponent)
        } else {
            first * -libm::expm1(-exponent) / self.rate
        }
    }

    /// The distance up to which the integral from `start` is `integral`; infinite if it never gets so far.
    pub fn distance_of_integral(&self, start: f64, integral: f64) -> f64 {
        let logarithm = self.logarithm - self.rate * start;
        // The distance over which the value at the start would give the integral.
        let constant = integral * libm::exp(-logarithm);
        let exponent = self.rate * constant;
        if self.rate == 0.0 {
            start + constant
        } else if exponent.abs() < 1e-9 {
            start + constant * (1.0 + 0.5 * exponent)
        } else if exponent >= 1.0 {
            f64::INFINITY
        } else if exponent < -1e18 {
            // Where the value at the start underflows, far above an atmosphere.
            start - (libm::log(-self.rate * integral) - logarithm) / self.rate
        } else {
            start - libm::log1p(-exponent) / self.rate
        }
    }
}
