//! Numbers for light transport: counter-based random numbers, scrambled Sobol points and elementary functions that give
//! the same bits on every machine. Knows no rendering.

#![forbid(unsafe_code)]

mod elementary;
mod random;
mod sobol;

pub use elementary::{exp, ln, sin_cos_turns};
pub use random::Random;
pub use sobol::Stratified;
