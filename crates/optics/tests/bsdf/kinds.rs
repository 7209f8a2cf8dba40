//! The surfaces that all tests go through, and directions about them.

use glam::{DVec3, DVec4};
use tyndall_optics::bsdf::{
    Bsdf, Coat, Conductor, Dielectric, Ggx, Mix, Plastic, RoughDiffuse, ThinDielectric,
};

/// White in red, green and blue.
pub const WHITE: DVec4 = DVec4::new(1.0, 1.0, 1.0, 0.0);

/// Of three colours.
pub const ORANGE: DVec4 = DVec4::new(0.9, 0.5, 0.1, 0.0);

/// About copper's indices at 630, 530 and 450 nm.
pub fn copper(alpha: [f64; 2]) -> Bsdf {
    let eta = DVec4::new(0.27, 1.13, 1.24, 0.0);
    let k = DVec4::new(3.41, 2.6, 2.4, 0.0);
    Bsdf::Conductor(Conductor { eta, k, tint: WHITE, facets: Ggx::new(alpha) })
}

/// A conductor that reflects all light but 4e-12.
pub fn mirror(alpha: [f64; 2]) -> Bsdf {
    let k = DVec4::splat(1e6);
    Bsdf::Conductor(Conductor { eta: DVec4::ONE, k, tint: WHITE, facets: Ggx::new(alpha) })
}

pub fn glass(index: f64, alpha: [f64; 2]) -> Bsdf {
    tinted_glass(index, alpha, WHITE, WHITE)
}

pub fn tinted_glass(index: f64, alpha: [f64; 2], reflection_tint: DVec4, transmission_tint: DVec4) -> Bsdf {
    let facets = Ggx::new(alpha);
    Bsdf::Dielectric(Dielectric { index, reflection_tint, transmission_tint, facets })
}

pub fn sheet(index: f64) -> Bsdf {
    Bsdf::ThinDielectric(ThinDielectric { index, reflection_tint: WHITE, transmission_tint: WHITE })
}

pub fn plastic(index: f64, alpha: [f64; 2], reflectance: DVec4, nonlinear: bool) -> Bsdf {
    Bsdf::Plastic(Plastic::new(Coat::new(index, alpha), reflectance, WHITE, nonlinear))
}

pub fn mix(first: Bsdf, second: Bsdf, amount: DVec4) -> Bsdf {
    Bsdf::Mix(Box::new(Mix { parts: [first, second], shares: [WHITE - amount, amount] }))
}

/// Those that have something else than mirrors.
pub fn scattering() -> Vec<Bsdf> {
    let matte = Bsdf::Diffuse { reflectance: ORANGE };
    vec![
        matte.clone(),
        Bsdf::RoughDiffuse(RoughDiffuse::new(ORANGE, 10.0)),
        Bsdf::RoughDiffuse(RoughDiffuse::new(ORANGE, 60.0)),
        copper([0.08, 0.08]),
        copper([0.15, 0.5]),
        copper([1.0, 1.0]),
        glass(1.5, [0.1, 0.1]),
        glass(1.0 / 1.33, [0.3, 0.3]),
        glass(2.4, [0.8, 0.8]),
        tinted_glass(1.5, [0.6, 0.2], ORANGE, DVec4::new(0.2, 0.9, 0.5, 0.0)),
        plastic(1.5, [0.0, 0.0], ORANGE, false),
        plastic(1.5, [0.2, 0.2], ORANGE, true),
        plastic(1.9, [0.1, 0.4], ORANGE, false),
        mix(matte.clone(), mirror([0.0, 0.0]), DVec4::new(0.3, 0.6, 0.9, 0.0)),
        mix(glass(1.5, [0.3, 0.3]), mix(matte, copper([0.3, 0.3]), ORANGE), DVec4::splat(0.4) * WHITE),
        mix(sheet(1.5), plastic(1.5, [0.0, 0.0], ORANGE, false), DVec4::splat(0.7) * WHITE),
    ]
}

/// Nothing but mirrors.
pub fn mirrors() -> Vec<Bsdf> {
    vec![
        copper([0.0, 0.0]),
        glass(1.5, [0.0, 0.0]),
        glass(1.0 / 1.5, [0.0, 0.0]),
        glass(1.0, [0.5, 0.5]),
        sheet(1.5),
        tinted_glass(1.33, [0.0, 0.0], ORANGE, DVec4::new(0.2, 0.9, 0.5, 0.0)),
        mix(mirror([0.0, 0.0]), sheet(1.33), ORANGE),
    ]
}

/// Along the normal, oblique, nearly grazing; above and below.
pub fn directions() -> Vec<DVec3> {
    [(1.0, 0.0), (0.8, 2.0), (0.35, -0.7), (0.08, 4.0), (-0.9, 1.0), (-0.25, 5.0)]
        .map(|(cos, phi)| direction(cos, phi))
        .to_vec()
}

pub fn direction(cos: f64, phi: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}
