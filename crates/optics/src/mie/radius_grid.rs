//! Radii at which a size distribution is integrated, and how many particles stand at each.
//!
//! With ln r = c + s sinh u, c and s the middle and half width of the particles that matter most, the trapezoidal rule in u
//! has most radii where they count, and still runs smoothly out to where there are none left, so that it converges fast.

use super::SizeDistribution;

/// The map from u to radii.
pub(super) struct RadiusGrid<'a> {
    distribution: &'a SizeDistribution,
    middle: f64,
    width: f64,
    /// u at either end.
    ends: [f64; 2],
}

impl<'a> RadiusGrid<'a> {
    /// A grid over all particles that matter.
    pub(super) fn new(distribution: &'a SizeDistribution) -> Self {
        let [middle, width] = distribution.log_peak();
        let ends = distribution.log_range().map(|log_r| libm::asinh((log_r - middle) / width));
        Self { distribution, middle, width, ends }
    }

    /// Radius `i` of 0 … `steps` in µm, and the number of its particles, up to a constant factor that is the same for all
    /// i and `steps`.
    pub(super) fn node(&self, i: usize, steps: usize) -> (f64, f64) {
        let [low, high] = self.ends;
        let u = low + (high - low) * i as f64 / steps as f64;
        let log_r = self.middle + self.width * libm::sinh(u);
        let relative = self.distribution.log_density(log_r) - self.distribution.log_density(self.middle);
        let end = if i == 0 || i == steps { 0.5 } else { 1.0 };
        (libm::exp(log_r), end * libm::exp(relative) * libm::cosh(u) / steps as f64)
    }
}
