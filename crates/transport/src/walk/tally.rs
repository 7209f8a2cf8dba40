//! What walks bring home: means with standard errors, from sums that do not depend on the order of addition.
//!
//!   x̄ = Σx/n,   SE² = (Σx²/n − x̄²)/(n − 1)
//!
//! over the n photons, each of which brings one number x to each tally (mostly 0). Numbers are added as integers, which
//! do not round, so the bits of a result do not depend on how the photons were shared out among threads:
//!
//! ```text
//! Σx   |x| < 2^30         steps of 2^-66
//! Σx²  x² < 1 apart, in steps of 2^-95; others in steps of 2^-36          room for 2^31 photons
//! ```
//!
//! A photon that brings more, or what is no number, is left out of all tallies and counted; no estimate here comes near
//! that.
//!
//! A standard error is an estimate itself, and a bad one where a single photon makes much of it: with share q of
//!
//! ```text
//! Σ(x − x̄)²        q = (max x − x̄)² / Σ(x − x̄)²
//! ```
//!
//! it rests on about 1/q photons. So the largest x of each tally is kept; like the sums, it does not depend on order.

use std::ops::Mul;

/// Greatest number of photons that the sums have room for.
pub const MAX_PHOTONS: u64 = 1 << 31;

const LIMIT: f64 = (1_u64 << 30) as f64;
/// One photon may have this share in what tells a standard error.
const GREATEST_SHARE: f64 = 0.1;

const SUM_BITS: i32 = 66;
const SMALL_SQUARE_BITS: i32 = 95;
const LARGE_SQUARE_BITS: i32 = 36;

/// A mean and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Standard deviation of the mean; infinite as long as nothing is known of it.
    pub standard_error: f64,
}

impl Estimate {
    /// A value that is known in closed form.
    pub fn exact(value: f64) -> Self {
        Self { mean: value, standard_error: 0.0 }
    }
}

impl Mul<f64> for Estimate {
    type Output = Self;

    /// In another unit.
    fn mul(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, standard_error: self.standard_error * factor.abs() }
    }
}

/// The sums of one tally.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sums {
    sum: i128,
    /// Of the squares below 1, and of the others.
    squares: [i128; 2],
    /// Photons that brought anything.
    contributions: u64,
    /// The greatest |x|.
    largest: f64,
}

impl Sums {
    fn add(&mut self, x: f64) {
        let square = x * x;
        self.sum += to_fixed(x, SUM_BITS);
        if square < 1.0 {
            self.squares[0] += to_fixed(square, SMALL_SQUARE_BITS);
        } else {
            self.squares[1] += to_fixed(square, LARGE_SQUARE_BITS);
        }
        self.contributions += 1;
        self.largest = self.largest.max(x.abs());
    }

    fn merge(&mut self, other: &Self) {
        self.sum += other.sum;
        self.squares[0] += other.squares[0];
        self.squares[1] += other.squares[1];
        self.contributions += other.contributions;
        self.largest = self.largest.max(other.largest);
    }

    fn estimate(&self, photons: u64) -> Estimate {
        if photons == 0 {
            return Estimate { mean: 0.0, standard_error: f64::INFINITY };
        }
        let n = photons as f64;
        let mean = to_f64(self.sum, SUM_BITS) / n;
        let squares = to_f64(self.squares[0], SMALL_SQUARE_BITS) + to_f64(self.squares[1], LARGE_SQUARE_BITS);
        let variance = (squares / n - mean * mean).max(0.0);
        let standard_error = if photons > 1 { (variance / (n - 1.0)).sqrt() } else { f64::INFINITY };
        Estimate { mean, standard_error }
    }

    /// The share q of one photon in what tells the standard error.
    fn largest_share(&self, photons: u64) -> f64 {
        let Estimate { mean, standard_error } = self.estimate(photons);
        let n = photons as f64;
        // Where photons bring nearly the same, rounding is all that there is to share.
        if standard_error <= 1e-9 * mean.abs() {
            return 0.0;
        }
        ((self.largest - mean.abs()) / standard_error).powi(2) / (n * (n - 1.0))
    }
}

/// Whether a number can be added; NaN cannot.
fn has_place(x: f64) -> bool {
    x.abs() < LIMIT
}

fn to_fixed(x: f64, bits: i32) -> i128 {
    libm::ldexp(x, bits).round() as i128
}

fn to_f64(x: i128, bits: i32) -> f64 {
    libm::ldexp(x as f64, -bits)
}

/// What one photon has brought so far, of each tally.
#[derive(Debug)]
pub struct Scores {
    values: Vec<f64>,
    touched: Vec<usize>,
    /// Whether any of it has no place in the sums.
    is_spoilt: bool,
}

impl Scores {
    pub(super) fn new(tallies: usize) -> Self {
        Self { values: vec![0.0; tallies], touched: Vec::new(), is_spoilt: false }
    }

    /// Adds `x` to what the photon brings to a tally.
    pub fn add(&mut self, tally: usize, x: f64) {
        if x == 0.0 {
            return;
        }
        if self.values[tally] == 0.0 {
            self.touched.push(tally);
        }
        self.values[tally] += x;
        self.is_spoilt |= !has_place(self.values[tally]);
    }
}

/// The sums of all tallies over a number of photons.
#[derive(Debug, Clone, PartialEq)]
pub struct Tallies {
    sums: Vec<Sums>,
    photons: u64,
    rejected: u64,
}

