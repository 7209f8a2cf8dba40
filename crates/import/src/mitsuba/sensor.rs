//! `<sensor>`, `<film>`, `<sampler>`, `<integrator>`: camera, picture, samples and depth.
//!
//! Mitsuba's cameras look along +z with +y up and +x to the *left* of the picture, which for a `lookat` is the usual
//! unmirrored view; a `to_world` that mirrors makes a mirrored picture. `fov` is that of the width unless `fov_axis` says
//! otherwise. An orthographic film is 2 units wide, times the scale of `to_world`. Paths of `max_depth` n have n − 1
//! scatterings.

use tyndall_scene::description::{CameraDescription, Names, Projection};

use super::importer::Importer;
use super::object::{Class, Object};
use super::transform::{LookAt, plain};
use crate::ImportError;
use crate::affine::is_flat;

impl<'a> Importer<'a> {
    /// The camera; sets the film.
    pub fn sensor(&mut self, number: usize) -> Result<CameraDescription, ImportError> {
        let object = self.object(number);
        object.ignore(&["near_clip", "far_clip", "shutter_open", "shutter_close", "srf"]);
        if let Some(film) = self.child(object, Class::Film) {
            self.film(film)?;
        } else {
            self.film.resolution = [768, 576];
        }
        if let Some(sampler) = self.child(object, Class::Sampler) {
            self.sampler(sampler)?;
        }
        let transform = object.transform("to_world")?;
        let map = transform.map;
        if is_flat(&map) {
            return Err(object.place.error("the `to_world` of the sensor is flat: no factor may be 0"));
        }
        let [width, height] = self.film.resolution.map(f64::from);
        let mut camera = match transform.look_at {
            Some(view) => looking_at(&view),
            None => CameraDescription {
                position: map.translation.to_array().map(plain),
                direction: Some(map.matrix3.z_axis.to_array().map(plain)),
                up: map.matrix3.y_axis.to_array().map(plain),
                ..looking_at(&LookAt::default())
            },
        };
        if transform.look_at.is_none() {
            camera.target = None;
        }
        let is_mirrored = map.matrix3.determinant() < 0.0;
        // Half the width and half the height of what the film shows.
        let half = match object.plugin.as_str() {
            "orthographic" => {
                camera.projection = Projection::Orthographic;
                let scale = [map.matrix3.x_axis.length(), map.matrix3.y_axis.length()];
                [scale[0], scale[1] * height / width]
            }
            "perspective" | "thinlens" => {
                let tan = self.tan_of_half_fov(object, width / height)?;
                [tan, tan * height / width]
            }
            _ => {
                let message = format!("{} is not supported: a perspective one is taken", object.title());
                self.unsupported(&object.place, message);
                let tan = self.tan_of_half_fov(object, width / height)?;
                [tan, tan * height / width]
            }
        };
        let [x, y] =
            [object.float("principal_point_offset_x", 0.0)?, object.float("principal_point_offset_y", 0.0)?];
        if x.abs().max(y.abs()) > 1e6 {
            return Err(object.place.error("the `principal_point_offset` is too large"));
        }
        let is_even = (half[0] / half[1] / (width / height) - 1.0).abs() < 1e-12;
        if [x, y] != [0.0; 2] || is_mirrored || !is_even {
            let [left, right] = [half[0] * (2.0 * x - 1.0), half[0] * (2.0 * x + 1.0)];
            let [bottom, top] = [half[1] * (-2.0 * y - 1.0), half[1] * (-2.0 * y + 1.0)];
            let sign = if is_mirrored { -1.0 } else { 1.0 };
            camera.window = Some([sign * left, sign * right, bottom, top].map(plain));
        } else if camera.projection == Projection::Orthographic {
            camera.height = Some(2.0 * half[1]);
        } else {
            camera.vertical_fov = match (object.text("fov_axis")?, object.float_if_given("fov")?) {
                // As it is written.
                (Some("y"), Some(fov)) => fov,
                _ => 2.0 * libm::atan(half[1]).to_degrees(),
            };
        }
        if object.plugin == "thinlens" {
            camera.aperture_radius = object.float("aperture_radius", 0.0)?.max(0.0);
            let distance = object.float("focus_distance", object.float("far_clip", 1e4)?)?;
            if distance <= 0.0 {
                return Err(object.place.error("the `focus_distance` must be above 0"));
            }
            camera.focus_distance = Some(distance);
        } else {
            object.ignore(&["focus_distance"]);
        }
        if let Some(medium) = self.child(object, Class::Medium) {
            camera.inside = Names::some(self.medium(medium)?);
        }
        self.tell_unused(object);
        Ok(camera)
    }

    /// Tangent of half the angle between the left and the right edge.
    fn tan_of_half_fov(&mut self, object: &'a Object, aspect: f64) -> Result<f64, ImportError> {
        let across = |degrees: f64| libm::tan(0.5 * degrees.to_radians());
        let diagonal = |tan: f64| tan / (1.0 + 1.0 / (aspect * aspect)).sqrt();
        let tan = match object.float_if_given("fov")? {
            Some(fov) if !(fov > 0.0 && fov < 180.0) => 0.0,
            Some(fov) => {
                let axis = object.text("fov_axis")?.unwrap_or("x").to_ascii_lowercase();
                match (axis.as_str(), aspect > 1.0) {
                    ("x", _) | ("smaller", false) | ("larger", true) => across(fov),
                    ("y", _) | ("smaller", true) | ("larger", false) => across(fov) * aspect,
                    ("diagonal", _) => diagonal(across(fov)),
                    _ => {
                        let message = "`fov_axis` must be one of x, y, diagonal, smaller, larger";
                        return Err(object.place.error(message));
                    }
                }
            }
            None => {
                let text = object.text("focal_length")?.unwrap_or("50mm");
                let length = super::text::number(text.trim_end_matches("mm"));
                let length = length.map_err(|message| object.place.error(message))?;
                // Along the diagonal of a film of 36 mm by 24 mm.
                diagonal(libm::hypot(36.0, 24.0) / (2.0 * length))
            }
        };
        if !(tan > 0.0 && tan.is_finite() && tan < 1e6) {
            return Err(object
                .place
                .error("the angle of view must be above 0 and below 180 degrees: mend `fov`"));
        }
        Ok(tan)
    }

