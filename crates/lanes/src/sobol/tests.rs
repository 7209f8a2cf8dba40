//! Claims about the points: nets, uniformity, independence of sets and pixels, and how fast errors fall.

use super::{DIRECTIONS, Stratified, coordinates, second_coordinate};
use crate::random::mix;

/// Points `start..start + count` of set `set` of a pixel.
fn pairs(seed: u64, pixel: u64, set: u32, start: u64, count: u64) -> Vec<[f32; 2]> {
    (start..start + count).map(|sample| Stratified::new(seed, pixel, sample).point2(set)).collect()
}

/// Number of points in each box of a grid of 2^k[d] columns along each axis d.
fn occupation<const D: usize>(points: &[[f32; D]], k: [u32; D]) -> Vec<u32> {
    let mut boxes = vec![0; 1 << k.iter().sum::<u32>()];
    for point in points {
        let number =
            point.iter().zip(k).fold(0, |number, (&x, k)| (number << k) + (x * (1u32 << k) as f32) as usize);
        boxes[number] += 1;
    }
    boxes
}

/// Joe and Kuo's numbers as fractions: m_k/2^k of the third and fourth coordinates, by their recurrences on paper.
#[test]
fn direction_numbers_are_those_of_joe_and_kuo() {
    let numbers = |coordinate: usize| -> Vec<u32> {
        (0..6).map(|k| DIRECTIONS[k][coordinate].reverse_bits() >> (31 - k)).collect()
    };
    assert_eq!(numbers(0), [1, 2, 4, 8, 16, 32].map(|_| 1).to_vec(), "m_k of the radical inverse is 1");
    assert_eq!(numbers(1), [1, 3, 5, 15, 17, 51]);
    assert_eq!(numbers(2), [1, 3, 3, 9, 29, 23]);
    assert_eq!(numbers(3), [1, 3, 1, 5, 31, 29]);
}

#[test]
fn the_second_coordinate_has_a_short_way() {
    for i in 0..100_000u64 {
        let index = mix(i) as u32;
        assert_eq!(coordinates(index)[0], index);
        assert_eq!(coordinates(index)[1], second_coordinate(index));
    }
}

#[test]
fn pairs_and_singles_are_the_first_coordinates_of_four() {
    for sample in 0..1000 {
        let stratified = Stratified::new(3, 5, sample);
        let four = stratified.point4(2);
        assert_eq!(stratified.point2(2), four[..2]);
        assert_eq!(stratified.point1(2), four[0]);
        assert!(four.iter().all(|x| (0.0..1.0).contains(x)));
    }
}

/// The branches of an aligned block of samples are points as even as those of so many samples; beyond 2^32 of them they are others.
#[test]
fn branches_of_a_block_of_samples_are_a_net() {
    let branches = |first: u64| -> Vec<[f32; 2]> {
        let samples = (first..first + 16).map(|sample| Stratified::new(4, 9, sample));
        samples.flat_map(|sample| (0..4).map(move |branch| sample.branch(branch, 4).point2(3))).collect()
    };
    for first in [0, 48, 1 << 20] {
        for k in 0..=6 {
            assert_eq!(occupation(&branches(first), [k, 6 - k]), [1; 64]);
        }
    }
    assert_ne!(branches(0), branches(1 << 30));
    assert_eq!(Stratified::new(4, 9, 5).branch(0, 1), Stratified::new(4, 9, 5));
}

/// Every aligned block of 2^m samples has one point in each box of area 2^-m, of whatever shape.
#[test]
fn each_block_of_pairs_is_a_net() {
    for m in 0..=10 {
        for (seed, pixel, set) in [(0, 0, 0), (1, 77, 1), (9, 123_456_789, 5)] {
            for block in [0, 1, 6, 1023] {
                let points = pairs(seed, pixel, set, block << m, 1 << m);
                for columns in 0..=m {
                    let boxes = occupation(&points, [columns, m - columns]);
                    assert!(
                        boxes.iter().all(|&n| n == 1),
                        "2^{m} points, 2^{columns} columns, block {block}"
                    );
                }
            }
        }
    }
}

/// Sobol's bound: four coordinates of degrees 0, 1, 2, 3 are a (0 + 0 + 1 + 2, m, 4)-net.
#[test]
fn each_block_of_fours_is_a_net_of_quality_3() {
    const M: u32 = 9;
    let points: Vec<[f32; 4]> = (0..1 << M).map(|i| Stratified::new(4, 8, 512 + i).point4(3)).collect();
    for code in 0..(M - 2).pow(3) {
        let [a, b, c] = [code % 7, code / 7 % 7, code / 49];
        if a + b + c <= M - 3 {
            let boxes = occupation(&points, [a, b, c, M - 3 - a - b - c]);
            assert!(boxes.iter().all(|&n| n == 8), "2^{a} x 2^{b} x 2^{c} columns");
        }
    }
}

/// χ² over 16x16 cells; each statistic stays below the 1 − 10⁻⁶ quantile at 255 degrees of freedom (about 375).
#[test]
fn points_are_uniform_and_independent_over_pixels_seeds_and_sets() {
    const N: u64 = 1 << 17;
    let mut kinds = [[0_u32; 256]; 8];
    for i in 0..N {
        let here = Stratified::new(1, i, 3);
        let [x, y] = here.point2(0);
        let pairs = [
            [x, y],
            [x, Stratified::new(1, i + 1, 3).point1(0)],
            [x, Stratified::new(1, i, 4).point1(0)],
            [x, here.point1(1)],
            [y, here.point2(1)[1]],
            [here.point4(2)[2], here.point4(2)[3]],
            [Stratified::new(i, 9, 0).point1(4), Stratified::new(i + 1, 9, 0).point1(4)],
            [Stratified::new(2, 9, 0).point1(i as u32), Stratified::new(2, 9, 0).point1(i as u32 + 1)],
        ];
        for (kind, pair) in kinds.iter_mut().zip(pairs) {
            let [a, b] = pair.map(|u| (u * 16.0) as usize);
            kind[a * 16 + b] += 1;
        }
    }
    let expected = N as f64 / 256.0;
    let chi2 =
        kinds.map(|cells| cells.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum::<f64>());
    for (kind, &chi2) in chi2.iter().enumerate() {
        // Samples 3 and 4 of a pixel are of one net: their order is uniform, but they avoid each other.
        let is_of_one_net = kind == 2;
        assert_eq!(chi2 < 375.0, !is_of_one_net, "kind {kind}: chi2 {chi2}");
    }
}

