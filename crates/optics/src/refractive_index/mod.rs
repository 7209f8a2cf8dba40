//! Refractive indices m = n + ik of materials over wavelength; k ≥ 0 absorbs.

mod material;
mod substance;
mod table;

pub use material::Material;
pub use substance::Substance;
pub use table::{RefractiveIndexTable, TableError};

use crate::mie::MieError;

/// A complex refractive index n + ik.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefractiveIndex {
    /// Real part: speed of light in vacuum over that in the material.
    pub n: f64,
    /// Imaginary part, at least 0: the absorption coefficient is 4πk/λ.
    pub k: f64,
}

impl RefractiveIndex {
    /// An error if n is not within 0.01…100 or k not within 0…100.
    pub fn check(self) -> Result<(), MieError> {
        let possible = (0.01..=100.0).contains(&self.n) && (0.0..=100.0).contains(&self.k);
        if possible { Ok(()) } else { Err(MieError::RefractiveIndex { n: self.n, k: self.k }) }
    }
}
