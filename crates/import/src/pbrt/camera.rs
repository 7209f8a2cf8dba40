//! Camera, film, and the settings of a render.
//!
//! pbrt's camera looks along +z with x to the right and y up. Its screen is the rectangle in which the shorter axis of
//! the picture runs from −1 to 1, which is `fov` across; what it sees at distance 1 is the screen times tan(fov/2).

use glam::DVec3;
use tyndall_scene::description::{
    CameraDescription, FilmDescription, Layer, Names, Projection, RenderDescription,
};

use super::context::Context;
use super::directives::Entity;
use super::world::{CameraUse, World};
use crate::ImportError;

/// The film, and what all light is multiplied by so that the picture has pbrt's values.
pub(super) fn film(
    film: Option<&Entity>,
    camera: &CameraUse,
    context: &Context,
) -> Result<(FilmDescription, f64), ImportError> {
    let shutter = &camera.entity.parameters;
    let seconds = shutter.float_or("shutterclose", 1.0)? - shutter.float_or("shutteropen", 0.0)?;
    if seconds <= 0.0 {
        return Err(camera
            .entity
            .place
            .error("the shutter closes before it opens: give a later `shutterclose`"));
    }
    let Some(entity) = film else { return Ok((FilmDescription::default(), seconds)) };
    let (parameters, place) = (&entity.parameters, &entity.place);
    let pixels = |name: &str, default: u32| -> Result<u32, ImportError> {
        match parameters.integer(name)? {
            None => Ok(default),
            Some(count @ 1..=65536) => Ok(count as u32),
            Some(_) => Err(place.error(format!("`{name}` must be from 1 to 65536"))),
        }
    };
    let resolution = [pixels("xresolution", 1280)?, pixels("yresolution", 720)?];
    if parameters.text("sensor")?.is_some_and(|sensor| sensor != "cie1931") {
        context.unsupported(
            place,
            "the sensor of a real camera is not supported: colours are the CIE 1931 observer's",
        );
    }
    if parameters.float_or("whitebalance", 0.0)? != 0.0 {
        context.unsupported(place, "the white balance is left out");
    }
    if parameters.float("maxcomponentvalue")?.is_some() {
        context.unsupported(place, "`maxcomponentvalue` is left out: bright samples are kept");
    }
    let iso = parameters.float_or("iso", 100.0)?;
    if iso <= 0.0 {
        return Err(place.error("`iso` must be above 0"));
    }
    let mut layers = None;
    match entity.kind.as_str() {
        "rgb" => {}
        "gbuffer" => layers = Some(vec![Layer::Depth, Layer::Normal, Layer::Albedo]),
        kind => context.unsupported(place, format!("the film \"{kind}\" is taken for \"rgb\"")),
    }
    let crop = crop(entity, resolution)?;
    // Names, number formats, and the size of the film, which only real lenses need.
    parameters.pass(&["filename", "savefp16", "diagonal", "coordinatesystem"]);
    context.tell_unused("Film", entity);
    Ok((FilmDescription { resolution, crop, layers, ..FilmDescription::default() }, seconds * iso / 100.0))
}

/// The part of the picture that is rendered: left, top, width, height.
fn crop(entity: &Entity, [width, height]: [u32; 2]) -> Result<Option<[u32; 4]>, ImportError> {
    let parameters = &entity.parameters;
    let bounds = if let Some(window) = parameters.exactly::<4>("cropwindow")? {
        let [x0, x1, y0, y1] = window;
        let edge = |fraction: f64, size: u32| (fraction.clamp(0.0, 1.0) * f64::from(size)).ceil();
        [edge(x0.min(x1), width), edge(x0.max(x1), width), edge(y0.min(y1), height), edge(y0.max(y1), height)]
    } else if let Some([x0, x1, y0, y1]) = parameters.exactly::<4>("pixelbounds")? {
        let edge = |pixel: f64, size: u32| pixel.clamp(0.0, f64::from(size));
        [edge(x0, width), edge(x1, width), edge(y0, height), edge(y1, height)]
    } else {
        return Ok(None);
    };
    let [left, right, top, bottom] = bounds.map(|edge| edge as u32);
    if left >= right || top >= bottom {
        return Err(entity.place.error("the part of the picture that is kept is empty: give a larger one"));
    }
    let crop = [left, top, right - left, bottom - top];
    Ok(Some(crop).filter(|crop| *crop != [0, 0, width, height]))
}

