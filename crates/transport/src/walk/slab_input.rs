//! What a user says of a slab: which numbers make sense, with the mend, and which directions cosines stand for.

use glam::DVec3;

use super::layer::Incidence;

/// Which numbers a quantity may have.
#[derive(Debug, Clone, Copy)]
pub struct Rule {
    is_allowed: fn(f64) -> bool,
    mend: &'static str,
}

impl Rule {
    /// The number, if it is allowed.
    ///
    /// # Errors
    /// What to write instead.
    pub fn check(&self, x: f64) -> Result<f64, &'static str> {
        if (self.is_allowed)(x) { Ok(x) } else { Err(self.mend) }
    }

    /// The number that a text stands for.
    ///
    /// # Errors
    /// What to write instead.
    pub fn parse(&self, text: &str) -> Result<f64, &'static str> {
        text.parse().map_err(|_| self.mend).and_then(|x| self.check(x))
    }
}

/// Of the optical thickness: photons take as many scatterings as the layer is thick.
pub const TAU: Rule = Rule {
    is_allowed: |tau| (0.0..=1e6).contains(&tau) || tau == f64::INFINITY,
    mend: "write a number from 0 to 1e6, or inf",
};
/// Of albedos.
pub const ALBEDO: Rule =
    Rule { is_allowed: |albedo| (0.0..=1.0).contains(&albedo), mend: "write a number from 0 to 1" };
/// Of the mean cosine of Henyey and Greenstein's phase function.
pub const ASYMMETRY: Rule =
    Rule { is_allowed: |g| g > -1.0 && g < 1.0, mend: "write a number between -1 and 1, both excluded" };
/// Of the refractive index of a layer in air.
pub const REFRACTIVE_INDEX: Rule =
    Rule { is_allowed: |n| (1.0..=10.0).contains(&n), mend: "write a number from 1 to 10" };
/// Of the angle of incidence, degrees off the normal.
pub const INCIDENCE: Rule = Rule {
    is_allowed: |degrees| (0.0..=89.9).contains(&degrees),
    mend: "write normal, diffuse, or degrees off the normal from 0 to 89.9",
};
/// Of cosines to the normal.
pub const COSINE: Rule = Rule {
    is_allowed: |mu| (0.001..=1.0).contains(&mu),
    mend: "write cosines from 0.001 to 1, such as 1,0.5,0.2",
};
/// Of azimuths, degrees.
pub const AZIMUTH: Rule =
    Rule { is_allowed: |degrees| degrees.abs() <= 360.0, mend: "write degrees from -360 to 360" };

/// Light `degrees` off the normal, which travels towards +x.
///
/// # Errors
/// What to write instead.
pub fn slanted(degrees: f64) -> Result<Incidence, &'static str> {
    let (sin, cos) = libm::sincos(INCIDENCE.check(degrees)?.to_radians());
    Ok(Incidence::Beam(DVec3::new(sin, -cos, 0.0)))
}

/// The directions in which light leaves at cosines `mu` to the normal, `azimuth` degrees from the way a slanted beam
/// travels: all at the top, then, if there is a bottom, all there.
pub fn views(mu: &[f64], azimuth: f64, has_bottom: bool) -> Vec<DVec3> {
    let (sin_azimuth, cos_azimuth) = libm::sincos(azimuth.to_radians());
    let view = |mu: f64| {
        let across = (1.0 - mu * mu).sqrt();
        DVec3::new(across * cos_azimuth, mu, across * sin_azimuth)
    };
    let up = mu.iter().map(|&mu| view(mu));
    let down = mu.iter().map(|&mu| view(-mu)).filter(|_| has_bottom);
    up.chain(down).collect()
}
