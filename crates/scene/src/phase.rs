//! From the description of a phase function to the phase function, for all wavelengths.

use glam::DVec3;
use std::path::Path;
use tyndall_optics::mie::MieCache;
use tyndall_optics::phase_function::{Sggx, SggxKind, read_phase_table};
use tyndall_optics::{PhaseFunction, SpectralPhase};

use crate::SceneError;
use crate::description::{ColourMode, PhaseDescription, SggxShape};
use crate::mie::MieTables;

/// Wavelength, in nm, that stands for all where a picture has no wavelengths.
pub const GREY_WAVELENGTH_NM: f64 = 550.0;

/// The phase function over wavelength; a table's file name is relative to `folder`. Lorenz-Mie theory is asked for at the
/// hues of red, green and blue, and kept in the cache that the environment names.
pub fn build_phase(description: &PhaseDescription, folder: &Path) -> Result<SpectralPhase, SceneError> {
    let cache = MieCache::from_environment();
    build_phase_with(description, folder, &MieTables::new(ColourMode::Rgb, &cache))
}

/// The same, with Lorenz-Mie theory where `tables` asks for it.
pub(crate) fn build_phase_with(
    description: &PhaseDescription,
    folder: &Path,
    tables: &MieTables,
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
        PhaseDescription::Mie { .. } => return tables.phase(description, folder),
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
