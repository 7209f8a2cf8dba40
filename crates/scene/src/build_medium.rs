//! From the description of a medium to one that is ready to trace: spectra, and their red, green and blue.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use tyndall_optics::{PhaseFunction, Spectrum};

use crate::description::{KeyProblem, MediumDescription, SpectrumDescription, unit_in_metres};
use crate::mie::MieTables;
use crate::phase::{GREY_WAVELENGTH_NM, build_phase_with};
use crate::{ChromaticMedium, Medium, MediumPhase, MediumSpectra, SceneError};

/// Relative difference between channels that still counts as grey: decimals that were rounded.
const GREY_TOLERANCE: f64 = 1e-6;

/// The medium, of which messages say `name`; `unit` is the scene's, file names are relative to `folder`, and
/// `emission_scale` multiplies what it emits. Lorenz-Mie theory is asked for where `tables` says.
pub(crate) fn build_medium(
    description: &MediumDescription,
    unit: &str,
    folder: &Path,
    emission_scale: f64,
    tables: &MieTables,
    name: &str,
) -> Result<Medium, SceneError> {
    let refuse = |message: String| SceneError::file(Path::new(name), message);
    let given =
        || description.phase.as_ref().map(|phase| build_phase_with(phase, folder, tables)).transpose();
    let (coefficients, phase) = match &description.particles {
        Some(particles) => {
            let metres = unit_in_metres(unit).map_err(refuse)?;
            let (coefficients, phase) = tables.particles(particles, metres, folder)?;
            let phase = MediumPhase::ByWavelength(given()?.unwrap_or(phase));
            (coefficients.scaled(description.scale.unwrap_or(1.0)), phase)
        }
        None => {
            let phase = match description.preset_g() {
                Some(g) => MediumPhase::HenyeyGreenstein(g),
                None => MediumPhase::ByWavelength(given()?.unwrap_or(PhaseFunction::Isotropic.into())),
            };
            let g = phase.at(GREY_WAVELENGTH_NM).mean_cosine();
            let coefficients = description.coefficients(unit, g).map_err(|(_, message)| refuse(message))?;
            (coefficients, phase)
        }
    };
    let light = |emission: &Option<SpectrumDescription>| -> Result<Spectrum, SceneError> {
        let spectrum = emission.as_ref().map(SpectrumDescription::light).transpose();
        let spectrum = spectrum.map_err(|(_, message): KeyProblem| refuse(message))?;
        Ok(spectrum.map_or(Spectrum::Constant(0.0), |spectrum| spectrum.scaled(emission_scale)))
    };
    let spectra = MediumSpectra {
        emission: light(&description.emission)?,
        emission_per_length: light(&description.emission_per_length)?,
        phase,
        coefficients,
    };
    Ok(of_spectra(spectra))
}

/// The red, green and blue of a medium, and whether they differ in more than albedo and emission.
fn of_spectra(spectra: MediumSpectra) -> Medium {
    let channels = spectra.coefficients.mu_t_rgb();
    let mu_t = if channels.x == channels.y && channels.y == channels.z {
        channels.x
    } else {
        channels.element_sum() / 3.0
    };
    let is_coloured =
        channels.max_element() - channels.min_element() > GREY_TOLERANCE * channels.max_element();
    let phase_functions = spectra.phase.rgb();
    let phase_function = spectra.phase.at(GREY_WAVELENGTH_NM);
    let chromatic = (is_coloured || phase_functions.is_some())
        .then(|| Arc::new(ChromaticMedium { mu_t: channels, phase_functions }));
    let light = |spectrum: &Spectrum| if spectrum.is_zero() { DVec3::ZERO } else { spectrum.light_rgb() };
    Medium {
        mu_t,
        albedo: spectra.coefficients.albedo_rgb(),
        phase_function,
        emission: light(&spectra.emission),
        emission_per_length: light(&spectra.emission_per_length),
        chromatic,
        spectra: Some(Arc::new(spectra)),
    }
}
