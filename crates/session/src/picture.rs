//! What the picture of a description is: its films with their layers and channels, and what is written beside the pixels.

use tyndall_film::{Accumulation, Colours, Crop, Film, ImageMetadata, Layers};
use tyndall_scene::description::{FilmDescription, Integrator, Layer, Sampler, SceneDescription};
use tyndall_scene::{Observer, SceneHash};
use tyndall_transport::Estimators;

use crate::SessionError;

/// A film without samples for each observer.
pub(crate) fn empty_films(
    description: &SceneDescription,
    observers: &[Observer],
) -> Result<Vec<Film>, SessionError> {
    let [width, height] = description.film.picture_size();
    observers.iter().map(|_| Ok(Film::new(width, height, layers(description))?)).collect()
}

/// The films with what is known of each before its first sample.
pub(crate) fn empty_pictures(
    films: Vec<Film>,
    observers: &[Observer],
    description: &SceneDescription,
    scene_hash: SceneHash,
    estimators: Estimators,
) -> Vec<Accumulation> {
    let metadata = |observer| metadata(description, scene_hash, estimators, observer);
    films
        .into_iter()
        .zip(observers)
        .map(|(film, observer)| Accumulation { film, metadata: metadata(*observer) })
        .collect()
}

/// What is known of an observer's film before its first sample.
pub(crate) fn metadata(
    description: &SceneDescription,
    scene_hash: SceneHash,
    estimators: Estimators,
    observer: Observer,
) -> ImageMetadata {
    ImageMetadata {
        scene_hash: scene_hash.to_string(),
        version: env!("CARGO_PKG_VERSION").to_string(),
        options: options(description, estimators),
        seed: u64::from(description.render.seed),
        colours: colours(observer),
        crop: crop(&description.film),
        seconds: 0.0,
    }
}

/// Whether two pictures are of the same scene, made in the same way.
pub(crate) fn are_alike(a: &Accumulation, b: &Accumulation) -> bool {
    let making = |picture: &Accumulation| {
        let ImageMetadata { scene_hash, version, options, seed, .. } = picture.metadata.clone();
        (scene_hash, version, options, seed)
    };
    let shape = |film: &Film| (film.width(), film.height(), film.layers());
    making(a) == making(b) && shape(&a.film) == shape(&b.film)
}

/// What the channels of an observer's film are.
pub fn colours(observer: Observer) -> Colours {
    match observer {
        Observer::Rgb | Observer::SpectralRgb => Colours::Rgb,
        Observer::SpectralXyz => Colours::Xyz,
        Observer::Bands(wavelengths_nm) => Colours::Bands(wavelengths_nm),
    }
}

/// Where the picture lies in the whole.
fn crop(film: &FilmDescription) -> Option<Crop> {
    film.crop.map(|[left, top, ..]| Crop { corner: [left, top], full_size: film.resolution })
}

/// The options as they are kept with the picture: samples of different ones are not merged, as their errors differ.
fn options(description: &SceneDescription, estimators: Estimators) -> String {
    let integrator = match description.render.integrator {
        Integrator::Fast => "fast",
        Integrator::Reference => "reference",
    };
    let sampler = match description.render.sampler {
        Sampler::Independent => "",
        // Readers of the picture should know as well.
        Sampler::Sobol => " sampler=sobol standard-errors=upper-estimates",
    };
    let adaptive = if description.render.adaptive { " adaptive=yes" } else { "" };
    let distance = estimators.distance.map(|sampler| format!(" distance={}", sampler.name()));
    let transmittance =
        estimators.transmittance.map(|estimator| format!(" transmittance={}", estimator.name()));
    let estimators: String = [distance, transmittance].into_iter().flatten().collect();
    format!("integrator={integrator}{sampler}{adaptive}{estimators}")
}

/// The layers that the scene asks for; if it does not say, those that are about something in it. Shadow catchers always
/// have theirs, which the picture's alpha needs.
fn layers(description: &SceneDescription) -> Layers {
    let asked = description.film.layers.as_ref();
    let wanted = |layer| asked.is_none_or(|layers| layers.contains(&layer));
    let of_surfaces = |layer| wanted(layer) && (asked.is_some() || !description.shapes.is_empty());
    let has_catcher = description.shapes.iter().any(|shape| shape.shadow_catcher);
    Layers {
        depth: wanted(Layer::Depth),
        albedo: wanted(Layer::Albedo),
        emission: wanted(Layer::Emission),
        single: wanted(Layer::Single),
        multiple: wanted(Layer::Multiple),
        normal: of_surfaces(Layer::Normal),
        object_id: of_surfaces(Layer::ObjectId),
        effort: asked.is_some_and(|layers| layers.contains(&Layer::Effort)),
        shadow_catcher: has_catcher || asked.is_some_and(|layers| layers.contains(&Layer::ShadowCatcher)),
    }
}
