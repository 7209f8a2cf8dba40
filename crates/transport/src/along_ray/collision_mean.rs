//! What a function of the collision distance is on average, by quadrature: ∫ μt T f dt.
//!
//! Between the places where the extinction is not smooth T is known to rounding, and Gauss–Legendre's rule of five points
//! (Abramowitz & Stegun 1964, 25.4.30) is halved until its halves agree. Distance samplers are held against this.

use std::ops::ControlFlow;

use super::{AlongRay, Lookups};

/// How far the two halves of an interval may be from the whole, as a share of them or of all found so far.
const TOLERANCE: [f64; 2] = [1e-10, 1e-13];
/// Most times that an interval is halved.
const MOST_HALVINGS: u32 = 30;

impl AlongRay<'_> {
    /// ∫ μt T f dt over the ray: the mean of `f` at the collision, which is 0 where there is none. Good to some 10⁻⁹ where
    /// `f` is smooth.
    pub fn collision_mean(&self, f: impl Fn(f64) -> f64) -> f64 {
        let (mut sum, mut tau) = (0.0, 0.0);
        let _ = self.smooth_intervals(|a, b| {
            let integrand = |t: f64| {
                let lookups = &mut Lookups::default();
                let depth = tau + self.smooth_thickness(a, t, lookups);
                self.mu_t(t, lookups) * libm::exp(-depth) * f(t)
            };
            sum += halved(&integrand, (a, b), gauss(&integrand, (a, b)), f64::abs(sum), MOST_HALVINGS);
            tau += self.smooth_thickness(a, b, &mut Lookups::default());
            ControlFlow::<()>::Continue(())
        });
        sum
    }
}

/// The integral over (a, b), for which the rule gives `whole`; errors are measured against `scale` as well.
fn halved(g: &impl Fn(f64) -> f64, (a, b): (f64, f64), whole: f64, scale: f64, halvings: u32) -> f64 {
    let middle = 0.5 * (a + b);
    let halves = [(a, middle), (middle, b)];
    let parts = halves.map(|half| gauss(g, half));
    let sum = parts[0] + parts[1];
    let tolerance = (TOLERANCE[0] * sum.abs()).max(TOLERANCE[1] * scale);
    let is_rough = (sum - whole).abs() > tolerance;
    if !is_rough || halvings == 0 {
        return sum;
    }
    halves.into_iter().zip(parts).map(|(half, part)| halved(g, half, part, scale, halvings - 1)).sum()
}

fn gauss(g: &impl Fn(f64) -> f64, (a, b): (f64, f64)) -> f64 {
    const NODES: [(f64, f64); 3] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let pair = |(node, weight): (f64, f64)| weight * (g(middle - half * node) + g(middle + half * node));
    half * (NODES[0].1 * g(middle) + pair(NODES[1]) + pair(NODES[2]))
}

#[cfg(test)]
mod tests {
    use super::super::Profile;
    use super::*;
    use tyndall_scene::Exponential;

    fn profiles() -> [(Profile, f64); 5] {
        [
            (Profile::Constant(0.7), 3.0),
            (Profile::Constant(400.0), 3.0),
            (Profile::Exponential(Exponential { logarithm: 1.0, rate: 2.0 }), 5.0),
            (Profile::PiecewiseLinear(vec![(0.0, 0.0), (1.0, 3.0), (1.0, 0.5), (4.0, 0.0)]), 4.0),
            (Profile::Gaussian { peak: 50.0, centre: 1.3, width: 0.01 }, 2.0),
        ]
    }

    #[test]
    fn the_mean_of_one_is_the_probability_of_a_collision() {
        for (profile, length) in profiles() {
            let ray = AlongRay::with_profile(profile.clone(), length, 4);
            let truth = -(-profile.thickness(0.0, length)).exp_m1();
            let mean = ray.collision_mean(|_| 1.0);
            assert!((mean / truth - 1.0).abs() < 1e-9, "{profile:?}: {mean}, not {truth}");
        }
    }

    #[test]
    fn the_mean_distance_in_a_homogeneous_medium_is_that_of_the_exponential_law() {
        let ray = AlongRay::with_profile(Profile::Constant(2.0), 1.5, 1);
        let truth = 0.5 - (-3.0_f64).exp() * (1.5 + 0.5);
        assert!((ray.collision_mean(|t| t) - truth).abs() < 1e-12);
    }

    #[test]
    fn a_function_that_is_no_number_ends_it_too() {
        let ray = AlongRay::with_profile(Profile::Constant(2.0), 1.5, 1);
        assert!(ray.collision_mean(|_| f64::NAN).is_nan());
    }
}
