//! Phase functions and coefficients of participating media. Knows no geometry.

#![forbid(unsafe_code)]

pub mod mie;
pub mod phase_function;
pub mod refractive_index;

pub use phase_function::PhaseFunction;
pub use refractive_index::{Material, RefractiveIndex, RefractiveIndexTable};
