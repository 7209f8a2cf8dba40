//! Lorenz-Mie theory: what spheres of a known material and size do to light.
//!
//! `sphere` solves one sphere, `size_distribution` says how many there are of each size, and `average` joins the two into
//! coefficients and a phase function, which `cache` keeps on disk.

mod angle_grid;
mod average;
mod error;
mod radius_grid;
mod riccati_bessel;
mod size_distribution;
mod sphere;
mod sums;

pub use average::MieAverage;
pub use error::MieError;
pub use size_distribution::{SizeDistribution, SizeLaw};
pub use sphere::Sphere;
