//! Lorenz-Mie theory: what spheres of a known material and size do to light.
//!
//! `sphere` solves one sphere, `size_distribution` says how many there are of each size, and `average` joins the two into
//! coefficients and a phase function, which `cache` keeps on disk.

mod error;
mod riccati_bessel;
mod sphere;

pub use error::MieError;
pub use sphere::Sphere;
