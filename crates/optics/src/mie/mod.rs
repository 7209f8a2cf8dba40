//! Lorenz-Mie theory: what spheres of a known material and size do to light.
//!
//! `sphere` solves one sphere, `size_distribution` says how many there are of each size, and `average` joins the two into
//! properties of the mean particle, which `cache` keeps on disk, and of which `particles` makes coefficients.

mod angle_grid;
mod average;
mod cache;
mod error;
mod particles;
mod radius_grid;
mod riccati_bessel;
mod size_distribution;
mod sphere;
mod sums;

pub use average::MieAverage;
pub use cache::MieCache;
pub use error::MieError;
pub use particles::{Amount, ParticleOptics, Particles};
pub use size_distribution::{SizeDistribution, SizeLaw};
pub use sphere::Sphere;
