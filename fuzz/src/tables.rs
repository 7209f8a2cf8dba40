//! Measured values in text: phase functions and refractive indices.

use tyndall_optics::RefractiveIndexTable;
use tyndall_optics::phase_function::parse_phase_table;

use crate::Outcome;

/// Phase functions by angle.
pub(crate) fn phase_table(bytes: &[u8]) -> Outcome {
    match parse_phase_table(&String::from_utf8_lossy(bytes)) {
        Ok(_) => Outcome::Read(0),
        Err(error) => Outcome::refused(&error),
    }
}

/// Refractive indices by wavelength.
pub(crate) fn index_table(bytes: &[u8]) -> Outcome {
    match RefractiveIndexTable::parse(&String::from_utf8_lossy(bytes)) {
        Ok(table) => {
            let [first, last] = table.range();
            for wavelength in [0.0, first, last, 0.5 * (first + last), f64::NAN] {
                table.at(wavelength);
            }
            Outcome::Read(0)
        }
        Err(error) => Outcome::refused(&error),
    }
}
