//! Phase functions and coefficients of participating media. Knows no geometry.

#![forbid(unsafe_code)]

pub mod phase_function;

pub use phase_function::{PhaseFunction, SpectralPhase};