/// Mean and variance over scramblings of the mean of f over 2^m points.
fn moments(points: impl Fn(u64) -> Vec<[f32; 2]>, f: fn([f64; 2]) -> f64) -> (f64, f64) {
    const SCRAMBLINGS: u64 = 2000;
    let means: Vec<f64> = (0..SCRAMBLINGS)
        .map(|scrambling| {
            let points = points(scrambling);
            points.iter().map(|point| f(point.map(f64::from))).sum::<f64>() / points.len() as f64
        })
        .collect();
    let mean = means.iter().sum::<f64>() / SCRAMBLINGS as f64;
    let squares = means.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    (mean, squares / (SCRAMBLINGS - 1) as f64)
}

/// Smooth, of mean (e − 1)/3.
fn smooth([x, y]: [f64; 2]) -> f64 {
    x * x * y.exp()
}

/// 1 in a quarter of a disc, of mean π/4.
fn quarter_disc([x, y]: [f64; 2]) -> f64 {
    if x * x + y * y < 1.0 { 1.0 } else { 0.0 }
}

/// Of (e − 1)/3 and π/4, at |z| < 4: by chance once in 2000 for all eight.
#[test]
fn means_are_unbiased_over_scramblings() {
    for m in [0, 2, 4, 7] {
        for (f, truth) in [
            (smooth as fn([f64; 2]) -> f64, (1f64.exp() - 1.0) / 3.0),
            (quarter_disc, std::f64::consts::FRAC_PI_4),
        ] {
            let (mean, variance) = moments(|pixel| pairs(7, pixel, 1, 3 << m, 1 << m), f);
            let z = (mean - truth) / (variance / 2000.0).sqrt();
            assert!(z.abs() < 4.0, "2^{m} points: {mean}, not {truth}: z = {z}");
        }
    }
}

/// From 16 to 1024 points: n⁻³ log n, which is n^-2.78 there, and n^(-3/2), where independent points have n⁻¹. Sample
/// variances of 2000 values have relative errors of 3 to 5 %, which is 0.01 in the exponents.
#[test]
fn variances_fall_as_theory_says() {
    for (f, exponent) in [(smooth as fn([f64; 2]) -> f64, -2.78), (quarter_disc, -1.5)] {
        let [few, many] = [16, 1024].map(|n| moments(|pixel| pairs(3, pixel, 0, 0, n), f).1);
        let measured = (many / few).log2() / 6.0;
        assert!((measured - exponent).abs() < 0.1, "n^{measured}, not n^{exponent}");
    }
}

/// Sobol's first two coordinates with a coin of its own for each digit and all that come before it.
fn coins_for_every_digit(scrambling: u64, n: u64) -> Vec<[f32; 2]> {
    let scramble = |digits: u32, axis: u64| {
        let x = digits.reverse_bits();
        let flips = (0..24).fold(0, |flips, digit| {
            let before = u64::from(x) >> (32 - digit);
            let coin = mix(mix(scrambling * 64 + digit * 2 + axis) ^ before) >> 63;
            flips | (coin as u32) << (31 - digit)
        });
        super::to_unit(x ^ flips)
    };
    (0..n as u32).map(|i| [scramble(i, 0), scramble(second_coordinate(i), 1)]).collect()
}

/// Variances stay within 25 % of those of ideal coins; those of 2000 values are known to about 6 %.
#[test]
fn the_hash_is_as_good_as_coins_for_every_digit() {
    for n in [4, 16, 64, 256] {
        for f in [smooth, quarter_disc] {
            let ideal = moments(|scrambling| coins_for_every_digit(scrambling, n), f).1;
            let hashed = moments(|pixel| pairs(5, pixel, 0, 0, n), f).1;
            assert!((hashed / ideal - 1.0).abs() < 0.25, "{n} points: {hashed}, not {ideal}");
        }
    }
}

/// The mean of (x − ½)(y − ½) over n points with x and y of different sets. Digit a of x alone has the variance
/// A_a = 4^-(a+2), and the points i and j whose numbers differ in bit a alone have the correlation −2^-a in it, or else
/// none, so that the variance of the mean is (Σ A_a A_b + Σ A_a² 4^-a)/n = (1/144 + 1/252)/n. Without an order of its own
/// for each set, x and y would be bound to each other.
#[test]
fn sets_are_shuffled_against_each_other() {
    let of_two_sets = |pixel: u64| -> Vec<[f32; 2]> {
        let singles = |sample| {
            let stratified = Stratified::new(6, pixel, sample);
            [stratified.point1(0), stratified.point1(1)]
        };
        (0..64).map(singles).collect()
    };
    let (mean, variance) = moments(of_two_sets, |[x, y]| (x - 0.5) * (y - 0.5));
    let expected = (1.0 / 144.0 + 1.0 / 252.0) / 64.0;
    assert!((variance / expected - 1.0).abs() < 0.12, "{variance}, not {expected}");
    assert!(mean.abs() < 4.0 * (variance / 2000.0).sqrt(), "{mean}");
}
