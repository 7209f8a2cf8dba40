//! What particles are made of: a material that is built in, a constant, or a user's table.

use super::{Material, RefractiveIndex, RefractiveIndexTable};
use crate::mie::MieError;

/// What particles are made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Substance {
    /// A material that is built in.
    Material(Material),
    /// The same refractive index at all wavelengths.
    Constant(RefractiveIndex),
    /// A user's table, with the name that messages call it by.
    Table(String, RefractiveIndexTable),
}

impl Substance {
    /// The refractive index at a wavelength in nm.
    pub fn refractive_index(&self, wavelength: f64) -> Result<RefractiveIndex, MieError> {
        let (name, table) = match self {
            Self::Constant(m) => return m.check().map(|()| *m),
            Self::Material(material) => (material.name(), material.table()),
            Self::Table(name, table) => (name.as_str(), table),
        };
        let [first, last] = table.range();
        let unknown = || MieError::Wavelength { material: name.to_owned(), first, last, wavelength };
        table.at(wavelength).ok_or_else(unknown)
    }

    /// Mass of a volume in g/cm³, if it is known.
    pub fn density(&self) -> Option<f64> {
        match self {
            Self::Material(material) => Some(material.density()),
            Self::Constant(_) | Self::Table(..) => None,
        }
    }
}
