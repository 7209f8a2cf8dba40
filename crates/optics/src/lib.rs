//! What media and surfaces do to light at a point: phase functions, BSDFs, coefficients, spectra and colour. Knows no
//! geometry.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

pub mod albedo_inversion;
pub mod bsdf;
pub mod cie;
mod dielectrics;
mod metals;
pub mod mie;
pub mod phase_function;
pub mod planck;
pub mod presets;
pub mod refractive_index;
mod spectrum;
pub mod uplift;

pub use dielectrics::{dielectric_index, dielectric_names};
pub use metals::{Metal, metal};
pub use phase_function::{PhaseFunction, SpectralPhase};
pub use refractive_index::{Material, RefractiveIndex, RefractiveIndexTable, Substance};
pub use spectrum::{Spectrum, SpectrumError};
