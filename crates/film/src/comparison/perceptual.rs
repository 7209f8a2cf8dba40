//! How different two pictures look: a plain relative of FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator
//! for Alternating Images").
//!
//! Exposure, tone map, a blur as wide as the luminance filter of FLIP at 67 pixels a degree (σ = 1 pixel), CIELAB
//! under D65, and the distance HyAB = |ΔL*| + sqrt(Δa*² + Δb*²), which stays in proportion for large differences
//! (Abasi, Tehran, Fairchild 2020).

use super::Picture;
use crate::estimates::LUMINANCE;
use crate::tone_map::tone_map;

/// Mean luminance of the reference after exposure.
const MEAN_LUMINANCE: f64 = 0.25;
/// L* of white: distances are capped there and divided by it.
const WHITE: f64 = 100.0;
/// A Gaussian of σ = 1 at distances of 0, 1, 2, 3 pixels: exp(−x²/2).
const GAUSSIAN: [f64; 4] = [1.0, 0.606_530_659_712_633, 0.135_335_283_236_612, 0.011_108_996_538_242];

/// Mean perceived difference, 0 to 1; `b` decides the exposure.
pub fn difference(a: &Picture, b: &Picture) -> f64 {
    let mean = b.mean();
    let luminance: f64 = (0..3).map(|c| LUMINANCE[c] * mean[c]).sum();
    let exposure = if luminance > 0.0 { MEAN_LUMINANCE / luminance } else { 1.0 };
    let [a, b] = [a, b].map(|picture| as_seen(picture, exposure));
    let sum: f64 = a.iter().zip(&b).map(|(&a, &b)| hyab(lab(a), lab(b)).min(WHITE)).sum();
    sum / a.len() as f64 / WHITE
}

/// What reaches the eye from a screen, linear.
fn as_seen(picture: &Picture, exposure: f64) -> Vec<[f64; 3]> {
    let shown = |rgb: &[f32; 3]| tone_map(rgb.map(|x| (f64::from(x) * exposure) as f32)).map(f64::from);
    let shown: Vec<[f64; 3]> = picture.rgb.iter().map(shown).collect();
    let across = blurred(&shown, picture.width, picture.height, 1, picture.width);
    blurred(&across, picture.height, picture.width, picture.width, 1)
}

/// Blurs along lines of `length` pixels that stand `step` apart; the `lines` begin `line_step` apart. Weights are
/// renormalised at the ends.
fn blurred(image: &[[f64; 3]], length: usize, lines: usize, step: usize, line_step: usize) -> Vec<[f64; 3]> {
    let radius = GAUSSIAN.len() - 1;
    let mut out = vec![[0.0; 3]; image.len()];
    for line in 0..lines {
        for at in 0..length {
            let (mut sum, mut weights) = ([0.0; 3], 0.0);
            for other in at.saturating_sub(radius)..(at + radius + 1).min(length) {
                let weight = GAUSSIAN[at.abs_diff(other)];
                let colour = image[line * line_step + other * step];
                sum = [0, 1, 2].map(|c| sum[c] + weight * colour[c]);
                weights += weight;
            }
            out[line * line_step + at * step] = sum.map(|x| x / weights);
        }
    }
    out
}

/// CIE 1976 L*, a*, b* of a linear Rec.709 colour, relative to its white.
fn lab(rgb: [f64; 3]) -> [f64; 3] {
    // Rows give X, Y, Z over those of white, so that every row adds up to 1 (IEC 61966-2-1, D65).
    const XYZ: [[f64; 3]; 3] = [
        [0.433_953, 0.376_219, 0.189_828],
        [0.212_673, 0.715_152, 0.072_175],
        [0.017_758, 0.109_477, 0.872_765],
    ];
    let [x, y, z] = XYZ.map(|row| {
        let t = row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2];
        if t > (6.0f64 / 29.0).powi(3) {
            libm::cbrt(t)
        } else {
            t * (29.0f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn hyab(p: [f64; 3], q: [f64; 3]) -> f64 {
    (p[0] - q[0]).abs() + libm::hypot(p[1] - q[1], p[2] - q[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(rgb: [f32; 3]) -> Picture {
        Picture { width: 9, height: 7, rgb: vec![rgb; 63], standard_error: None }
    }

    #[test]
    fn lab_has_the_known_values_of_white_and_red() {
        let close = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).all(|(p, q)| (p - q).abs() < 0.02);
        assert!(close(lab([1.0; 3]), [100.0, 0.0, 0.0]));
        assert!(close(lab([1.0, 0.0, 0.0]), [53.24, 80.09, 67.20]), "{:?}", lab([1.0, 0.0, 0.0]));
    }

    #[test]
    fn equal_pictures_do_not_differ_and_black_differs_from_grey_by_its_lightness() {
        let grey = flat([0.3, 0.3, 0.3]);
        assert_eq!(difference(&grey, &grey), 0.0);
        let lightness = lab([0.25; 3])[0] / 100.0;
        assert!((difference(&flat([0.0; 3]), &grey) - lightness).abs() < 1e-6);
    }

    #[test]
    fn noise_that_the_eye_averages_out_counts_less_than_a_shift() {
        let grey = flat([0.5; 3]);
        let mut noisy = grey.clone();
        for (i, rgb) in noisy.rgb.iter_mut().enumerate() {
            *rgb = rgb.map(|x| if i % 2 == 0 { x + 0.1 } else { x - 0.1 });
        }
        assert!(difference(&noisy, &grey) < 0.2 * difference(&flat([0.6; 3]), &grey));
    }
}
