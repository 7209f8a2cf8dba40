//! How light moves: the reference path tracer of the volume rendering equation and the fast engine.
//!
//! `along_ray` is the extinction along one ray, which is all that an estimator sees; `distance` and `transmittance` hold one
//! estimator a file; `emission` gathers what media send out; `reference` puts them together as the equation reads; `fast`
//! does the same with many paths at once, `spectral` in media that depend on colour. [`render_pass`] fills a film with any
//! of them. [`walk`] follows light the other way, from where it enters, for fluxes.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod along_ray;
mod beginning;
pub mod counters;
pub mod distance;
mod emission;
mod equiangular_light;
mod estimators;
mod fast;
mod fast_spectral;
mod first_draws;
mod found_light;
mod measure;
mod path_layers;
mod pilot;
mod properties;
mod reference;
mod render;
mod repeat;
mod roulette;
mod shadow_catcher;
mod slots;
mod spectral;
mod surface_vertex;
mod threads;
pub mod transmittance;
pub mod walk;
mod way;
mod wide;
mod work;

pub use along_ray::{AlongRay, Lookups};
pub use distance::{DistanceSampler, Flight, sample_distance};
pub use emission::emission_along;
pub use estimators::Estimators;
pub use measure::{Measurement, measure};
pub use properties::{MajorantUse, Need, Properties, Reason};
pub use reference::{trace, trace_with};
pub use render::{Control, Outcome, RenderOptions, Renderer, render_pass};
pub use repeat::{Repeated, repeat_distance, repeat_transmittance};
pub use spectral::{SpectralIntegrator, SpectralScene};
pub use transmittance::{TransmittanceEstimator, estimate_transmittance};
