//! Lorenz-Mie theory against tables of independent codes, published values and limits.

mod distributions;
mod sphere;
