//! Phase functions held against published formulas' values, quadrature, and chi-squared tests of their samplers.

mod agreement;
#[path = "../statistics/chi_squared.rs"]
mod chi_squared;
mod quadrature;
mod sampling;
mod tables;
mod truth;
