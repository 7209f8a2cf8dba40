//! What the ranges of single keys cannot say: which keys go together, and which vectors are degenerate.

use glam::DVec3;

use super::meter_rules::meters;
use super::{
    CameraDescription, LightDescription, MediumDescription, SceneDescription, SkyDescription,
    TransformDescription, VolumeDescription, VolumeSource,
};

/// A key whose value contradicts the rest of the scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// The way to the key from the top of the scene file, such as `volume`, `0`, `mu_t`.
    pub path: Vec<String>,
    /// What is wrong, and the mend.
    pub message: String,
}

impl SceneDescription {
    /// All contradictions between keys; empty for a sound scene.
    pub fn violations(&self) -> Vec<Violation> {
        let mut found = Findings { here: Vec::new(), violations: Vec::new() };
        found.within("camera", |found| camera(found, &self.camera));
        if let Some(medium) = &self.medium {
            found.within("medium", |found| medium_rules(found, medium));
        }
        for (index, description) in self.volumes.iter().enumerate() {
            found.within("volume", |found| {
                found.within(&index.to_string(), |found| volume(found, description))
            });
        }
        for (index, description) in self.lights.iter().enumerate() {
            found
                .within("light", |found| found.within(&index.to_string(), |found| light(found, description)));
        }
        meters(&mut found, &self.meters);
        found.violations
    }
}

pub(super) struct Findings {
    here: Vec<String>,
    violations: Vec<Violation>,
}

impl Findings {
    pub(super) fn within(&mut self, key: &str, inspect: impl FnOnce(&mut Self)) {
        self.here.push(key.to_owned());
        inspect(self);
        self.here.pop();
    }

    /// Reports `key` of the present table, or the table itself if `key` is empty.
    pub(super) fn report(&mut self, key: &str, message: impl Into<String>) {
        let mut path = self.here.clone();
        if !key.is_empty() {
            path.push(key.to_owned());
        }
        self.violations.push(Violation { path, message: message.into() });
    }

    pub(super) fn report_zero(&mut self, key: &str, vector: [f64; 3]) {
        if DVec3::from_array(vector).try_normalize().is_none() {
            self.report(key, format!("`{key}` is a direction and must not be [0, 0, 0]"));
        }
    }
}

fn camera(found: &mut Findings, camera: &CameraDescription) {
    found.report_zero("up", camera.up);
    let view = match (camera.target, camera.direction) {
        (Some(_), Some(_)) => {
            return found.report("direction", "the camera has both `target` and `direction`: keep one");
        }
        (None, None) => return found.report("", "the camera looks nowhere: give `target` or `direction`"),
        (Some(target), None) => {
            let view = DVec3::from_array(target) - DVec3::from_array(camera.position);
            if view.try_normalize().is_none() {
                return found.report("target", "`target` is where the camera is: move one of them");
            }
            view
        }
        (None, Some(direction)) => {
            found.report_zero("direction", direction);
            DVec3::from_array(direction)
        }
    };
    if let (Some(view), Some(up)) = (view.try_normalize(), DVec3::from_array(camera.up).try_normalize())
        && view.cross(up).length() < 1e-9
    {
        found
            .report("up", "`up` points along the view: choose another `up`, such as [0, 0, -1] to look down");
    }
    if camera.aperture_radius > 0.0 && camera.focus_distance.is_none() && camera.target.is_none() {
        found.report("aperture_radius", "a lens needs `focus_distance` when the camera has no `target`");
    }
}

fn medium_rules(found: &mut Findings, medium: &MediumDescription) {
    if let Err((key, message)) = medium.coefficients() {
        found.report(key, message);
    }
    if let Some((key, message)) = medium.phase.violation() {
        found.within("phase", |found| found.report(key, message));
    }
}

fn volume(found: &mut Findings, volume: &VolumeDescription) {
    medium_rules(found, &volume.medium);
    if let Some(transform) = &volume.transform {
        found.within("transform", |found| transform_is_invertible(found, transform));
    }
    let source = match volume.source() {
        Ok(source) => source,
        Err((key, message)) => return found.report(key, message),
    };
    match source {
        VolumeSource::Box(shape) if (0..3).any(|axis| shape.min[axis] >= shape.max[axis]) => {
            found.report("box", "`box` is empty: each number of `min` must be less than that of `max`");
        }
        VolumeSource::Slab(shape) if shape.bottom >= shape.top => {
            found.report("slab", "`slab` is empty: `bottom` must be less than `top`");
        }
        VolumeSource::Atmosphere(shape) if shape.top.is_some_and(|top| shape.bottom >= top) => {
            found.report("atmosphere", "`atmosphere` is empty: `bottom` must be less than `top`");
        }
        _ => {}
    }
    if !matches!(source, VolumeSource::File(_) | VolumeSource::Procedural(_)) && volume.filter.is_some() {
        found.report("filter", "`filter` is for volumes with voxels: remove it");
    }
    if !matches!(source, VolumeSource::File(_)) {
        for (key, is_given) in [
            ("grid", volume.grid.is_some()),
            ("values", volume.values.is_some()),
            ("raw_shape", volume.raw_shape.is_some()),
            ("raw_type", volume.raw_type.is_some()),
        ] {
            if is_given {
                found.report(key, format!("`{key}` is for volumes from a `file`: remove it"));
            }
        }
    }
}

fn transform_is_invertible(found: &mut Findings, transform: &TransformDescription) {
    if let Some(matrix) = transform.matrix {
        if transform.scale.is_some() || transform.rotate.is_some() || transform.translate.is_some() {
            found.report("matrix", "`matrix` replaces `scale`, `rotate` and `translate`: keep it or them");
        }
        if matrix[12..] != [0.0, 0.0, 0.0, 1.0] {
            found
                .report("matrix", "the last row of `matrix` must be 0, 0, 0, 1 (rows first, column vectors)");
            return;
        }
    }
    let determinant = transform.to_affine().matrix3.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        let key = if transform.matrix.is_some() { "matrix" } else { "scale" };
        found.report(key, format!("`{key}` makes the volume flat: no factor may be 0"));
    }
}

fn light(found: &mut Findings, light: &LightDescription) {
    match light {
        LightDescription::Sun(sun) => found.report_zero("direction", sun.direction),
        LightDescription::Distant(distant) => found.report_zero("direction", distant.direction),
        LightDescription::Sky(description) => sky(found, description),
        LightDescription::Constant(_) | LightDescription::Image(_) | LightDescription::Point(_) => {}
    }
}

fn sky(found: &mut Findings, sky: &SkyDescription) {
    let Some(toward_sun) = sky.toward_sun else { return };
    found.report_zero("toward_sun", toward_sun);
    for (key, is_given) in
        [("sun_elevation", sky.sun_elevation.is_some()), ("sun_azimuth", sky.sun_azimuth.is_some())]
    {
        if is_given {
            found.report(key, format!("the sky has both `{key}` and `toward_sun`: keep one"));
        }
    }
    if sky.toward_sun().y < (-6.1_f64).to_radians().sin() {
        found
            .report("toward_sun", "the sun is more than 6 degrees below the horizon, where the sky is night");
    }
}
