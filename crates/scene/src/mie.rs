//! From descriptions of particles to what Lorenz-Mie theory makes of them.

use std::f64::consts::TAU;
use std::io::Read;
use std::path::Path;
use tyndall_machine::files;
use tyndall_optics::mie::{MieAverage, MieCache, MieError, Particles, SizeLaw, Sphere};
use tyndall_optics::{PhaseFunction, RefractiveIndexTable, SpectralPhase, Spectrum, Substance};

use crate::description::{ColourMode, ParticlesDescription, PhaseDescription, SubstanceChoice, substance};
use crate::phase::GREY_WAVELENGTH_NM;
use crate::spectra::PRIMARIES_NM;
use crate::{SceneError, SpectralCoefficients};

/// Where Lorenz-Mie theory is asked for, and where its results are kept.
#[derive(Debug, Clone)]
pub(crate) struct MieTables<'a> {
    /// Wavelengths in nm, increasing; between them coefficients and phase functions are interpolated.
    wavelengths_nm: Vec<f64>,
    cache: &'a MieCache,
}

impl<'a> MieTables<'a> {
    /// At the hues of red, green and blue; or every 20 nm of what the standard observer sees, over which rainbows and
    /// coronas move by less than droplets of different sizes blur them.
    pub(crate) fn new(mode: ColourMode, cache: &'a MieCache) -> Self {
        let wavelengths_nm = match mode {
            ColourMode::Rgb => PRIMARIES_NM.into_iter().rev().collect(),
            ColourMode::Spectral => (0..18).map(|i| 380.0 + 20.0 * f64::from(i)).collect(),
        };
        Self { wavelengths_nm, cache }
    }

    /// The phase function of a description of type `mie`.
    pub(crate) fn phase(
        &self,
        description: &PhaseDescription,
        folder: &Path,
    ) -> Result<SpectralPhase, SceneError> {
        let wavelengths_nm = match description {
            PhaseDescription::Mie { wavelength_nm: Some(nm), .. } => vec![*nm],
            // A size parameter and a constant index: the wavelength does not matter.
            PhaseDescription::Mie { x: Some(_), m: Some(_), .. } => vec![GREY_WAVELENGTH_NM],
            _ => self.wavelengths_nm.clone(),
        };
        let phases = wavelengths_nm.into_iter().map(|nm| {
            let spheres = mie_spheres(description, nm, folder, self.cache)?;
            let none = || refusal("is no phase function of spheres");
            Ok((nm, spheres.ok_or_else(none)?.average.phase_function().map_err(mie_error)?))
        });
        spectral_phase(phases.collect::<Result<_, SceneError>>()?)
    }

    /// Coefficients, per `metres` m, and phase function of particles.
    pub(crate) fn particles(
        &self,
        description: &ParticlesDescription,
        metres: f64,
        folder: &Path,
    ) -> Result<(SpectralCoefficients, SpectralPhase), SceneError> {
        let in_words = |(_, message): (&'static str, String)| refusal(message);
        let particles = Particles {
            substance: build_substance(&description.substance().map_err(in_words)?, folder)?,
            distribution: description.distribution.value().map_err(in_words)?,
            amount: description.amount().map_err(in_words)?,
        };
        let (mut mu_a, mut mu_s, mut phases) = (Vec::new(), Vec::new(), Vec::new());
        for &nm in &self.wavelengths_nm {
            let optics = particles.at(nm, self.cache).map_err(mie_error)?;
            mu_a.push(optics.mu_a * metres);
            mu_s.push(optics.mu_s * metres);
            phases.push((nm, optics.average.phase_function().map_err(mie_error)?));
        }
        let spectrum = |values| {
            Spectrum::sampled(self.wavelengths_nm.clone(), values)
                .map_err(|error| refusal(format!("the coefficient {error}")))
        };
        let coefficients =
            SpectralCoefficients::AbsorptionAndScattering { mu_a: spectrum(mu_a)?, mu_s: spectrum(mu_s)? };
        Ok((coefficients, spectral_phase(phases)?))
    }
}

fn spectral_phase(phases: Vec<(f64, PhaseFunction)>) -> Result<SpectralPhase, SceneError> {
    SpectralPhase::new(phases).ok_or_else(|| refusal("the wavelength must be above 0"))
}

/// A longer file is no table of a refractive index.
const GREATEST_TABLE: u64 = 4 << 20;

/// What the spheres of a `mie` phase function do to light of one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct MieSpheres {
    /// The mean sphere.
    pub average: MieAverage,
    /// The sphere, if all are alike: its phase function is exact, not a table.
    pub single: Option<Sphere>,
}

/// The spheres of a `mie` phase function at a wavelength in nm; none of other phase functions. A table's file name is
/// relative to `folder`.
pub fn mie_spheres(
    phase: &PhaseDescription,
    wavelength_nm: f64,
    folder: &Path,
    cache: &MieCache,
) -> Result<Option<MieSpheres>, SceneError> {
    let PhaseDescription::Mie { material, m, material_file, distribution, x, .. } = phase else {
        return Ok(None);
    };
    let choice = substance(*material, m.as_ref(), material_file.as_deref())
        .map_err(|(_, message)| refusal(message))?;
    let index = build_substance(&choice, folder)?.refractive_index(wavelength_nm).map_err(mie_error)?;
    // At a wavelength of 2π µm the radius in µm is the size parameter.
    let (distribution, wavelength) = match (distribution, x) {
        (Some(distribution), _) => {
            (distribution.value().map_err(|(_, message)| refusal(message))?, wavelength_nm)
        }
        (None, Some(x)) => (SizeLaw::Single { r: *x }.into(), TAU * 1e3),
        (None, None) => return Err(refusal("the spheres have no size: give `distribution` or `x`")),
    };
    let single = match distribution.law {
        SizeLaw::Single { r } => Some(Sphere::new(index, TAU * r / (wavelength * 1e-3)).map_err(mie_error)?),
        _ => None,
    };
    let average = cache.average(index, wavelength, &distribution).map_err(mie_error)?;
    Ok(Some(MieSpheres { average, single }))
}

/// The substance that is chosen; a file's name is relative to `folder`.
fn build_substance(choice: &SubstanceChoice, folder: &Path) -> Result<Substance, SceneError> {
    let file = match choice {
        SubstanceChoice::Material(material) => return Ok(Substance::Material(*material)),
        SubstanceChoice::Constant(m) => return Ok(Substance::Constant(*m)),
        SubstanceChoice::File(file) => file,
    };
    let path = folder.join(file);
    let refuse = |message: String| SceneError::file(&path, message);
    let file = files::open(&path).map_err(|error| refuse(error.to_string()))?;
    let length = file.metadata().map_err(|error| refuse(error.to_string()))?.len();
    if length > GREATEST_TABLE {
        return Err(refuse("is more than 4 MiB: that is no table of a refractive index".into()));
    }
    let text = std::io::read_to_string(file.take(length)).map_err(|error| refuse(error.to_string()))?;
    let table = RefractiveIndexTable::parse(&text).map_err(|error| refuse(error.to_string()))?;
    Ok(Substance::Table(path.display().to_string(), table))
}

pub(crate) fn mie_error(error: MieError) -> SceneError {
    refusal(error.to_string())
}

fn refusal(message: impl Into<String>) -> SceneError {
    SceneError::file(Path::new("mie"), message)
}
