//! What Lorenz-Mie theory cannot be asked: one sentence each, with the mend.

use thiserror::Error;

use crate::phase_function::UnsoundTable;

/// Why optical properties cannot be computed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MieError {
    /// A size parameter out of range.
    #[error("the size parameter 2πr/λ is {x:?}; it must be from 1e-6 to 1e5")]
    Size {
        /// 2πr/λ.
        x: f64,
    },
    /// A size inside the sphere that takes too many terms.
    #[error("refractive index {m} times size parameter {x} is more than 2e6; make the sphere smaller")]
    InnerSize {
        /// |m|.
        m: f64,
        /// 2πr/λ.
        x: f64,
    },
    /// A refractive index that is not one.
    #[error("the refractive index {n} + {k}i is not possible: n must be from 0.01 to 100, k from 0 to 100")]
    RefractiveIndex {
        /// Real part.
        n: f64,
        /// Imaginary part.
        k: f64,
    },
    /// A sphere of the same material as what is around it.
    #[error("the refractive index is 1, that of the medium around: such particles do not scatter")]
    NoContrast,
    /// A parameter of a size distribution out of range.
    #[error("`{key}` of the size distribution is {value}; {mend}")]
    Distribution {
        /// The parameter.
        key: &'static str,
        /// Its value; radii in µm.
        value: f64,
        /// What it must be.
        mend: &'static str,
    },
    /// A wavelength of which the material's refractive index is not known.
    #[error("the refractive index of {material} is known from {first} to {last} nm, not at {wavelength} nm")]
    Wavelength {
        /// Name of the material.
        material: String,
        /// First wavelength of its table, nm.
        first: f64,
        /// Last wavelength of its table, nm.
        last: f64,
        /// The wavelength that was asked for, nm.
        wavelength: f64,
    },
    /// A phase function that is none.
    #[error("the phase function cannot be tabulated: {0}")]
    PhaseFunction(#[from] UnsoundTable),
}
