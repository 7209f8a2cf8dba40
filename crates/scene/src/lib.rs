//! What is rendered: camera, film, media, lights; the native TOML scene file.
//!
//! Two halves. The *description* is what a person wrote: plain data that is read from and printed as TOML
//! ([`SceneDocument`], [`SceneDescription`]). What is *ready to trace* is built from it.

#![forbid(unsafe_code)]

mod camera;
pub mod description;
mod error;
mod hash;
pub mod light;
pub mod sky;
mod toml;

pub use self::camera::{Camera, Ray};
pub use self::description::SceneDescription;
pub use self::error::{Problem, SceneError};
pub use self::hash::{SceneHash, scene_hash};
pub use self::light::{Light, LightSample};
pub use self::toml::{SceneDocument, json_schema};
