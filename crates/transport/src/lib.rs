//! How light moves: the reference path tracer of the volume rendering equation and the fast engine.
//!
//! `distance` and `transmittance` hold one estimator a file; `reference` puts them together as the equation reads;
//! `fast` does the same with many paths at once. [`render_pass`] fills a film with either. [`walk`] follows light the other
//! way, from where it enters, for fluxes.

mod distance;
mod fast;
mod reference;
mod render;
mod transmittance;
pub mod walk;

pub use distance::sample_distance;
pub use reference::trace;
pub use render::{Control, Outcome, RenderOptions, render_pass};
pub use transmittance::estimate_transmittance;
