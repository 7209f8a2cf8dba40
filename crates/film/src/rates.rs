//! Adaptive sampling: how many samples a pixel gets for each that the others get on average.
//!
//! Pixel i, with rate r_i, holds after s rounds
//!
//! ```text
//! n_i(s) = min(s, 2) + ⌊max(s − 2, 0) r_i + ½⌋        mean of r_i = 1
//! ```
//!
//! samples, so that every pixel has a standard error as early as without rates. In a given time Σ n_i c_i, with c_i the cost of a
//! sample, the sum of relative variances V_i / n_i is least if n_i is in proportion to √(V_i/c_i) (Neyman 1934, of strata). Both are
//! estimated by a *pilot*, a film of few samples that are no part of the picture: so the picture's samples are independent of their
//! number, its means are unbiased and its standard errors those of any picture. Rates that come from a picture's own samples would
//! not leave them so (Kirk & Arvo 1991, "Unbiased sampling techniques for image synthesis"). Costs are counted in random numbers, as
//! times would not be the same twice.

use std::ops::Range;

use crate::film::Film;
use crate::fixed_point::MAX_SAMPLES;
use crate::ranges::{RangeError, SampleRanges};

/// Rates are counts of this; a power of two, so that they are exact in floating point.
const STEP: f64 = 1.0 / 4096.0;
/// Bits of [`STEP`].
const STEP_BITS: u32 = 12;
/// Half a sample.
const HALF: u128 = 1 << (STEP_BITS - 1);
/// No pixel gets less than this: what the pilot has not met may be there.
const LEAST: f64 = 0.25;
/// No pixel gets more than this, but for what is left over when all get it that want it.
const GREATEST: f64 = 4.0;
/// Rounds in which all pixels get a sample.
const EVEN_ROUNDS: u64 = 2;
/// Pixels to each side whose variances are averaged for a pixel's.
const REACH: usize = 3;
/// Of what is wanted most this is the least share that still counts.
const WORTH: f64 = 1e-9;
/// Halvings, on a logarithmic scale, of the interval that the factor of the rates is in: 2^-36 of it is left.
const HALVINGS: u32 = 40;
/// What a sample costs beside its random numbers, in those: in scenes A, B, D and G of the benchmark 10 to 13, by the times of tiles.
const BEGINNING: f64 = 10.0;
/// Radiance below this share of the picture's mean is not asked to be as exact, relative to itself, as what is brighter.
const DARK: f64 = 1.0;

/// So many rounds of samples at most fit a film with rates, which are 5 at most.
pub(crate) const MAX_ROUNDS: u64 = MAX_SAMPLES / 5;
/// Rounds beyond this number have samples without numbers.
const LAST_ROUND: u64 = 1 << 60;

/// Whether the sums have room for so many samples of all pixels, and samples have numbers.
pub(crate) fn check(rounds: &SampleRanges) -> Result<(), RangeError> {
    let ends_late = rounds.as_slice().iter().any(|range| range.end > LAST_ROUND);
    if ends_late || rounds.count() > MAX_ROUNDS { Err(RangeError::TooManyAdaptive) } else { Ok(()) }
}

/// A rate for each pixel, row by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rates(Vec<u16>);

impl Rates {
    /// Those by which a picture has the least mean relative variance, as far as a pilot of it tells; of a black one, or one
    /// without noise, 1 everywhere.
    pub fn of_pilot(pilot: &Film) -> Self {
        Self(in_proportion(&wanted(pilot)).iter().map(|rate| (rate / STEP).round() as u16).collect())
    }

    /// Rates from a file.
    pub(crate) fn from_steps(steps: Vec<u16>) -> Result<Self, String> {
        let is_rate = |&step: &u16| (LEAST..=GREATEST + 1.0).contains(&(f64::from(step) * STEP));
        if steps.iter().all(is_rate) { Ok(Self(steps)) } else { Err("it holds what is no rate".into()) }
    }

    /// Rates that no pixel may have.
    #[cfg(test)]
    pub(crate) fn unchecked(steps: Vec<u16>) -> Self {
        Self(steps)
    }

    /// The rates in counts of 1/4096.
    pub(crate) fn as_steps(&self) -> &[u16] {
        &self.0
    }
}

