//! Gradient noise in three dimensions.
//!
//! Source: Perlin 2002, "Improving noise": gradients at the corners of a unit lattice, blended by the quintic
//! 6t⁵ − 15t⁴ + 10t³. The gradients are hashed from the lattice point, so there is no table and no period.

use glam::{IVec3, Vec3};

/// Noise of mean 0 at `p`, within about ±1, with features of about unit size.
pub(super) fn gradient_noise(p: Vec3, seed: u32) -> f32 {
    let base = floor(p);
    let f = p - base;
    let blend = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let cell = base.as_ivec3();
    let corner = |x: i32, y: i32, z: i32| {
        let step = IVec3::new(x, y, z);
        gradient(cell + step, seed).dot(f - step.as_vec3())
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let edge = |y, z| mix(corner(0, y, z), corner(1, y, z), blend.x);
    let face = |z| mix(edge(0, z), edge(1, z), blend.y);
    mix(face(0), face(1), blend.z)
}

/// `octaves` layers of noise, each of half the size and half the strength of the one before.
pub(super) fn fractal_noise(p: Vec3, octaves: u32, seed: u32) -> f32 {
    let mut sum = 0.0;
    let mut strength = 1.0;
    let mut scaled = p;
    for octave in 0..octaves {
        sum += strength * gradient_noise(scaled, seed.wrapping_add(octave));
        strength *= 0.5;
        // A shift hides that all lattices have their zeros in common.
        scaled = scaled * 2.0 + 17.3;
    }
    sum
}

/// Without the call that `f32::floor` is where the processor's rounding instruction cannot be assumed.
fn floor(p: Vec3) -> Vec3 {
    let toward_zero = p.as_ivec3().as_vec3();
    toward_zero - Vec3::select(p.cmplt(toward_zero), Vec3::ONE, Vec3::ZERO)
}

/// One of the twelve directions to the edges of a cube.
fn gradient(cell: IVec3, seed: u32) -> Vec3 {
    let mut h = seed.wrapping_mul(0x9e37_79b9);
    for coordinate in [cell.x, cell.y, cell.z] {
        h = (h ^ coordinate as u32).wrapping_mul(0x85eb_ca6b);
        h ^= h >> 15;
    }
    h = h.wrapping_mul(0xc2b2_ae35);
    h ^= h >> 16;
    let sign = |bit: u32| if h >> bit & 1 == 0 { 1.0 } else { -1.0 };
    match h >> 8 & 0xff {
        0..=84 => Vec3::new(sign(0), sign(1), 0.0),
        85..=169 => Vec3::new(sign(0), 0.0, sign(1)),
        _ => Vec3::new(0.0, sign(0), sign(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_bounded_and_of_mean_zero() {
        let mut sum = 0.0;
        let n = 40_000;
        for i in 0..n {
            let p = Vec3::new(i as f32 * 0.173, (i % 977) as f32 * 0.31, (i % 131) as f32 * 0.77) - 300.0;
            let value = gradient_noise(p, 5);
            assert!(value.abs() <= 1.1);
            assert!((gradient_noise(p + Vec3::X * 1e-3, 5) - value).abs() < 5e-3);
            sum += value;
        }
        assert!((sum / n as f32).abs() < 0.01, "{}", sum / n as f32);
        assert_ne!(gradient_noise(Vec3::splat(0.4), 1), gradient_noise(Vec3::splat(0.4), 2));
    }
}
