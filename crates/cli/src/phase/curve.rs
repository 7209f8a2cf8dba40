//! A phase function over the scattering angle alone, whatever it depends on.

use std::f64::consts::TAU;

use glam::DVec3;
use tyndall_optics::PhaseFunction;
use tyndall_optics::mie::MieError;
use tyndall_scene::MieSpheres;

/// Azimuths over which the phase function of oriented particles is averaged.
const AZIMUTHS: u32 = 512;

/// A phase function for light that arrives in one direction.
pub struct Curve {
    name: String,
    phase: PhaseFunction,
    /// The direction for oriented particles, if it is not along their axis.
    incidence: Option<DVec3>,
    /// The spheres that it is of, if it comes from Lorenz-Mie theory.
    spheres: Option<MieSpheres>,
}

impl Curve {
    /// `incidence` only concerns oriented particles.
    pub fn new(name: String, phase: PhaseFunction, incidence: Option<DVec3>) -> Curve {
        let incidence = incidence.filter(|_| matches!(phase, PhaseFunction::Sggx(_)));
        Curve { name, phase, incidence, spheres: None }
    }

    /// The phase function of spheres: exact if they are all alike, else their table.
    pub fn of_spheres(name: String, spheres: MieSpheres) -> Result<Curve, MieError> {
        let phase = spheres.average.phase_function()?;
        Ok(Curve { name, phase, incidence: None, spheres: Some(spheres) })
    }

    /// The spheres, if it comes from Lorenz-Mie theory.
    pub fn spheres(&self) -> Option<&MieSpheres> {
        self.spheres.as_ref()
    }

    /// What the user called it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Value at an angle in degrees, 1/sr; the mean over the azimuth, by the midpoint rule, where it depends on it.
    pub fn value(&self, degrees: f64) -> f64 {
        if let Some(sphere) = self.spheres.as_ref().and_then(|spheres| spheres.single.as_ref()) {
            return sphere.phase_function(degrees.to_radians().cos());
        }
        let Some(before) = self.incidence else {
            return self.phase.value_at_cosine(degrees.to_radians().cos());
        };
        // Exactly forward the value depends on the azimuth from which that is approached.
        let (sin, cos) = degrees.max(1e-5).to_radians().sin_cos();
        let (tangent, bitangent) = before.any_orthonormal_pair();
        let values = (0..AZIMUTHS).map(|i| {
            let (sin_phi, cos_phi) = (TAU * (f64::from(i) + 0.5) / f64::from(AZIMUTHS)).sin_cos();
            let after = before * cos + tangent * (sin * cos_phi) + bitangent * (sin * sin_phi);
            self.phase.value(before, after.normalize())
        });
        values.sum::<f64>() / f64::from(AZIMUTHS)
    }

    /// The mean cosine.
    pub fn mean_cosine(&self) -> f64 {
        match (self.incidence, &self.spheres) {
            (_, Some(spheres)) => spheres.average.g,
            (Some(before), None) => self.phase.mean_cosine_from(before),
            (None, None) => self.phase.mean_cosine(),
        }
    }

    /// The area that oriented particles turn to the light; none for others.
    pub fn projected_area(&self) -> Option<f64> {
        let PhaseFunction::Sggx(sggx) = &self.phase else { return None };
        Some(self.phase.projected_area(self.incidence.unwrap_or(sggx.axis())))
    }
}
