//! What is rendered: camera, film, media, lights; the native TOML scene file.
//!
//! Two halves. The *description* is what a person wrote: plain data that is read from and printed as TOML
//! ([`SceneDocument`], [`SceneDescription`]). A [`Scene`], built from it, is ready to trace.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod build;
mod build_fields;
mod build_medium;
mod camera;
mod canonical_names;
mod channels;
pub mod description;
mod error;
mod exponential;
mod fields;
mod hash;
pub mod light;
mod medium;
mod mie;
mod phase;
mod phase_curve;
pub mod procedural;
mod ready;
mod rotation;
mod scene_files;
pub mod sky;
mod spectra;
mod suggestion;
pub mod surface;
mod toml;

pub use self::build::{BuiltScene, build, build_with, choose_density};
pub use self::camera::{Camera, Ray};
pub use self::channels::{ChannelMedium, ChannelPhases, Channels, Observer, observers};
pub use self::description::SceneDescription;
pub use self::error::{Problem, SceneError};
pub use self::exponential::Exponential;
pub use self::fields::{Field, Fields, TemperatureField};
pub use self::hash::{SceneHash, content_hash, scene_hash, scene_hash_with};
pub use self::light::{Light, LightSample};
pub use self::medium::{ChromaticMedium, Density, Medium, Volume};
pub use self::mie::{MieSpheres, mie_spheres};
pub use self::phase::{GREY_WAVELENGTH_NM, build_phase, grey_phase};
pub use self::phase_curve::PhaseCurve;
pub use self::ready::Scene;
pub use self::rotation::{angle_between, rotation};
pub use self::scene_files::{MemoryGrid, SceneFiles};
pub use self::spectra::{MediumPhase, MediumSpectra, SpectralCoefficients};
pub use self::surface::{Hit, Surfaces};
pub use self::toml::{SceneDocument, json_schema};