/// The camera. `inside` is left to the caller.
pub(super) fn camera(
    camera: &CameraUse,
    film: &FilmDescription,
    context: &Context,
) -> Result<CameraDescription, ImportError> {
    let (parameters, place) = (&camera.entity.parameters, &camera.entity.place);
    let projection = match camera.entity.kind.as_str() {
        "perspective" => Projection::Perspective,
        "orthographic" => Projection::Orthographic,
        kind @ ("realistic" | "spherical") => {
            context.unsupported(place, format!("the camera \"{kind}\" is taken for \"perspective\""));
            Projection::Perspective
        }
        kind => return Err(place.error(format!("\"{kind}\" is no camera of pbrt-v4"))),
    };
    let to_world = camera.world_to_camera.inverse();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.transform_vector3(axis));
    let scale = axes.map(DVec3::length);
    let [x, up, direction] = axes.map(DVec3::normalize_or_zero);
    if x.dot(up).abs().max(up.dot(direction).abs()).max(direction.dot(x).abs()) > 1e-6 {
        context
            .unsupported(place, "the camera's transform shears the picture: it is taken for one that turns");
    }
    // The way that is right in a picture of the right-handed world.
    let is_mirrored = direction.cross(up).dot(x) < 0.0;
    let [width, height] = film.resolution.map(f64::from);
    let aspect = parameters.float_or("frameaspectratio", width / height)?;
    if aspect <= 0.0 {
        return Err(place.error("`frameaspectratio` must be above 0"));
    }
    let whole =
        if aspect > 1.0 { [-aspect, aspect, -1.0, 1.0] } else { [-1.0, 1.0, -1.0 / aspect, 1.0 / aspect] };
    let screen = parameters.exactly::<4>("screenwindow")?.unwrap_or(whole);
    if screen[0] == screen[1] || screen[2] == screen[3] {
        return Err(place.error("the `screenwindow` is empty: give left, right, bottom and top"));
    }
    let fov = parameters.float_or("fov", 90.0)?;
    let half_width = match projection {
        Projection::Perspective if fov > 0.0 && fov < 180.0 => libm::tan(fov.to_radians() / 2.0) / scale[2],
        Projection::Perspective => return Err(place.error("`fov` must be above 0 and below 180 degrees")),
        Projection::Orthographic => 1.0,
    };
    let flip = if is_mirrored { -1.0 } else { 1.0 };
    let [across, upwards] = [flip * half_width * scale[0], half_width * scale[1]];
    let window = [screen[0] * across, screen[1] * across, screen[2] * upwards, screen[3] * upwards];
    let focus = parameters.float_or("focaldistance", 1e6)? * scale[2];
    let mut aperture_radius = parameters.float_or("lensradius", 0.0)?.max(0.0) * scale[0];
    if aperture_radius > 0.0 && projection == Projection::Orthographic {
        context.unsupported(place, "an orthographic camera has no lens here: all is in focus");
        aperture_radius = 0.0;
    }
    if aperture_radius > 0.0 && focus <= 0.0 {
        return Err(place.error("`focaldistance` must be above 0"));
    }
    parameters.pass(&["shutteropen", "shutterclose", "lensfile", "aperturediameter", "aperture", "mapping"]);
    context.tell_unused("Camera", &camera.entity);
    let mut description = CameraDescription {
        position: to_world.translation.to_array().map(plain),
        target: None,
        direction: Some(direction.to_array()),
        up: up.to_array(),
        projection,
        height: None,
        window: Some(window),
        inside: None::<Names>,
        vertical_fov: 40.0,
        aperture_radius,
        focus_distance: Some(focus).filter(|_| aperture_radius > 0.0),
    };
    say_plainly(&mut description, window, width / height);
    Ok(description)
}

/// Says a window that is symmetric and has the picture's shape by the angle or height that it is.
fn say_plainly(camera: &mut CameraDescription, [left, right, bottom, top]: [f64; 4], aspect: f64) {
    let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
    if !(top > 0.0 && is_near(left, -right) && is_near(bottom, -top) && is_near(right, top * aspect)) {
        return;
    }
    camera.window = None;
    match camera.projection {
        Projection::Perspective => camera.vertical_fov = plain(2.0 * libm::atan(top).to_degrees()),
        Projection::Orthographic => camera.height = Some(2.0 * top),
    }
}

/// A number without the last digits that rounding has left.
fn plain(number: f64) -> f64 {
    let rounded = (number * 1e9).round() / 1e9;
    // The sum makes 0 of -0.
    if (rounded - number).abs() < 1e-11 * number.abs() { rounded } else { number + 0.0 }
}

/// Samples for each pixel, seed, greatest depth; and what is said of other ways to render.
pub(super) fn render(world: &World, context: &Context) -> Result<RenderDescription, ImportError> {
    let mut render =
        RenderDescription { spp: 16, seed: world.seed.unwrap_or(0), ..RenderDescription::default() };
    if let Some(sampler) = &world.sampler {
        let parameters = &sampler.parameters;
        let count = if sampler.kind == "stratified" {
            let [x, y] = [parameters.integer("xsamples")?, parameters.integer("ysamples")?];
            Some(x.unwrap_or(4).saturating_mul(y.unwrap_or(4)))
        } else {
            parameters.integer("pixelsamples")?
        };
        let count = count.unwrap_or(if sampler.kind == "independent" { 4 } else { 16 });
        render.spp = u32::try_from(count.max(1)).unwrap_or(1);
    }
    if let Some(integrator) = &world.integrator {
        let parameters = &integrator.parameters;
        let maxdepth = parameters.integer("maxdepth")?;
        render.max_depth = maxdepth.and_then(|depth| u32::try_from(depth).ok());
        if maxdepth.is_none() {
            let message =
                "paths end nowhere: pbrt ends them after 5 scatterings where `maxdepth` is not given";
            context.choice(&integrator.place, message);
        }
        if parameters.flag("regularize")? == Some(true) {
            context.unsupported(&integrator.place, "`regularize` is left out: mirrors stay sharp");
        }
        if !matches!(integrator.kind.as_str(), "path" | "volpath") {
            let message = format!("the integrator \"{}\" is not used: paths are", integrator.kind);
            context.choice(&integrator.place, message);
        }
    }
    match &world.filter {
        Some(filter) => {
            let radius = |name: &str| filter.parameters.float_or(name, 0.5);
            if filter.kind != "box" || radius("xradius")? != 0.5 || radius("yradius")? != 0.5 {
                let message = format!(
                    "the filter \"{}\" is not used: a pixel is the mean over its square",
                    filter.kind
                );
                context.unsupported(&filter.place, message);
            }
        }
        None => {
            if let Some(camera) = &world.camera {
                let message =
                    "a pixel is the mean over its square: pbrt blurs where no `PixelFilter` is given";
                context.choice(&camera.entity.place, message);
            }
        }
    }
    Ok(render)
}
