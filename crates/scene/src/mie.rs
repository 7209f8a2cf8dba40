//! From descriptions of particles to what Lorenz-Mie theory makes of them.

use std::f64::consts::TAU;
use std::path::Path;
use tyndall_optics::mie::{MieAverage, MieCache, MieError, SizeLaw, Sphere};
use tyndall_optics::{PhaseFunction, RefractiveIndexTable, SpectralPhase, Substance};

use crate::SceneError;
use crate::description::{PhaseDescription, SubstanceChoice, substance};

/// Wavelengths, in nm, that stand for blue, green and red where a picture has no wavelengths.
pub(crate) const BLUE_GREEN_RED_NM: [f64; 3] = [465.0, 550.0, 610.0];

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
    let refuse = |message: String| SceneError::file(Path::new("mie"), message);
    let choice =
        substance(*material, m.as_ref(), material_file.as_deref()).map_err(|(_, text)| refuse(text))?;
    let index = build_substance(&choice, folder)?.refractive_index(wavelength_nm).map_err(mie_error)?;
    // At a wavelength of 2π µm the radius in µm is the size parameter.
    let (distribution, wavelength) = match (distribution, x) {
        (Some(distribution), _) => (distribution.value().map_err(|(_, text)| refuse(text))?, wavelength_nm),
        (None, Some(x)) => (SizeLaw::Single { r: *x }.into(), TAU * 1e3),
        (None, None) => return Err(refuse("the spheres have no size: give `distribution` or `x`".into())),
    };
    let single = match distribution.law {
        SizeLaw::Single { r } => Some(Sphere::new(index, TAU * r / (wavelength * 1e-3)).map_err(mie_error)?),
        _ => None,
    };
    let average = cache.average(index, wavelength, &distribution).map_err(mie_error)?;
    Ok(Some(MieSpheres { average, single }))
}

/// The phase functions of particles that have `average` at each of some wavelengths in nm.
pub(crate) fn phase_of_each(
    wavelengths_nm: &[f64],
    mut average: impl FnMut(f64) -> Result<MieAverage, SceneError>,
) -> Result<SpectralPhase, SceneError> {
    let phases: Vec<(f64, PhaseFunction)> = wavelengths_nm
        .iter()
        .map(|nm| Ok((*nm, average(*nm)?.phase_function().map_err(mie_error)?)))
        .collect::<Result<_, SceneError>>()?;
    SpectralPhase::new(phases).ok_or_else(|| SceneError::file(Path::new("mie"), "there are no wavelengths"))
}

/// The substance that is chosen; a file's name is relative to `folder`.
pub(crate) fn build_substance(choice: &SubstanceChoice, folder: &Path) -> Result<Substance, SceneError> {
    let file = match choice {
        SubstanceChoice::Material(material) => return Ok(Substance::Material(*material)),
        SubstanceChoice::Constant(m) => return Ok(Substance::Constant(*m)),
        SubstanceChoice::File(file) => file,
    };
    let path = folder.join(file);
    let refuse = |message: String| SceneError::file(&path, message);
    let length = std::fs::metadata(&path).map_err(|error| refuse(error.to_string()))?.len();
    if length > GREATEST_TABLE {
        return Err(refuse("is more than 4 MiB: that is no table of a refractive index".into()));
    }
    let text = std::fs::read_to_string(&path).map_err(|error| refuse(error.to_string()))?;
    let table = RefractiveIndexTable::parse(&text).map_err(|error| refuse(error.to_string()))?;
    Ok(Substance::Table(path.display().to_string(), table))
}

pub(crate) fn mie_error(error: MieError) -> SceneError {
    SceneError::file(Path::new("mie"), error.to_string())
}
