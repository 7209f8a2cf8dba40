//! `[camera]`: where the viewer stands and looks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::shape::Names;

/// A camera: perspective (pinhole, or thin lens if it has an aperture) or orthographic.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CameraDescription {
    /// Where the camera is.
    pub position: [f64; 3],
    /// The point it looks at; give this or `direction`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<[f64; 3]>,
    /// The direction it looks in; give this or `target`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// The direction that is up in the picture.
    #[serde(default = "default_up")]
    pub up: [f64; 3],
    /// How the world comes onto the film.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub projection: Projection,
    /// Height of what an orthographic camera sees, scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub height: Option<f64>,
    /// What the film shows: left, right, bottom and top edge as the camera sees them, at distance 1 in the perspective of
    /// a pinhole, in scene units in an orthographic one. Takes the place of `vertical_fov` and `height`; with left above
    /// right the picture is mirrored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window: Option<[f64; 4]>,
    /// Names of the volumes bounded by shapes in which the camera is, if it is not to be found out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inside: Option<Names>,
    /// Angle between the top and the bottom edge of the picture, degrees.
    #[serde(default = "default_vertical_fov")]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub vertical_fov: f64,
    /// Radius of the lens; 0 is a pinhole.
    #[serde(default, skip_serializing_if = "super::is_default")]
    #[schemars(range(min = 0))]
    pub aperture_radius: f64,
    /// Distance from the camera to the plane in focus, along the view; by default that of the `target`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub focus_distance: Option<f64>,
}

/// How the world comes onto the film.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Projection {
    /// Through one point.
    #[default]
    Perspective,
    /// Along parallel rays.
    Orthographic,
}

fn default_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn default_vertical_fov() -> f64 {
    40.0
}