    fn film(&mut self, number: usize) -> Result<(), ImportError> {
        let film = self.object(number);
        film.ignore(&[
            "file_format",
            "pixel_format",
            "component_format",
            "banner",
            "compensate",
            "sample_border",
        ]);
        if film.plugin != "hdrfilm" {
            let message =
                format!("{} is not supported: the picture is linear red, green and blue", film.title());
            self.unsupported(&film.place, message);
        }
        let size = |name: &str, default: u32| -> Result<u32, ImportError> {
            let Some(given) = film.integer(name)? else { return Ok(default) };
            u32::try_from(given)
                .ok()
                .filter(|size| *size <= 65536)
                .ok_or_else(|| film.place.error(format!("`{name}` must be from 0 to 65536, and not {given}")))
        };
        let resolution = [size("width", 768)?, size("height", 576)?];
        if resolution.contains(&0) {
            return Err(film.place.error("the film must have pixels: mend `width` and `height`"));
        }
        let crop = [
            size("crop_offset_x", 0)?,
            size("crop_offset_y", 0)?,
            size("crop_width", resolution[0])?,
            size("crop_height", resolution[1])?,
        ];
        let fits = |axis: usize| crop[axis + 2] > 0 && crop[axis] + crop[axis + 2] <= resolution[axis];
        if !(fits(0) && fits(1)) {
            return Err(film.place.error("the crop window does not lie in the film: mend the `crop_` keys"));
        }
        self.film.resolution = resolution;
        self.film.crop = Some(crop).filter(|crop| crop[2..] != resolution);
        let filter = self.child(film, Class::ReconstructionFilter).map(|number| self.object(number));
        if let Some(filter) = filter {
            filter.properties.iter().for_each(|property| property.is_used.set(true));
        }
        let name = filter.map_or("gaussian", |filter| filter.plugin.as_str());
        if name != "box" {
            let place = filter.map_or(&film.place, |filter| &filter.place);
            let message = format!("pixels are filtered by a box and not by `{name}`: edges are less blurred");
            self.choice(place, message);
        }
        self.tell_unused(film);
        Ok(())
    }

    fn sampler(&mut self, number: usize) -> Result<(), ImportError> {
        let sampler = self.object(number);
        sampler.ignore(&["seed", "jitter"]);
        if let Some(count) = sampler.integer("sample_count")? {
            self.render.spp = u32::try_from(count).ok().filter(|count| *count > 0).ok_or_else(|| {
                sampler.place.error(format!("`sample_count` must be above 0, and not {count}"))
            })?;
        }
        self.tell_unused(sampler);
        Ok(())
    }

    /// How deep paths are.
    pub fn integrator(&mut self, number: usize) -> Result<(), ImportError> {
        let object = self.object(number);
        object.ignore(&["rr_depth", "samples_per_pass", "block_size", "timeout", "guiding"]);
        match object.plugin.as_str() {
            "volpath" | "volpathmis" => {}
            "path" | "prb" | "ptracer" => {
                self.choice(
                    &object.place,
                    format!("{} does not see media; here they are rendered", object.title()),
                );
            }
            "aov" | "moment" | "stokes" => {
                let message =
                    format!("{} is not supported: only the picture itself is rendered", object.title());
                self.unsupported(&object.place, message);
                object.ignore(&["aovs"]);
                if let Some(inner) = self.child(object, Class::Integrator) {
                    self.within(number, |importer| importer.integrator(inner))?;
                }
                self.tell_unused(object);
                return Ok(());
            }
            "direct" => {
                object.ignore(&["shading_samples", "emitter_samples", "bsdf_samples"]);
                self.render.max_depth = Some(1);
            }
            _ => {
                let message = format!("{} is not supported: paths are traced", object.title());
                self.unsupported(&object.place, message);
            }
        }
        if object.boolean("hide_emitters", false)? {
            self.unsupported(&object.place, "`hide_emitters` is not supported: lights are seen");
        }
        match object.integer("max_depth")? {
            None | Some(-1) => {}
            Some(depth) if depth < 0 => {
                return Err(object.place.error("`max_depth` must be at least 0, or -1 for no limit"));
            }
            Some(depth) => {
                if depth == 0 {
                    self.unsupported(
                        &object.place,
                        "of `max_depth` 0, which is black, lights are seen all the same",
                    );
                }
                self.render.max_depth =
                    Some(u32::try_from(depth - 1).unwrap_or(if depth == 0 { 0 } else { u32::MAX }));
            }
        }
        self.tell_unused(object);
        Ok(())
    }
}

fn looking_at(view: &LookAt) -> CameraDescription {
    CameraDescription {
        position: view.origin.to_array(),
        target: Some(view.target.to_array()),
        direction: None,
        up: view.up.to_array(),
        projection: Projection::Perspective,
        height: None,
        window: None,
        inside: None,
        vertical_fov: 40.0,
        aperture_radius: 0.0,
        focus_distance: None,
    }
}
