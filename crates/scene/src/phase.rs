//! From the description of a phase function to the phase function, for all wavelengths.

use glam::DVec3;
use std::path::Path;
use tyndall_optics::phase_function::{Sggx, SggxKind, read_phase_table};
use tyndall_optics::{PhaseFunction, SpectralPhase};

use crate::SceneError;
use crate::description::{PhaseDescription, SggxShape};

/// The phase function over wavelength; a table's file name is relative to `folder`.
pub fn build_phase(description: &PhaseDescription, folder: &Path) -> Result<SpectralPhase, SceneError> {
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
    };
    Ok(phase.into())
}
