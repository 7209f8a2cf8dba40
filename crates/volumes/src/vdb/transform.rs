//! Index space to world space: a string with the kind of map, then its numbers as f64.
//!
//! | kind | numbers |
//! |---|---|
//! | `UniformScaleMap`, `ScaleMap` | scale, and four vectors that follow from it |
//! | `TranslationMap` | translation |
//! | `UniformScaleTranslateMap`, `ScaleTranslateMap` | translation, scale, and four vectors that follow |
//! | `AffineMap`, `UnitaryMap` | 4×4 matrix, row by row, for row vectors: x' = x M |
//! | `NonlinearFrustumMap` | box, taper, depth and another map; not linear, so its grids are refused |
//!
//! Source: OpenVDB, `math/Maps`.

use super::cursor::{Cursor, Problem, damaged, quotable};
use glam::{DAffine3, DMat3, DVec3, DVec4};

/// The linear map, or nothing when it is a frustum.
pub(super) fn read(cursor: &mut Cursor) -> Result<Option<DAffine3>, Problem> {
    let kind = cursor.string("the kind of the transform")?;
    let map = match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => DAffine3::from_scale(scale(cursor)?),
        "TranslationMap" => DAffine3::from_translation(vector(cursor)?),
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let translation = vector(cursor)?;
            DAffine3 { matrix3: DMat3::from_diagonal(scale(cursor)?), translation }
        }
        "AffineMap" | "UnitaryMap" => matrix(cursor)?,
        "NonlinearFrustumMap" => {
            // Box, taper and depth; then the map of its far side. Read, so that streams can be walked past it.
            cursor.take(8 * 8, "the transform")?;
            return match cursor.clone().string("the kind of the transform")?.as_str() {
                "NonlinearFrustumMap" => Err(damaged("a frustum transform holds another one")),
                _ => read(cursor).map(|_| None),
            };
        }
        _ => return Err(damaged(format!("`{}` is not a transform of OpenVDB", quotable(&kind)))),
    };
    let determinant = map.matrix3.determinant();
    if !map.is_finite() || !determinant.is_finite() || determinant == 0.0 {
        return Err(damaged("the transform cannot be inverted"));
    }
    Ok(Some(map))
}

/// Writes the plainest map that says the same.
pub(super) fn write(map: &DAffine3, out: &mut Vec<u8>) {
    let DMat3 { x_axis, y_axis, z_axis } = map.matrix3;
    let scale = DVec3::new(x_axis.x, y_axis.y, z_axis.z);
    let diagonal = map.matrix3 == DMat3::from_diagonal(scale);
    let uniform = scale.x == scale.y && scale.y == scale.z;
    let moved = map.translation != DVec3::ZERO;
    // OpenVDB's scaling maps are for lengths; mirrored grids go as matrices.
    if !diagonal || scale.min_element() <= 0.0 {
        super::write::string(out, "AffineMap");
        for (row, last) in [x_axis, y_axis, z_axis, map.translation].into_iter().zip([0.0, 0.0, 0.0, 1.0]) {
            put(out, &[row.x, row.y, row.z, last]);
        }
        return;
    }
    super::write::string(
        out,
        match (uniform, moved) {
            (true, false) => "UniformScaleMap",
            (true, true) => "UniformScaleTranslateMap",
            (false, false) => "ScaleMap",
            (false, true) => "ScaleTranslateMap",
        },
    );
    if moved {
        put(out, &map.translation.to_array());
    }
    let inverse = scale.recip();
    for follows in [scale, scale.abs(), inverse, inverse * inverse, inverse / 2.0] {
        put(out, &follows.to_array());
    }
}

fn put(out: &mut Vec<u8>, numbers: &[f64]) {
    numbers.iter().for_each(|number| out.extend_from_slice(&number.to_le_bytes()));
}

fn vector(cursor: &mut Cursor) -> Result<DVec3, Problem> {
    let mut vector = [0.0; 3];
    for number in &mut vector {
        *number = cursor.f64("the transform")?;
    }
    Ok(DVec3::from_array(vector))
}

fn scale(cursor: &mut Cursor) -> Result<DVec3, Problem> {
    let scale = vector(cursor)?;
    cursor.take(4 * 3 * 8, "the transform")?;
    Ok(scale)
}

fn matrix(cursor: &mut Cursor) -> Result<DAffine3, Problem> {
    let mut rows = [DVec3::ZERO; 4];
    let mut last = [0.0; 4];
    for (row, last) in rows.iter_mut().zip(&mut last) {
        *row = vector(cursor)?;
        *last = cursor.f64("the transform")?;
    }
    if !DVec4::from_array(last).abs_diff_eq(DVec4::W, 1e-8) {
        return Err(damaged("the matrix of the transform is not affine"));
    }
    let [x, y, z, translation] = rows;
    Ok(DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation })
}