impl Tallies {
    /// So many tallies, without any photon yet.
    pub fn new(tallies: usize) -> Self {
        Self { sums: vec![Sums::default(); tallies], photons: 0, rejected: 0 }
    }

    /// Takes up what a photon has brought, and clears it for the next.
    pub(super) fn take(&mut self, scores: &mut Scores) {
        let is_spoilt = std::mem::take(&mut scores.is_spoilt);
        self.rejected += u64::from(is_spoilt);
        for tally in scores.touched.drain(..) {
            let x = std::mem::take(&mut scores.values[tally]);
            // Where contributions have cancelled, the tally may be here twice.
            if x != 0.0 && !is_spoilt {
                self.sums[tally].add(x);
            }
        }
        self.photons += 1;
    }

    /// Adds the tallies of other photons.
    pub(super) fn merge(&mut self, other: &Self) {
        for (sums, others) in self.sums.iter_mut().zip(&other.sums) {
            sums.merge(others);
        }
        self.photons += other.photons;
        self.rejected += other.rejected;
    }

    /// Number of photons, those that were rejected among them.
    pub fn photons(&self) -> u64 {
        self.photons
    }

    /// Photons that brought what is not finite, or too much, and that all estimates leave out.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Whether any photon has brought anything to a tally.
    pub fn is_met(&self, tally: usize) -> bool {
        self.sums[tally].contributions > 0
    }

    /// The estimate of a tally.
    pub fn estimate(&self, tally: usize) -> Estimate {
        self.sums[tally].estimate(self.photons - self.rejected)
    }

    /// The share of one photon in what tells the standard error of a tally, 0 to 1.
    pub fn largest_share(&self, tally: usize) -> f64 {
        self.sums[tally].largest_share(self.photons - self.rejected)
    }

    /// Whether the standard error of a tally rests on ten photons and more.
    pub fn is_error_known(&self, tally: usize) -> bool {
        self.largest_share(tally) <= GREATEST_SHARE
    }

    /// The estimate of a fraction of the light. As long as no photon has brought anything to it, its standard error is
    /// 1/n: with a greater fraction than a few of that some photon would have.
    pub fn fraction(&self, tally: usize) -> Estimate {
        let estimate = self.estimate(tally);
        if self.sums[tally].contributions > 0 {
            return estimate;
        }
        Estimate { standard_error: 1.0 / self.photons as f64, ..estimate }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_errors_are_those_of_two_passes_over_many_magnitudes() {
        for scale in [1e-10, 1e-3, 1.0, 1e3, 1e7] {
            let values: Vec<f64> = (0..1000).map(|i| scale * f64::from((i * 7919) % 97) / 50.0).collect();
            let mut tallies = Tallies::new(1);
            let mut scores = Scores::new(1);
            for &value in &values {
                scores.add(0, value);
                tallies.take(&mut scores);
            }
            let mean = values.iter().sum::<f64>() / 1000.0;
            let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 999.0;
            let estimate = tallies.estimate(0);
            assert!((estimate.mean / mean - 1.0).abs() < 1e-9, "{scale}");
            assert!((estimate.standard_error / (variance / 1000.0).sqrt() - 1.0).abs() < 1e-6, "{scale}");
        }
    }

    /// Tallies of photons that each bring one number.
    fn tallied(values: impl IntoIterator<Item = f64>) -> Tallies {
        let (mut tallies, mut scores) = (Tallies::new(1), Scores::new(1));
        for value in values {
            scores.add(0, value);
            tallies.take(&mut scores);
        }
        tallies
    }

    #[test]
    fn the_largest_photon_has_its_share_of_what_tells_the_error() {
        let values: Vec<f64> = (0..1000).map(|i| if i == 7 { 40.0 } else { f64::from(i % 3) }).collect();
        let mean = values.iter().sum::<f64>() / 1000.0;
        let share = (40.0 - mean).powi(2) / values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let tallies = tallied(values);
        assert!((tallies.largest_share(0) / share - 1.0).abs() < 1e-6, "{share}");
        assert!(!tallies.is_error_known(0));
        // Of events that are all alike, each has its part: ten are enough.
        for (events, is_known) in [(1, false), (9, false), (11, true), (1000, true)] {
            let tallies = tallied((0..1000).map(|i| if i < events { 3.0 } else { 0.0 }));
            assert_eq!(tallies.is_error_known(0), is_known, "{events}");
        }
        // A constant, which rounding alone tells from itself.
        assert!(tallied([0.1; 1000]).is_error_known(0));
    }

    #[test]
    fn photons_without_a_place_in_the_sums_are_left_out_and_counted() {
        let tallies = tallied([1.0, f64::NAN, 3.0, f64::INFINITY, -1e300, 2.0]);
        assert_eq!((tallies.photons(), tallies.rejected()), (6, 3));
        assert_eq!(tallies.estimate(0), tallied([1.0, 3.0, 2.0]).estimate(0));
        let none = tallied([f64::NAN]);
        assert_eq!(none.estimate(0), Estimate { mean: 0.0, standard_error: f64::INFINITY });
    }

    #[test]
    fn the_contributions_of_a_photon_are_one_number() {
        let mut tallies = Tallies::new(2);
        let mut scores = Scores::new(2);
        for _ in 0..3 {
            scores.add(0, 0.25);
            scores.add(0, 0.75);
            tallies.take(&mut scores);
        }
        assert_eq!(tallies.estimate(0), Estimate::exact(1.0));
        assert_eq!(tallies.fraction(1), Estimate { mean: 0.0, standard_error: 1.0 / 3.0 });
    }
}
