//! Angles at which a phase function is tabulated: close where it changes fast.
//!
//! Spheres of size x have rings π/x apart around the forward and the backward direction (corona, glory), which sizes of a
//! relative width σ blur at σ times the distance from there; between them, bows of a width of x^{−2/3} (Airy).

use std::f64::consts::{FRAC_PI_2, PI};

/// More angles than this are not tabulated: their steps are then longer in proportion.
const MOST_ANGLES: f64 = 65536.0;

/// The longest step, radians: phase functions of the smallest spheres are cosines.
const LONGEST: f64 = 0.03;

/// Steps to a ring, to a blurred ring, and to a bow.
const STEPS: [f64; 3] = [12.0, 8.0, 6.0];

/// Angles from 0 to π/2, for particles of size `x` and relative width of sizes `sigma`; the grid goes on symmetrically to π.
pub(super) fn forward_angles(x: f64, sigma: f64) -> Vec<f64> {
    let ring = (PI / x / STEPS[0]).min(LONGEST);
    let blurred = sigma.clamp(0.0, 0.4) / STEPS[1];
    let bow = (libm::pow(x, -2.0 / 3.0) / STEPS[2]).clamp(0.001, LONGEST).max(ring);
    let step = |angle: f64| if sigma > 0.0 { (blurred * angle).clamp(ring, bow) } else { ring };
    let stretch = (2.0 * count(&step) / MOST_ANGLES).max(1.0);

    let mut angles = vec![0.0];
    let mut angle = 0.0;
    loop {
        angle += stretch * step(angle);
        if angle >= FRAC_PI_2 {
            angles.push(FRAC_PI_2);
            return angles;
        }
        angles.push(angle);
    }
}

/// A table over angles from 0 to π with up to three angles more in each step, by cubic interpolation, so that straight
/// lines between them do not cut the corners.
pub(super) fn refined(angles: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let last = angles.len() - 1;
    let parts = (MOST_ANGLES as usize / angles.len()).clamp(1, 4);
    let mut refined = (Vec::with_capacity(parts * last + 1), Vec::with_capacity(parts * last + 1));
    for i in 0..last {
        // Phase functions go on symmetrically beyond 0 and π.
        let before = if i == 0 { (-angles[1], values[1]) } else { (angles[i - 1], values[i - 1]) };
        let after = if i + 1 == last {
            (2.0 * PI - angles[last - 1], values[last - 1])
        } else {
            (angles[i + 2], values[i + 2])
        };
        let points = [before, (angles[i], values[i]), (angles[i + 1], values[i + 1]), after];
        refined.0.push(angles[i]);
        refined.1.push(values[i]);
        for part in 1..parts {
            let angle = angles[i] + (angles[i + 1] - angles[i]) * part as f64 / parts as f64;
            refined.0.push(angle);
            // Between values that are almost 0, a cubic can be less than 0.
            refined.1.push(cubic(&points, angle).max(values[i].min(values[i + 1]) * 0.1));
        }
    }
    refined.0.push(angles[last]);
    refined.1.push(values[last]);
    refined
}

/// The cubic through four points (Lagrange).
fn cubic(points: &[(f64, f64); 4], x: f64) -> f64 {
    let basis = |i: usize| {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, (node, _))| (x - node) / (points[i].0 - node)).product::<f64>()
    };
    points.iter().enumerate().map(|(i, (_, value))| value * basis(i)).sum()
}

/// Number of steps from 0 to π/2.
fn count(step: &impl Fn(f64) -> f64) -> f64 {
    let (mut distance, mut count) = (0.0, 0.0);
    while distance < FRAC_PI_2 {
        distance += step(distance);
        count += 1.0;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_run_from_forward_to_the_side_and_resolve_rings() {
        for x in [1e-6, 1.0, 100.0, 1e5] {
            for sigma in [0.0, 0.01, 0.3, 3.0] {
                let angles = forward_angles(x, sigma);
                assert!(angles.windows(2).all(|pair| pair[0] < pair[1]));
                assert_eq!((angles[0], angles[angles.len() - 1]), (0.0, FRAC_PI_2));
                assert!((20..33_000).contains(&angles.len()), "{x} {sigma}: {}", angles.len());
                // Single great spheres have more rings than there are angles.
                let is_stretched = sigma == 0.0 && x > 1e4;
                assert!(is_stretched || angles[1] <= f64::min(LONGEST, PI / 11.0 / x), "{x} {sigma}");
            }
        }
    }

    #[test]
    fn refined_tables_follow_a_smooth_curve_through_the_same_points() {
        let angles: Vec<f64> = (0..=60).map(|i| PI * f64::from(i) / 60.0).collect();
        let curve = |angle: f64| 2.0 + (3.0 * angle).cos();
        let values: Vec<f64> = angles.iter().map(|angle| curve(*angle)).collect();
        let (finer, smooth) = refined(&angles, &values);
        assert_eq!(finer.len(), 241);
        for (angle, value) in finer.iter().zip(&smooth) {
            assert!((value - curve(*angle)).abs() < 2e-5, "{angle}: {value}");
        }
    }
}
