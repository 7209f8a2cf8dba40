//! The native scene file: TOML text to a checked [`SceneDescription`](crate::SceneDescription) and back.
//!
//! The way of the data: text → tree of values that know where they stand ([`tree`]) → `--set` options change
//! it ([`document`]) → it is held against the JSON schema ([`conformance`]), all problems at once → serde
//! makes the description → its rules are checked. [`print`] is the way back.

pub(crate) mod conformance;
mod counted;
mod document;
mod print;
pub(crate) mod schema;
pub(crate) mod tree;

pub use document::SceneDocument;
pub use schema::json_schema;
