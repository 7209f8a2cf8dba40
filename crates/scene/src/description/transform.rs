//! `transform`: how a volume is placed in the world.

use glam::{DAffine3, DMat3, DVec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use crate::rotation;

/// A linear map of the volume's own world space (for a file: after the file's transform) into the scene.
///
/// A point is scaled, then rotated about x, then y, then z, then translated; or `matrix` says it all.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TransformDescription {
    /// Scale factor, or one for each axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Scale>,
    /// Rotations about the x, y and z axes, degrees, right-handed, done in this order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotate: Option<[f64; 3]>,
    /// Translation, done last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translate: Option<[f64; 3]>,
    /// Instead of all these: 16 numbers row by row, applied to column vectors; the last row is 0, 0, 0, 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrix: Option<[f64; 16]>,
}

impl TransformDescription {
    /// The map itself: volume space to scene space.
    pub fn to_affine(&self) -> DAffine3 {
        if let Some(m) = self.matrix {
            return DAffine3 {
                matrix3: DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]),
                translation: DVec3::new(m[3], m[7], m[11]),
            };
        }
        let [x, y, z] = self.rotate.unwrap_or_default().map(f64::to_radians);
        let rotation = rotation(DVec3::Z, z) * rotation(DVec3::Y, y) * rotation(DVec3::X, x);
        let scale = match self.scale {
            None => DVec3::ONE,
            Some(Scale::Uniform(factor)) => DVec3::splat(factor),
            Some(Scale::PerAxis(factors)) => DVec3::from_array(factors),
        };
        DAffine3 {
            matrix3: rotation * DMat3::from_diagonal(scale),
            translation: DVec3::from_array(self.translate.unwrap_or_default()),
        }
    }
}

/// Scale factors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Scale {
    /// The same along all axes.
    Uniform(f64),
    /// Along x, y and z.
    PerAxis([f64; 3]),
}

impl JsonSchema for Scale {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Scale".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "number" },
            { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 }
        ]})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_scaled_then_rotated_about_x_then_y_then_z_then_translated() {
        let transform = TransformDescription {
            scale: Some(Scale::PerAxis([2.0, 1.0, 1.0])),
            rotate: Some([0.0, 0.0, 90.0]),
            translate: Some([0.0, 0.0, 5.0]),
            matrix: None,
        };
        let moved = transform.to_affine().transform_point3(DVec3::X);
        assert!((moved - DVec3::new(0.0, 2.0, 5.0)).length() < 1e-12, "{moved}");

        let turned = TransformDescription { rotate: Some([90.0, 90.0, 0.0]), ..Default::default() };
        // About x first: +y goes to +z; then about y: +z goes to +x.
        let moved = turned.to_affine().transform_point3(DVec3::Y);
        assert!((moved - DVec3::X).length() < 1e-12, "{moved}");
    }

    #[test]
    fn a_matrix_is_row_major_and_acts_on_columns() {
        #[rustfmt::skip]
        let matrix = [1.0, 2.0, 3.0, 10.0,
                      4.0, 5.0, 6.0, 20.0,
                      7.0, 8.0, 10.0, 30.0,
                      0.0, 0.0, 0.0, 1.0];
        let transform = TransformDescription { matrix: Some(matrix), ..Default::default() };
        let moved = transform.to_affine().transform_point3(DVec3::new(1.0, 0.0, 2.0));
        assert_eq!(moved, DVec3::new(17.0, 36.0, 57.0));
    }
}
