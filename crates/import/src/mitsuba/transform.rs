//! `<transform>`: operations that are done one after another, each on what came out before.
//!
//! Mitsuba multiplies every operation from the left: of `<scale/><translate/>` a point is first scaled. Its cameras and
//! lamps look along +z, with +y up; a `lookat` has the columns left = up × forward, up, forward, so that it is a rotation.

use glam::{DAffine3, DMat3, DVec3};
use roxmltree::Node;
use tyndall_scene::description::TransformDescription;

use super::text::{number, numbers};

/// A map to the world.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Transform {
    pub map: DAffine3,
    /// The last operation, if it is a `lookat` that nothing but a uniform scale came before.
    pub look_at: Option<LookAt>,
}

/// Where something stands and what it looks at, as it was written.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct LookAt {
    pub origin: DVec3,
    pub target: DVec3,
    pub up: DVec3,
}

impl Transform {
    /// The transform with the operation of an element after it; `attribute` gives the element's attributes. Or what is
    /// wrong.
    pub fn then(&self, node: Node, attribute: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let tag = node.tag_name().name();
        let mut look_at = None;
        let operation = match tag {
            "translate" => DAffine3::from_translation(vector(&attribute, 0.0)?),
            "scale" => DAffine3::from_scale(vector(&attribute, 1.0)?),
            "rotate" => {
                let axis = vector(&attribute, 0.0)?.try_normalize();
                let axis = axis.ok_or("the axis of <rotate> is 0: give x, y or z")?;
                let angle = attribute("angle").ok_or("<rotate> has no `angle`: give it in degrees")?;
                rotation(axis, number(&angle)?)
            }
            "lookat" => {
                let view = look_at_attributes(&attribute)?;
                look_at = is_uniform_scale(&self.map).then_some(view);
                look_at_map(&view).ok_or("the <lookat> looks nowhere: `origin` and `target` must differ")?
            }
            "matrix" => {
                let value = attribute("value").ok_or("<matrix> has no `value`: give 16 numbers")?;
                matrix(&numbers(&value)?)?
            }
            _ => return Err(format!("<{tag}> is no operation of a <transform>")),
        };
        let map = operation * self.map;
        let greatest = map.to_cols_array().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        if !(map.is_finite() && greatest <= GREATEST) {
            return Err("the transform is too large to compute with".into());
        }
        Ok(Self { map, look_at })
    }

    /// The map as a description, or none if it leaves everything where it is.
    pub fn describe(map: &DAffine3) -> Option<TransformDescription> {
        if *map == DAffine3::IDENTITY {
            return None;
        }
        let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
        let t = map.translation;
        let matrix =
            [x.x, y.x, z.x, t.x, x.y, y.y, z.y, t.y, x.z, y.z, z.z, t.z, 0.0, 0.0, 0.0, 1.0].map(plain);
        Some(TransformDescription { matrix: Some(matrix), ..TransformDescription::default() })
    }
}

/// Greatest coordinate of a point or a transform, so that products of two are numbers that a scene may have.
pub(super) const GREATEST: f64 = 1e14;

/// Without negative zeros.
pub(super) fn plain(value: f64) -> f64 {
    value + 0.0
}

fn is_uniform_scale(map: &DAffine3) -> bool {
    let scale = map.matrix3.x_axis.x;
    scale > 0.0 && *map == DAffine3::from_scale(DVec3::splat(scale))
}

fn vector(attribute: &impl Fn(&str) -> Option<String>, default: f64) -> Result<DVec3, String> {
    if let Some(value) = attribute("value") {
        return match numbers(&value)?.as_slice() {
            [all] => Ok(DVec3::splat(*all)),
            [x, y, z] => Ok(DVec3::new(*x, *y, *z)),
            values => Err(format!("`value` has {} numbers: give 1 or 3", values.len())),
        };
    }
    let coordinate = |name| attribute(name).map_or(Ok(default), |text| number(&text));
    Ok(DVec3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?))
}

/// About an axis of unit length, degrees; quarter turns have no rounding errors.
fn rotation(axis: DVec3, degrees: f64) -> DAffine3 {
    let quarters = degrees / 90.0;
    let (sin, cos) = if quarters.fract() == 0.0 {
        [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarters.rem_euclid(4.0) as usize % 4]
    } else {
        libm::sincos(degrees.to_radians())
    };
    // Rodrigues' formula.
    let turn = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    DAffine3::from_mat3(DMat3::from_cols(turn(DVec3::X), turn(DVec3::Y), turn(DVec3::Z)))
}

fn look_at_attributes(attribute: &impl Fn(&str) -> Option<String>) -> Result<LookAt, String> {
    let triple = |name: &str| -> Result<Option<DVec3>, String> {
        let Some(text) = attribute(name) else { return Ok(None) };
        match numbers(&text)?.as_slice() {
            [x, y, z] => Ok(Some(DVec3::new(*x, *y, *z))),
            values => Err(format!("`{name}` has {} numbers: give 3", values.len())),
        }
    };
    let needed = |name: &str| triple(name)?.ok_or(format!("<lookat> has no `{name}`: give three numbers"));
    let (origin, target) = (needed("origin")?, needed("target")?);
    let forward = (target - origin).normalize_or_zero();
    let up = triple("up")?.unwrap_or(DVec3::ZERO);
    // Any direction across, where none is given or it is along the view.
    let is_across = up.cross(forward).length() > 1e-12 * up.length();
    let up = if is_across && up != DVec3::ZERO { up } else { across(forward) };
    Ok(LookAt { origin, target, up })
}

/// The direction that stands for `up` where none is given (Duff et al. 2017, the first of their two vectors).
fn across(n: DVec3) -> DVec3 {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    DVec3::new(1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x)
}

fn look_at_map(view: &LookAt) -> Option<DAffine3> {
    let forward = (view.target - view.origin).try_normalize()?;
    let left = view.up.cross(forward).try_normalize()?;
    let up = forward.cross(left);
    Some(DAffine3 { matrix3: DMat3::from_cols(left, up, forward), translation: view.origin })
}

/// Rows of 4 or of 3 numbers.
fn matrix(values: &[f64]) -> Result<DAffine3, String> {
    let (width, translation) = match values.len() {
        16 => (4, DVec3::new(values[3], values[7], values[11])),
        9 => (3, DVec3::ZERO),
        count => return Err(format!("the matrix has {count} numbers: give 16")),
    };
    if width == 4 && values[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err("the last row of the matrix must be 0 0 0 1".into());
    }
    let column = |at: usize| DVec3::new(values[at], values[width + at], values[2 * width + at]);
    Ok(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation })
}
