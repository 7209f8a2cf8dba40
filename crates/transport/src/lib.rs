//! How light moves: the reference path tracer of the volume rendering equation and the fast engine.
//!
//! `distance` and `transmittance` hold one estimator a file; `reference` puts them together as the equation reads;
//! `emission` gathers what media send out; `fast` does the same with many paths at once. [`render_pass`] fills a film with either.

mod distance;
mod emission;
mod fast;
mod reference;
mod render;
mod transmittance;

pub use distance::sample_distance;
pub use emission::{emission_along, emitting_length};
pub use reference::trace;
pub use render::{Control, Outcome, RenderOptions, render_pass};
pub use transmittance::estimate_transmittance;
