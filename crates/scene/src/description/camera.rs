//! `[camera]`: where the viewer stands and looks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A perspective camera: pinhole, or thin lens if it has an aperture.
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

fn default_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn default_vertical_fov() -> f64 {
    40.0
}
