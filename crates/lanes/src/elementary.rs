//! Elementary functions in f32 by polynomials: the same bits on every machine and free of branches, so that
//! loops over arrays of them become vector code.
//!
//! The coefficients are least-squares fits on the reduced ranges named below; the stated errors are checked by the
//! tests against the f64 functions of the standard library.

/// Natural logarithm of a positive, finite, normal `x`; relative error below 3e-7 (absolute near 1).
#[inline(always)]
pub fn ln(x: f32) -> f32 {
    // x = m·2^e with m in [√½, √2)
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (shifted as i32) >> 23;
    let mantissa = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF_BITS);
    let f = mantissa - 1.0;
    let mut q = -0.081_015_59_f32;
    q = q * f + 0.127_123_08;
    q = q * f - 0.129_722_39;
    q = q * f + 0.142_021_74;
    q = q * f - 0.166_422_48;
    q = q * f + 0.200_014_7;
    q = q * f - 0.250_002_97;
    q = q * f + 0.333_333_3;
    let exponent = exponent as f32;
    // ln 2 in two parts, so that e·ln 2 keeps its low bits.
    let low = f * f * (q * f - 0.5) + exponent * -2.121_944_4e-4;
    (low + f) + exponent * 0.693_359_4
}

/// Exponential of `x`, relative error below 3e-7; 0 below −87, and `x` must not exceed 88.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    let clamped = x.max(-87.0);
    let turns = clamped * std::f32::consts::LOG2_E;
    // Adding and taking off 1.5·2^23 rounds to the nearest integer without a call.
    const ROUND: f32 = 12_582_912.0;
    let rounded = turns + ROUND;
    let whole = rounded - ROUND;
    let f = (clamped - whole * 0.693_359_4) - whole * -2.121_944_4e-4;
    let g = f * std::f32::consts::LOG2_E;
    let mut p = 1.546_534_3e-4_f32;
    p = p * g + 1.339_531e-3;
    p = p * g + 9.618_04e-3;
    p = p * g + 5.550_340_6e-2;
    p = p * g + 0.240_226_5;
    p = p * g + std::f32::consts::LN_2;
    p = p * g + 1.0;
    // The integer stands in the low bits: to convert it would keep loops from becoming vector code.
    let scale = f32::from_bits(rounded.to_bits().wrapping_add(127) << 23);
    if x < -87.0 { 0.0 } else { p * scale }
}

/// (sin 2πu, cos 2πu) for `u` in [0, 1]; absolute error below 3e-7.
#[inline(always)]
pub fn sin_cos_turns(u: f32) -> (f32, f32) {
    // u = k/4 + r with r in [−1/8, 1/8]
    const ROUND: f32 = 12_582_912.0;
    let rounded = u * 4.0 + ROUND;
    let quarters = rounded - ROUND;
    let r = u - quarters * 0.25;
    let r2 = r * r;
    let sin =
        r * (std::f32::consts::TAU + r2 * (-41.341_7 + r2 * (81.605_2 + r2 * (-76.698_73 + r2 * 41.503_42))));
    let cos = 1.0 + r2 * (-19.739_209 + r2 * (64.939_33 + r2 * (-85.444_35 + r2 * 59.273_62)));
    let quadrant = rounded.to_bits();
    let (a, b) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
    let sin_sign = if quadrant & 2 == 0 { 1.0 } else { -1.0 };
    let cos_sign = if (quadrant + 1) & 2 == 0 { 1.0 } else { -1.0 };
    (a * sin_sign, b * cos_sign)
}

#[cfg(test)]
mod tests {
    use super::{exp, ln, sin_cos_turns};

    #[test]
    fn ln_is_right_to_3e_7() {
        for i in 0..2_000_000u32 {
            let x = f32::from_bits(0x0080_0000 + i * 1059);
            let truth = f64::from(x).ln();
            let error = (f64::from(ln(x)) - truth).abs() / truth.abs().max(1.0);
            assert!(error < 3e-7, "ln({x}) off by {error}");
        }
        assert_eq!(ln(1.0), 0.0);
    }

    #[test]
    fn exp_is_right_to_3e_7() {
        for i in 0..1_000_000 {
            let x = -87.0 + i as f32 * 175.0e-6;
            let truth = f64::from(x).exp();
            let error = (f64::from(exp(x)) / truth - 1.0).abs();
            assert!(error < 3e-7, "exp({x}) off by {error}");
        }
        assert_eq!(exp(-100.0), 0.0);
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
    }

    #[test]
    fn sin_cos_are_right_to_3e_7() {
        for i in 0..=1_000_000 {
            let u = i as f32 * 1e-6;
            let (sin, cos) = sin_cos_turns(u);
            let (true_sin, true_cos) = (f64::from(u) * std::f64::consts::TAU).sin_cos();
            assert!((f64::from(sin) - true_sin).abs() < 3e-7, "sin at {u}");
            assert!((f64::from(cos) - true_cos).abs() < 3e-7, "cos at {u}");
        }
    }
}
