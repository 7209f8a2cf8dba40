//! From the description of a phase function to the phase function, for all wavelengths.

use glam::DVec3;
use std::path::Path;
use tyndall_optics::mie::MieCache;
use tyndall_optics::phase_function::{Sggx, SggxKind, read_phase_table};
use tyndall_optics::{PhaseFunction, SpectralPhase};

use crate::SceneError;
use crate::description::{PhaseDescription, SggxShape};
use crate::mie::{BLUE_GREEN_RED_NM, mie_spheres, phase_of_each};

/// Wavelength, in nm, that stands for all where a picture has no wavelengths.
pub const GREY_WAVELENGTH_NM: f64 = 550.0;

/// The phase function over wavelength; a table's file name is relative to `folder`, and Lorenz-Mie theory is kept in the
/// cache that the environment names.
pub fn build_phase(description: &PhaseDescription, folder: &Path) -> Result<SpectralPhase, SceneError> {
    build_phase_with(description, folder, &MieCache::from_environment())
}

/// The same, with a cache for Lorenz-Mie theory.
pub fn build_phase_with(
    description: &PhaseDescription,
    folder: &Path,
    cache: &MieCache,
) -> Result<SpectralPhase, SceneError> {
    let phase = match *description {
        PhaseDescription::Isotropic => PhaseFunction::Isotropic,
        PhaseDescription::Hg { g } => PhaseFunction::HenyeyGreenstein { g },
        PhaseDescription::DoubleHg { g1, g2, weight } => {
            PhaseFunction::double_henyey_greenstein(g1, g2, weight)
        }
        PhaseDescription::Schlick { k } => PhaseFunction::Schlick { k },
        PhaseDescription::Rayleigh => PhaseFunction::Rayleigh,
        PhaseDescription::CornetteShanks { g } => PhaseFunction::cornette_shanks(g),
        PhaseDescription::Draine { g, alpha } => PhaseFunction::Draine { g, alpha },
        PhaseDescription::Fog { droplet_diameter_um } => PhaseFunction::fog(droplet_diameter_um),
        PhaseDescription::Sggx { kind, axis, roughness } => {
            let kind = match kind {
                SggxShape::Surface => SggxKind::Surface,
                SggxShape::Fibre => SggxKind::Fibre,
            };
            PhaseFunction::Sggx(Sggx::new(kind, DVec3::from_array(axis), roughness))
        }
        PhaseDescription::Tabulated { ref file, wavelength_nm } => {
            let path = folder.join(file);
            let table =
                read_phase_table(&path).map_err(|error| SceneError::file(&path, error.to_string()))?;
            match wavelength_nm {
                Some(wavelength) => table.at(wavelength),
                None => return Ok(table),
            }
        }
        PhaseDescription::Mie { wavelength_nm, ref m, x, .. } => {
            // A size parameter and a constant index: the wavelength does not matter.
            let is_grey = x.is_some() && m.is_some();
            let one = wavelength_nm.or(is_grey.then_some(GREY_WAVELENGTH_NM));
            let wavelengths_nm = one.map_or(BLUE_GREEN_RED_NM.to_vec(), |nm| vec![nm]);
            return phase_of_each(&wavelengths_nm, |nm| {
                let spheres = mie_spheres(description, nm, folder, cache)?;
                spheres
                    .map(|spheres| spheres.average)
                    .ok_or_else(|| SceneError::file(Path::new("mie"), "is no phase function of spheres"))
            });
        }
    };
    Ok(phase.into())
}

/// The phase function that stands for all wavelengths, and a note on which it is if the choice was not the user's.
pub fn grey_phase(spectral: &SpectralPhase) -> (PhaseFunction, Option<String>) {
    let note = (!spectral.is_grey()).then(|| {
        format!(
            "the phase function is that at {GREY_WAVELENGTH_NM} nm; the key `wavelength_nm` names another"
        )
    });
    (spectral.at(GREY_WAVELENGTH_NM), note)
}
