//! Whole pictures by every choice of estimators: how far each is from the truth, and what it costs.
//!
//! Each distance sampler is paired with the transmittance estimators that are the default, and the other way round. The
//! error of a picture is taken from its own standard errors, relMSE = ⟨SE²/(B² + 0.01)⟩ over pixels and channels, with the
//! mean B of all unbiased pictures; its efficiency is 1/(relMSE · seconds).

use std::time::Instant;

use miette::IntoDiagnostic;
use serde::Serialize;
use tyndall_film::{Film, LUMINANCE, Layers};
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::{Camera, Scene, SceneDescription};
use tyndall_transport::{Control, Estimators, RenderOptions, render_pass};

use super::comparison::Refused;
use super::trial::{Estimator, Kind};

/// Size and effort of the pictures.
#[derive(Debug, Clone, Copy)]
pub struct PictureOptions {
    /// Columns; rows by the shape of the scene's picture.
    pub width: u32,
    /// Samples a pixel.
    pub spp: u64,
    /// Seed of the first; each has its own.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
}

/// One picture by one choice.
#[derive(Debug, Clone, Serialize)]
pub struct PictureTrial {
    /// The estimator chosen; `default` for the choice without a choice.
    pub name: &'static str,
    /// What it is for; absent for the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<Kind>,
    pub unbiased: bool,
    /// Mean luminance of the picture.
    pub mean: f64,
    pub standard_error: f64,
    /// Of the mean, against the default picture's.
    pub z: Option<f64>,
    pub relmse: f64,
    pub seconds: f64,
    /// 1/(relMSE · seconds).
    pub efficiency: Option<f64>,
}

/// All pictures, and what makes none.
#[derive(Debug, Default, Serialize)]
pub struct Pictures {
    pub resolution: [u32; 2],
    pub spp: u64,
    pub threads: usize,
    pub estimators: Vec<PictureTrial>,
    pub refused: Vec<Refused>,
}

/// Renders the whole view of the scene, whatever its crop, by each choice; `tell` hears of each before.
pub fn render_all(
    scene: &Scene,
    description: &SceneDescription,
    options: PictureOptions,
    mut tell: impl FnMut(&str),
) -> miette::Result<Pictures> {
    let [width, height] = description.film.resolution;
    let rows = (f64::from(options.width) * f64::from(height) / f64::from(width)).round();
    let resolution = [options.width, (rows as u32).clamp(1, 4 * options.width)];
    let camera = Camera::new(&description.camera, resolution, None);
    let small = Scene { camera, resolution, ..scene.clone() };
    let (mut choices, mut refused) = (vec![(None, Estimators::default())], Vec::new());
    for estimator in Estimator::all() {
        let (name, kind) = (estimator.properties().name, estimator.kind());
        match chosen(estimator).validate(&small) {
            _ if small.is_spectral() => {
                let reason = "the spectral integrator renders this scene, with estimators of its own";
                refused.push(Refused { name, kind, reason: reason.into() });
            }
            Ok(()) => choices.push((Some(estimator), chosen(estimator))),
            Err(reason) => refused.push(Refused { name, kind, reason: reason.to_string() }),
        }
    }
    let mut films = Vec::new();
    for (number, (choice, estimators)) in (0..).zip(&choices) {
        tell(choice.map_or("default", |choice| choice.properties().name));
        films.push(render(&small, *estimators, options, number)?);
    }
    let names: Vec<Option<Estimator>> = choices.into_iter().map(|(choice, _)| choice).collect();
    let estimators = judge(&names, &films);
    Ok(Pictures { resolution, spp: options.spp, threads: options.threads, estimators, refused })
}

fn chosen(estimator: Estimator) -> Estimators {
    match estimator {
        Estimator::Distance(sampler) => Estimators { distance: Some(sampler), transmittance: None },
        Estimator::Transmittance(estimator) => Estimators { distance: None, transmittance: Some(estimator) },
    }
}

fn render(
    scene: &Scene,
    estimators: Estimators,
    options: PictureOptions,
    number: u64,
) -> miette::Result<(Film, f64)> {
    let [width, height] = scene.resolution;
    let mut film = Film::new(width, height, Layers::NONE).into_diagnostic()?;
    film.open_range(0).into_diagnostic()?;
    let render_options = RenderOptions {
        integrator: Integrator::Reference,
        sampler: Sampler::Independent,
        // Far apart, as seeds that a user gives stand close together.
        seed: options.seed + (number << 32),
        threads: options.threads,
        estimators,
    };
    let start = Instant::now();
    render_pass(scene, &mut film, options.spp, &render_options, &Control::default());
    let seconds = start.elapsed().as_secs_f64();
    film.complete_through(options.spp).into_diagnostic()?;
    Ok((film, seconds))
}

fn judge(choices: &[Option<Estimator>], films: &[(Film, f64)]) -> Vec<PictureTrial> {
    let is_unbiased = |choice: &Option<Estimator>| choice.is_none_or(|c| c.properties().unbiased);
    let unbiased = choices.iter().zip(films).filter(|(choice, _)| is_unbiased(choice));
    let reference = mean_of(&unbiased.map(|(_, (film, _))| film).collect::<Vec<_>>());
    let default_mean = films.first().map(|(film, _)| luminance(film));
    let trials = choices.iter().zip(films).map(|(choice, (film, seconds))| {
        let (mean, standard_error) = luminance(film);
        let relmse = relmse(film, &reference);
        let z = default_mean.filter(|_| choice.is_some()).and_then(|(default, error)| {
            let error = error.hypot(standard_error);
            (error > 0.0).then(|| (mean - default) / error)
        });
        PictureTrial {
            name: choice.map_or("default", |choice| choice.properties().name),
            kind: choice.map(Estimator::kind),
            unbiased: is_unbiased(choice),
            mean,
            standard_error,
            z,
            relmse,
            seconds: *seconds,
            efficiency: (relmse > 0.0 && *seconds > 0.0).then(|| 1.0 / (relmse * seconds)),
        }
    });
    trials.collect()
}

fn pixels(film: &Film) -> impl Iterator<Item = [u32; 2]> {
    let width = film.width();
    (0..film.height()).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

/// Mean picture of films of one size.
fn mean_of(films: &[&Film]) -> Vec<[f64; 3]> {
    let share = 1.0 / films.len() as f64;
    let Some(first) = films.first() else { return Vec::new() };
    let mean = |[x, y]: [u32; 2]| {
        films
            .iter()
            .map(|film| film.mean(x, y))
            .fold([0.0; 3], |sum, mean| std::array::from_fn(|channel| sum[channel] + share * mean[channel]))
    };
    pixels(first).map(mean).collect()
}

fn relmse(film: &Film, reference: &[[f64; 3]]) -> f64 {
    let terms = pixels(film).zip(reference).flat_map(|([x, y], reference)| {
        let error = film.standard_error(x, y);
        (0..3).map(move |channel| error[channel].powi(2) / (reference[channel].powi(2) + 0.01))
    });
    terms.sum::<f64>() / (3 * reference.len()) as f64
}

/// Mean luminance of the picture and its standard error; the channels of a path go together, so their errors add.
fn luminance(film: &Film) -> (f64, f64) {
    let channels = film.image_mean();
    let weighted = |of: fn(&tyndall_film::Estimate) -> f64| {
        channels.iter().zip(LUMINANCE).map(|(channel, weight)| weight * of(channel)).sum()
    };
    (weighted(|channel| channel.mean), weighted(|channel| channel.standard_error))
}
