//! Forward walks: photon packets from the light through the media, and what becomes of them.
//!
//! Where the path tracers answer how bright a scene looks, walks answer where the light goes: which fraction a layer
//! reflects, transmits and absorbs, in all, by column, and into given directions. [`Slab`] is the homogeneous
//! plane-parallel layer, [`Layer`] one of a scene's media; [`run`](run()) sends the photons.

mod flight;
mod fresnel;
mod half_space;
mod layer;
mod photon;
mod run;
mod slab;
mod tally;

pub use flight::Tile;
pub use half_space::DepthLimit;
pub use layer::{ColumnFluxes, Incidence, Layer, LayerFluxes};
pub use run::{Goal, Walk, WalkOptions, run};
pub use slab::Slab;
pub use tally::{Estimate, MAX_PHOTONS, Scores, Tallies};
