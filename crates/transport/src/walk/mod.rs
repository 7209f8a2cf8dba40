//! Forward walks: photon packets from the light through the media, and what becomes of them.
//!
//! Where the path tracers answer how bright a scene looks, walks answer where the light goes: which fraction a layer
//! reflects, transmits and absorbs, in all, by column, and into given directions. [`Slab`] is the homogeneous
//! plane-parallel layer, [`Layer`] one of a scene's media, [`Body`] a thing of finite size in a beam; [`LightMeter`] goes
//! the other way after all, for light meters in a scene. [`run`](run()) sends the photons.

mod backward;
mod body;
mod channel;
mod doubts;
mod flight;
mod fresnel;
mod half_space;
mod layer;
mod photon;
mod run;
mod slab;
pub mod slab_input;
mod tally;

pub use backward::{LightMeter, LightMeterKind};
pub use body::{Body, BodyPowers};
pub use channel::in_one_channel;
pub use doubts::doubts;
pub use flight::Tile;
pub use half_space::DepthLimit;
pub use layer::{ColumnFluxes, Incidence, Layer, LayerFluxes};
pub use run::{Goal, Walk, WalkOptions, run};
pub use slab::Slab;
pub use tally::{Estimate, MAX_PHOTONS, Scores, Tallies};
