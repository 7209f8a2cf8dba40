//! What the ranges of single keys cannot say: which keys go together, and which vectors are degenerate.

use glam::DVec3;

use super::material_rules::materials;
use super::meter_rules::meters;
use super::shape_rules::shapes;
use super::{
    CameraDescription, ColourMode, FilmOutput, LightDescription, MediumDescription, PhaseDescription,
    Projection, SceneDescription, SkyDescription, SpectrumDescription, TransformDescription,
    VolumeDescription, VolumeSource,
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
        film(&mut found, self);
        if let Some(medium) = &self.medium {
            found.within("medium", |found| {
                medium_rules(found, medium, &self.unit);
                fills_all_space(found, medium, &self.unit);
            });
        }
        for (index, description) in self.volumes.iter().enumerate() {
            found.within("volume", |found| {
                found.within(&index.to_string(), |found| volume(found, description, &self.unit))
            });
        }
        materials(&mut found, self);
        for (index, description) in self.lights.iter().enumerate() {
            found
                .within("light", |found| found.within(&index.to_string(), |found| light(found, description)));
        }
        shapes(&mut found, self);
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
    if let Some([left, right, bottom, top]) = camera.window
        && (left == right || bottom == top)
    {
        found.report("window", "`window` is empty: left and right, bottom and top must differ");
    }
    let is_orthographic = camera.projection == Projection::Orthographic;
    if !is_orthographic && camera.height.is_some() {
        found.report("height", "`height` is for `projection = \"orthographic\"`: give `vertical_fov`");
    }
    if is_orthographic && camera.height.is_none() && camera.window.is_none() {
        found.report("", "an orthographic camera needs `height`, the height of what it sees in scene units");
    }
    if is_orthographic && camera.aperture_radius > 0.0 {
        found.report("aperture_radius", "parallel rays have no lens: remove `aperture_radius`");
    }
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

fn film(found: &mut Findings, scene: &SceneDescription) {
    if let Some([left, top, width, height]) = scene.film.crop {
        let reaches = |start: u32, length: u32, all: u32| {
            length > 0 && u64::from(start) + u64::from(length) <= u64::from(all)
        };
        let [columns, rows] = scene.film.resolution;
        if !reaches(left, width, columns) || !reaches(top, height, rows) {
            let message = format!(
                "`crop` is no part of the {columns}x{rows} pixels: it is left column, top row, width, height"
            );
            found.within("film", |found| found.report("crop", message));
        }
    }
    let mut needs_spectral = |key: &str, is_given: bool| {
        if is_given && scene.render.mode != ColourMode::Spectral {
            let message =
                format!("`{key}` is computed from wavelengths: give `mode = \"spectral\"` in [render]");
            found.within("film", |found| found.report(key, message));
        }
    };
    needs_spectral("output", scene.film.output == FilmOutput::Xyz);
    needs_spectral("bands", scene.film.bands.is_some());
    if let Some(bands) = &scene.film.bands {
        found.within("film", |found| {
            if bands.is_empty() {
                found.report("bands", "`bands` is empty: give wavelengths in nm, or remove it");
            } else if scene.film.output == FilmOutput::Xyz {
                found.report("output", "the film has both `output = \"xyz\"` and `bands`: keep one");
            }
        });
    }
}

fn medium_rules(found: &mut Findings, medium: &MediumDescription, unit: &str) {
    let violation = match &medium.particles {
        Some(_) => medium.particles_violation(unit),
        None => medium.coefficients(unit, 0.0).err(),
    };
    if let Some((path, message)) = violation {
        report_at(found, &path, message);
    }
    for (key, emission) in
        [("emission", &medium.emission), ("emission_per_length", &medium.emission_per_length)]
    {
        if let Some(emission) = emission {
            light_spectrum(found, key, emission, 1.0);
        }
    }
    if let Some((key, message)) = medium.phase.as_ref().and_then(PhaseDescription::violation) {
        found.within("phase", |found| found.report(key, message));
    }
}

/// Mean free path beyond which a ray without end has no number for its place.
const LONGEST_MEAN_FREE_PATH: f64 = 1e12;

/// A ray through empty space that shines would gather light without end.
fn fills_all_space(found: &mut Findings, medium: &MediumDescription, unit: &str) {
    let Ok(coefficients) = medium.coefficients(unit, 0.0) else { return };
    let mu_t = coefficients.mu_t_rgb();
    let least = mu_t.to_array().into_iter().filter(|mu_t| *mu_t > 0.0).fold(f64::INFINITY, f64::min);
    if least < 1.0 / LONGEST_MEAN_FREE_PATH {
        let message = format!(
            "[medium] fills all space with an extinction of {least:e}: light goes further through it than is computed with; \
             give 0, or 1e-12 and more"
        );
        found.report("", message);
    }
    let per_length = medium.emission_per_length.as_ref().and_then(|spectrum| spectrum.light().ok());
    if let Some(brightest) = per_length.map(|light| (light.light_rgb() / mu_t).max_element())
        && brightest.is_finite()
        && brightest > BRIGHTEST
    {
        let message = format!(
            "`emission_per_length` shines as {brightest:e} in a medium that fills all space, and pictures hold numbers up to \
             4e9: give it a greater extinction"
        );
        found.report("emission_per_length", message);
    }
    if medium.emission_per_length.is_some() && mu_t.min_element() <= 0.0 {
        let message = "a medium that fills all space and does not weaken light would shine without end: \
                       give it an extinction above 0";
        found.report("emission_per_length", message);
    }
}

/// The film holds numbers below 2^32.
const BRIGHTEST: f64 = 4.29e9;

/// `scale` is a factor on the light.
pub(super) fn light_spectrum(
    found: &mut Findings,
    key: &'static str,
    spectrum: &SpectrumDescription,
    scale: f64,
) {
    match spectrum.light() {
        Err((inner, message)) => report_at(found, &[key, inner], format!("`{key}`: {message}")),
        Ok(light) => {
            // What point lights and what shines along a way are seen as depends on lengths.
            let is_seen_as_it_is = matches!(key, "radiance" | "irradiance" | "emission");
            let brightest = scale * light.light_rgb().max_element();
            if is_seen_as_it_is && brightest > BRIGHTEST {
                found.report(key, too_bright(key, brightest));
            }
        }
    }
}

fn too_bright(key: &str, brightest: f64) -> String {
    format!("`{key}` is {brightest:e}, and pictures hold numbers up to 4e9: give all lights in a larger unit")
}

/// Reports the key at the end of a path of tables; empty keys are none.
fn report_at(found: &mut Findings, path: &[&str], message: String) {
    match path {
        [] => found.report("", message),
        [key, rest @ ..] if rest.iter().all(|inner| inner.is_empty()) => found.report(key, message),
        [table, rest @ ..] => found.within(table, |found| report_at(found, rest, message)),
    }
}

fn volume(found: &mut Findings, volume: &VolumeDescription, unit: &str) {
    medium_rules(found, &volume.medium, unit);
    if let (Some(emission), Some(scale)) = (&volume.medium.emission, volume.emission_scale)
        && let Ok(light) = emission.light()
        && let brightest = scale * light.light_rgb().max_element()
        && brightest > BRIGHTEST
    {
        found.report("emission_scale", too_bright("emission_scale", brightest));
    }
    fields(found, volume);
    if let Some(transform) = &volume.transform {
        found.within("transform", |found| transform_is_invertible(found, transform, "volume"));
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

/// The grids beside the density.
fn fields(found: &mut Findings, volume: &VolumeDescription) {
    let medium = &volume.medium;
    if volume.temperature.is_some() && medium.emission.is_some() {
        found.report("emission", "the volume glows by both `emission` and `temperature`: keep one");
    }
    let emits =
        volume.temperature.is_some() || medium.emission.is_some() || medium.emission_per_length.is_some();
    for (key, is_given) in [
        ("emission_grid", volume.emission_grid.is_some()),
        ("emission_scale", volume.emission_scale.is_some()),
    ] {
        if is_given && !emits {
            let message = format!(
                "`{key}` multiplies what is not there: give `emission`, `emission_per_length` or `temperature`"
            );
            found.report(key, message);
        }
    }
    let files = [
        ("emission_grid", volume.emission_grid.as_ref().map(|grid| &grid.file)),
        ("temperature", volume.temperature.as_ref().map(|grid| &grid.file)),
        ("albedo_grid", volume.albedo_grid.as_ref().map(|grid| &grid.file)),
    ];
    for (key, file) in files {
        if matches!(file, Some(None)) && volume.file.is_none() {
            found.report(key, format!("`{key}` needs a `file`: the volume itself is from none"));
        }
    }
}

pub(super) fn transform_is_invertible(found: &mut Findings, transform: &TransformDescription, what: &str) {
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
        found.report(key, format!("`{key}` makes the {what} flat: no factor may be 0"));
    }
}

fn light(found: &mut Findings, light: &LightDescription) {
    match light {
        LightDescription::Sun(sun) => {
            found.report_zero("direction", sun.direction);
            light_spectrum(found, "irradiance", &sun.irradiance, 1.0);
        }
        LightDescription::Distant(distant) => {
            found.report_zero("direction", distant.direction);
            light_spectrum(found, "irradiance", &distant.irradiance, 1.0);
        }
        LightDescription::Sky(description) => sky(found, description),
        LightDescription::Constant(constant) => light_spectrum(found, "radiance", &constant.radiance, 1.0),
        LightDescription::Point(point) => light_spectrum(found, "intensity", &point.intensity, 1.0),
        LightDescription::Spot(spot) => {
            found.report_zero("direction", spot.direction);
            light_spectrum(found, "intensity", &spot.intensity, 1.0);
            if spot.inner_angle > spot.angle {
                found.report(
                    "inner_angle",
                    "`inner_angle` must not be greater than `angle`, the edge of the cone",
                );
            }
        }
        LightDescription::Image(image) => {
            if let Some(message) = image.orientation_violation() {
                found.report("orientation", message);
            }
        }
    }
}

fn sky(found: &mut Findings, sky: &SkyDescription) {
    if sky.intensity > BRIGHTEST {
        found.report("intensity", too_bright("intensity", sky.intensity));
    }
    let Some(toward_sun) = sky.toward_sun else { return };
    found.report_zero("toward_sun", toward_sun);
    for (key, is_given) in
        [("sun_elevation", sky.sun_elevation.is_some()), ("sun_azimuth", sky.sun_azimuth.is_some())]
    {
        if is_given {
            found.report(key, format!("the sky has both `{key}` and `toward_sun`: keep one"));
        }
    }
    if sky.toward_sun().y < libm::sin((-6.1_f64).to_radians()) {
        found.report(
            "toward_sun",
            "`toward_sun`: the sun is more than 6 degrees below the horizon, where the sky is night",
        );
    }
}