/// Numbers of the samples that a pixel with this rate (none is 1) gets in some rounds.
#[inline(always)]
pub(crate) fn samples(step: Option<u16>, rounds: &Range<u64>) -> Range<u64> {
    match step {
        Some(step) => count(step, rounds.start)..count(step, rounds.end),
        None => rounds.clone(),
    }
}

fn count(step: u16, rounds: u64) -> u64 {
    let even = rounds.min(EVEN_ROUNDS);
    // Films take so few rounds that it fits.
    even.wrapping_add(((u128::from(rounds - even) * u128::from(step) + HALF) >> STEP_BITS) as u64)
}

/// What the rates are to be in proportion to: the root of relative variance over cost, around each pixel.
fn wanted(pilot: &Film) -> Vec<f64> {
    let size = [pilot.width() as usize, pilot.height() as usize];
    let (mut means, mut variances, mut costs) = (Vec::new(), Vec::new(), Vec::new());
    pilot.for_each_pixel(|index, n| {
        let variance = pilot.pixel_standard_error(index, n).map(|error| error * error * n as f64);
        means.push(pilot.pixel_mean(index, n));
        // Of a pixel without two good samples nothing is known.
        variances.push(if variance.iter().all(|v| v.is_finite()) { variance } else { [0.0; 3] });
        costs.push([BEGINNING + pilot.effort(index, n)]);
    });
    let brightness = means.iter().flatten().map(|mean| mean.abs()).sum::<f64>() / (3 * means.len()) as f64;
    let dark = DARK * brightness * DARK * brightness;
    let [means, variances] = [means, variances].map(|values| around(&values, size));
    let relative = |mean: [f64; 3], variance: [f64; 3]| -> f64 {
        (0..3).map(|c| variance[c] / (mean[c] * mean[c] + dark)).filter(|v| v.is_finite()).sum()
    };
    let costs = around(&costs, size);
    let pixels = means.into_iter().zip(variances).zip(costs);
    pixels.map(|((mean, variance), [cost])| (relative(mean, variance) / cost).sqrt()).collect()
}

