//! Surfaces held against their equations: samplers against densities by chi-squared tests, energy, reciprocity, and
//! figures of another renderer.

#[path = "../statistics/chi_squared.rs"]
mod chi_squared;
mod energy;
mod figures;
mod kinds;
mod laws;
mod sampling;
