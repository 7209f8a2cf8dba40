//! A phase function over the scattering angle alone, whatever it depends on: what `tyndall phase` shows.
//!
//! Of oriented particles it is the mean over the azimuth, for light that arrives in one direction; of spheres that are all
//! alike it is Lorenz-Mie's, without a table between.

use std::f64::consts::TAU;
use std::path::Path;

use glam::DVec3;
use tyndall_optics::PhaseFunction;
use tyndall_optics::mie::MieCache;

use crate::SceneError;
use crate::description::{PhaseDescription, phase_spec};
use crate::mie::{MieSpheres, mie_error, mie_spheres};
use crate::phase::{GREY_WAVELENGTH_NM, build_phase, grey_phase};

/// Azimuths over which the phase function of oriented particles is averaged.
const AZIMUTHS: u32 = 512;

/// A phase function for light that arrives in one direction.
#[derive(Debug, Clone)]
pub struct PhaseCurve {
    name: String,
    phase: PhaseFunction,
    /// The direction for oriented particles, if it is not along their axis.
    incidence: Option<DVec3>,
    /// The spheres that it is of, if it comes from Lorenz-Mie theory.
    spheres: Option<MieSpheres>,
}

impl PhaseCurve {
    /// The phase function that one line such as `hg(g=0.85)` describes, and a note on what was chosen for the user. Light
    /// arrives along the unit vector `incidence`, which only concerns oriented particles; along their axis unless given.
    /// Files are relative to the working folder.
    ///
    /// # Errors
    /// One line that starts with the text.
    ///
    /// # Examples
    ///
    /// ```
    /// let (curve, note) = tyndall_scene::PhaseCurve::read("hg:0.85", None)?;
    /// assert_eq!((curve.mean_cosine(), note), (0.85, None));
    /// # Ok::<(), tyndall_scene::SceneError>(())
    /// ```
    pub fn read(spec: &str, incidence: Option<DVec3>) -> Result<(Self, Option<String>), SceneError> {
        let mut description = phase_spec::parse(spec)?;
        let name = spec.trim().to_owned();
        let mut note = None;
        if let PhaseDescription::Mie { wavelength_nm, m, x, .. } = &mut description {
            if wavelength_nm.is_none() && (m.is_none() || x.is_none()) {
                note = Some(format!(
                    "{spec}: the wavelength is {GREY_WAVELENGTH_NM} nm; `wavelength=…nm` names another"
                ));
            }
            let wavelength_nm = *wavelength_nm.get_or_insert(GREY_WAVELENGTH_NM);
            let cache = MieCache::from_environment();
            let spheres = mie_spheres(&description, wavelength_nm, Path::new(""), &cache)?;
            if let Some(spheres) = spheres {
                let phase = spheres.average.phase_function().map_err(mie_error)?;
                return Ok((Self { name, phase, incidence: None, spheres: Some(spheres) }, note));
            }
        }
        let (phase, choice) = grey_phase(&build_phase(&description, Path::new(""))?);
        let note = note.or(choice.map(|choice| format!("{spec}: {choice}")));
        let incidence = incidence.filter(|_| matches!(phase, PhaseFunction::Sggx(_)));
        Ok((Self { name, phase, incidence, spheres: None }, note))
    }

    /// The spheres, if it comes from Lorenz-Mie theory.
    pub fn spheres(&self) -> Option<&MieSpheres> {
        self.spheres.as_ref()
    }

    /// What the user called it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The phase function for all directions, as scenes have it: of spheres, their table.
    pub fn phase_function(&self) -> &PhaseFunction {
        &self.phase
    }

    /// Value at a scattering angle in degrees, 1/sr; the mean over the azimuth, by the midpoint rule, where it depends on
    /// it.
    pub fn value(&self, degrees: f64) -> f64 {
        match self.incidence {
            // Exactly forward the value depends on the azimuth from which that is approached.
            Some(before) => self.azimuthal_mean(before, libm::sincos(degrees.max(1e-5).to_radians())),
            None => self.value_at_cosine(libm::cos(degrees.to_radians())),
        }
    }

    /// The same at the cosine of the angle.
    pub fn value_at_cosine(&self, cos_theta: f64) -> f64 {
        if let Some(sphere) = self.spheres.as_ref().and_then(|spheres| spheres.single.as_ref()) {
            return sphere.phase_function(cos_theta);
        }
        match self.incidence {
            Some(before) => {
                let sin = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
                self.azimuthal_mean(before, (sin.max(1e-7), cos_theta))
            }
            None => self.phase.value_at_cosine(cos_theta),
        }
    }

    fn azimuthal_mean(&self, before: DVec3, (sin, cos): (f64, f64)) -> f64 {
        let (tangent, bitangent) = before.any_orthonormal_pair();
        let values = (0..AZIMUTHS).map(|i| {
            let (sin_phi, cos_phi) = libm::sincos(TAU * (f64::from(i) + 0.5) / f64::from(AZIMUTHS));
            let after = before * cos + tangent * (sin * cos_phi) + bitangent * (sin * sin_phi);
            self.phase.value(before, after.normalize())
        });
        values.sum::<f64>() / f64::from(AZIMUTHS)
    }

    /// The cosine of the scattering angle that two numbers, uniform in [0, 1), draw with the density of these values.
    pub fn sample_cosine(&self, u: [f64; 2]) -> f64 {
        match self.incidence {
            Some(before) => self.phase.sample(before, u).dot(before),
            None => self.phase.sample_cosine(u[0]),
        }
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
