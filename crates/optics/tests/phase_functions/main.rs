//! Phase functions held against published formulas' values, quadrature, and chi-squared tests of their samplers.

mod agreement;
mod quadrature;
mod sampling;
mod tables;
mod truth;
