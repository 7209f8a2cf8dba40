//! Figures of another renderer, Mitsuba 3.9.1 (scalar_rgb), which gives f |cos θ′| and densities for single directions: its
//! `plastic`, `roughconductor` and `roughdielectric` with `int_ior` 1.5, `ext_ior` 1.
//!
//! Its rough surfaces take shadowing and masking as independent, G1(ω) G1(ω′), and ours as correlated; the figures are
//! compared with the one put in the place of the other.

use tyndall_optics::bsdf::Ggx;

use super::kinds::{ORANGE, direction, glass, mirror, plastic};

/// The mean reflectance of a face from inside, which Mitsuba has from a polynomial, is about 0.1 % off.
#[test]
fn smooth_plastic_is_mitsubas() {
    for (nonlinear, cos, phi_cos, red, blue) in [
        (false, 1.0, 0.5, 0.138_061_3, 0.015_340_15),
        (false, 0.3, 0.8, 0.191_362_1, 0.021_262_46),
        (false, 0.1, 0.1, 0.005_795_828, 0.000_643_981),
        (true, 1.0, 0.5, 0.120_260_1, 0.006_577_533),
        (true, 0.3, 0.8, 0.166_688_5, 0.009_116_895),
        (true, 0.1, 0.1, 0.005_048_531, 0.000_276_125_5),
    ] {
        let bsdf = plastic(1.5, [0.0, 0.0], ORANGE, nonlinear);
        let value = bsdf.value(direction(cos, 0.0), direction(phi_cos, 1.0));
        assert!((value.x / red - 1.0).abs() < 2e-3 && (value.z / blue - 1.0).abs() < 2e-3, "{cos}: {value}");
    }
}

#[test]
fn rough_metal_and_glass_are_mitsubas() {
    let alpha = [0.3, 0.3];
    let metal = mirror(alpha);
    let glass = glass(1.5, alpha);
    for (bsdf, cos, to_cos, value, pdf) in [
        (&metal, 0.9, 0.5, 0.149_843_1, 0.159_353_8),
        (&metal, 0.3, 0.8, 0.226_747_2, 0.229_581_6),
        (&glass, 0.9, 0.5, 0.006_934_255, 0.007_374_381),
        (&glass, 0.3, 0.8, 0.013_670_34, 0.013_841_22),
        (&glass, 0.9, -0.8, 0.045_502_88, 0.103_661_2),
        (&glass, 0.3, -0.8, 0.003_910_971, 0.008_909_679),
        (&glass, -0.9, 0.7, 0.232_617_8, 0.105_752_6),
        (&glass, -0.8, -0.9, 0.028_406_23, 0.028_555_37),
    ] {
        let (wo, wi) = (direction(cos, 0.0), direction(to_cos, 2.5));
        let facets = Ggx::new(alpha).unwrap();
        let shadowing = facets.seen(wo) * facets.seen(wi) / facets.seen_from_both(wo, wi);
        let ours = bsdf.value(wo, wi).x * shadowing;
        assert!((ours / value - 1.0).abs() < 1e-4, "{cos} {to_cos}: {ours} {value}");
        let density = bsdf.pdf(wo, wi);
        assert!((density / pdf - 1.0).abs() < 1e-4, "{cos} {to_cos}: {density} {pdf}");
    }
}
