//! Whether noise explains a difference of means: z-tests over the whole picture and block by block.

use super::{Picture, ratio};
use crate::estimates::Estimate;

/// The standard errors of both pictures, if they have them and they are known everywhere.
pub fn layers<'a>(a: &'a Picture, b: &'a Picture) -> Option<[&'a [[f32; 3]]; 2]> {
    let both = [a.standard_error.as_deref()?, b.standard_error.as_deref()?];
    both.iter().all(|layer| layer.iter().flatten().all(|e| e.is_finite())).then_some(both)
}

/// Mean of A − B over some pixels, per channel, with its standard error.
pub fn mean_difference(a: &Picture, b: &Picture, pixels: &[usize]) -> [Estimate; 3] {
    [0, 1, 2].map(|c| channel_difference(a, b, layers(a, b), pixels, c))
}

/// z of A − B in whole blocks of `edge` x `edge` pixels, three a block.
pub fn block_tests(a: &Picture, b: &Picture, edge: usize) -> Vec<f64> {
    let layers = layers(a, b);
    let mut tests = Vec::new();
    for block_y in 0..a.height / edge {
        for block_x in 0..a.width / edge {
            let start = block_y * edge * a.width + block_x * edge;
            let pixels: Vec<usize> =
                (0..edge * edge).map(|i| start + i / edge * a.width + i % edge).collect();
            tests.extend([0, 1, 2].map(|c| {
                let difference = channel_difference(a, b, layers, &pixels, c);
                ratio(difference.mean, difference.standard_error)
            }));
        }
    }
    tests
}

fn channel_difference(
    a: &Picture,
    b: &Picture,
    layers: Option<[&[[f32; 3]]; 2]>,
    pixels: &[usize],
    channel: usize,
) -> Estimate {
    let n = pixels.len() as f64;
    let value = |picture: &Picture, i: usize| f64::from(picture.rgb[i][channel]);
    let difference = |i: usize| value(a, i) - value(b, i);
    let mean = pixels.iter().map(|&i| difference(i)).sum::<f64>() / n;
    let variance_of_mean = match layers {
        Some(layers) => {
            let squares = |layer: &[[f32; 3]], i: usize| f64::from(layer[i][channel]).powi(2);
            pixels.iter().map(|&i| squares(layers[0], i) + squares(layers[1], i)).sum::<f64>() / (n * n)
        }
        None => pixels.iter().map(|&i| (difference(i) - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0) / n,
    };
    // Pixels are rounded to 24 bits: a difference below that is none, even where no noise is.
    let brightness = pixels.iter().map(|&i| value(a, i).abs().max(value(b, i).abs())).sum::<f64>() / n;
    let rounding = brightness * f64::from(f32::EPSILON);
    Estimate { mean, standard_error: libm::hypot(variance_of_mean.sqrt(), rounding) }
}

/// Probability that a standard normal number is beyond ±z; by the continued fraction of Mills' ratio (Laplace),
/// Q(z) = φ(z) / (z + 1/(z + 2/(z + 3/(z + …)))), which has converged to 1e-9 from z = 2 up.
pub fn two_sided_tail(z: f64) -> f64 {
    let fraction = (1..=200).rev().fold(z, |tail, k| z + f64::from(k) / tail);
    2.0 * libm::exp(-0.5 * z * z) / ((2.0 * std::f64::consts::PI).sqrt() * fraction)
}

/// The z beyond which both tails together hold `probability`, which must be below 0.04; by bisection.
pub fn critical_z(probability: f64) -> f64 {
    let (mut low, mut high) = (2.0, 40.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if two_sided_tail(middle) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_and_critical_values_are_those_of_the_tables() {
        for (z, tail) in [(2.0, 0.045_500_263_9), (3.0, 2.699_796_063e-3), (5.0, 5.733_031_437e-7)] {
            assert!((two_sided_tail(z) / tail - 1.0).abs() < 1e-8, "{z}");
        }
        assert!((critical_z(0.01) - 2.575_829_304).abs() < 1e-8);
    }
}