/// Means over the pixels within [`REACH`], as far as the picture goes.
fn around<const N: usize>(values: &[[f64; N]], [width, height]: [usize; 2]) -> Vec<[f64; N]> {
    let within = |at: usize, edge: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(edge);
    let mean = |values: &mut dyn Iterator<Item = [f64; N]>| {
        let (mut sum, mut count) = ([0.0; N], 0.0);
        for value in values {
            (0..N).for_each(|c| sum[c] += value[c]);
            count += 1.0;
        }
        sum.map(|sum| sum / count)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let rows: Vec<[f64; N]> = pixels
        .clone()
        .map(|(x, y)| mean(&mut within(x, width).map(|column| values[y * width + column])))
        .collect();
    pixels.map(|(x, y)| mean(&mut within(y, height).map(|row| rows[row * width + x]))).collect()
}

/// Rates in proportion to what is wanted, as far as they may be, with a mean of 1.
fn in_proportion(wanted: &[f64]) -> Vec<f64> {
    let most = wanted.iter().copied().fold(0.0, f64::max);
    if most == 0.0 {
        return vec![1.0; wanted.len()];
    }
    let rate = |wanted: f64, factor: f64| (wanted * factor).clamp(LEAST, GREATEST);
    let mean = |factor| wanted.iter().map(|&wanted| rate(wanted, factor)).sum::<f64>() / wanted.len() as f64;
    // All of them are least at the one end, and all that are worth it greatest at the other.
    let (mut low, mut high) = (LEAST / most, GREATEST / (WORTH * most));
    for _ in 0..HALVINGS {
        let middle = low.sqrt() * high.sqrt();
        if mean(middle) < 1.0 { low = middle } else { high = middle }
    }
    // Where most is wanted nowhere, the greatest rates of the others leave samples over.
    let rest = (1.0 - mean(low)).max(0.0);
    wanted.iter().map(|&wanted| rate(wanted, low) + rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmTile;
    use crate::sample::{Layers, Sample};

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn rates_are_in_proportion_within_their_bounds_and_have_a_mean_of_one() {
        let rates = in_proportion(&[1.0, 2.0, 1.0, 0.0, 0.5]);
        assert!((mean(&rates) - 1.0).abs() < 1e-9, "{rates:?}");
        assert!((rates[1] / rates[0] - 2.0).abs() < 1e-9 && (rates[3] - LEAST).abs() < 1e-9, "{rates:?}");
        assert_eq!(in_proportion(&[0.0; 3]), [1.0; 3]);
        let rates = in_proportion(&[3e-160, 6e-160]);
        assert!((rates[1] / rates[0] - 2.0).abs() < 1e-9, "{rates:?}");
    }

    #[test]
    fn what_few_pixels_cannot_take_goes_to_all() {
        let wanted: Vec<f64> = (0..100).map(|i| if i < 5 { 1.0 } else { 0.0 }).collect();
        let rates = in_proportion(&wanted);
        assert!((mean(&rates) - 1.0).abs() < 1e-9 && rates[0] > GREATEST && rates[9] > LEAST, "{rates:?}");
    }

    #[test]
    fn rounds_follow_each_other_and_begin_evenly() {
        for step in [1024, 4096, 5000, 20_480] {
            assert_eq!(samples(Some(step), &(0..2)), 0..2);
            let mut next = 0;
            for round in 0..100 {
                let of_round = samples(Some(step), &(round..round + 1));
                assert_eq!(of_round.start, next);
                next = of_round.end;
            }
            let expected = 2.0 + 98.0 * f64::from(step) * STEP;
            assert!((next as f64 - expected).abs() <= 0.5, "{step}: {next}");
        }
        assert_eq!(samples(None, &(7..9)), 7..9);
    }

    /// Grey noise of this deviation about a mean, by pixel.
    fn pilot(light: impl Fn(u32, u32) -> [f32; 2]) -> Film {
        let mut film = Film::new(48, 20, Layers::NONE).unwrap();
        film.open_range(0).unwrap();
        for number in 0..film.tile_count() {
            let rect = film.tile_rect(number);
            let mut tile = FilmTile::new(rect, 0..4, Layers::NONE);
            for (y, x) in (rect.y..rect.y + rect.height)
                .flat_map(|y| (rect.x..rect.x + rect.width).map(move |x| (y, x)))
            {
                let [mean, deviation] = light(x, y);
                for sign in [1.0, -1.0, 1.0, -1.0] {
                    tile.add(x, y, &Sample { radiance: [mean + sign * deviation; 3], ..Sample::default() });
                }
            }
            film.merge_tile(&tile);
        }
        film.complete_through(4).unwrap();
        film
    }

    #[test]
    fn pixels_get_samples_by_their_relative_deviation() {
        let rates = Rates::of_pilot(&pilot(|x, _| [1.0, if x < 24 { 0.1 } else { 0.3 }]));
        let rate = |x: usize, y: usize| f64::from(rates.0[y * 48 + x]);
        assert!((rate(40, 10) / rate(3, 4) - 3.0).abs() < 0.01, "{} {}", rate(40, 10), rate(3, 4));
        assert!(rate(24, 0) < rate(40, 10) && rate(24, 0) > rate(3, 4), "there is no edge in between");
        // Of a light twice as bright the same noise is half as much; in the dark that counts no more.
        let rates = Rates::of_pilot(&pilot(|x, _| [[2.0, 1.0, 0.01, 0.0][x as usize / 12], 0.1]));
        let rate = |x: usize| f64::from(rates.0[10 * 48 + x]);
        assert!(
            rate(16) > 1.2 * rate(6) && rate(31) > 1.2 * rate(16),
            "{} {} {}",
            rate(6),
            rate(16),
            rate(31)
        );
        assert!((rate(44) / rate(31) - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_pilot_without_noise_or_light_gives_all_the_same() {
        for of_light in [[1.0, 0.0], [0.0, 0.0], [f32::NAN, 0.0]] {
            assert_eq!(Rates::of_pilot(&pilot(|_, _| of_light)).0, vec![4096; 48 * 20]);
        }
    }

    #[test]
    fn rates_that_none_is_given_are_refused() {
        assert!(Rates::from_steps(vec![4096, 1024]).is_ok());
        for wrong in [0, 1023, 20_481] {
            assert!(Rates::from_steps(vec![4096, wrong]).is_err());
        }
    }
}
