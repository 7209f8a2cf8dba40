//! A render: a scene ready to trace, the picture so far, and the loop over passes that makes more of it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use tyndall_film::{Accumulation, Film};
use tyndall_scene::description::Integrator;
use tyndall_scene::{Observer, Scene, observers};
use tyndall_transport::{Control, Estimators, Outcome, RenderOptions, Renderer};

use crate::clock::Clock;
use crate::input::ReadyScene;
use crate::picture::{are_alike, empty_films, empty_pictures, metadata};
use crate::{Input, Output, Plan, SessionError};

/// What the scene does not say of its render.
#[derive(Debug, Clone, Default)]
pub struct JobOptions {
    /// Number of threads; as many as there are cores by default. The picture does not depend on it.
    pub threads: Option<usize>,
    /// Estimators of the reference integrator.
    pub estimators: Estimators,
}

/// A scene ready to be rendered, and its picture so far.
///
/// The picture is several films if it has more than three bands, and one otherwise.
#[derive(Debug)]
pub struct Job {
    /// The scene as each film's observer sees it.
    scenes: Vec<Scene>,
    options: RenderOptions,
    pictures: Vec<Accumulation>,
    notes: Vec<String>,
    /// The file that the picture goes on from.
    resumed: Option<PathBuf>,
    /// Whether the pixels of a picture get different numbers of samples.
    is_adaptive: bool,
}

impl Job {
    /// Builds the scene, with an empty picture.
    ///
    /// # Errors
    /// If the picture is too large for this machine, a file of the scene cannot be used, or the estimators do not suit
    /// the scene.
    pub fn new(input: &Input, options: &JobOptions) -> Result<Self, SessionError> {
        let description = input.description();
        let observers = observers(description);
        // First of all, as they may be too large for this machine.
        let films = empty_films(description, &observers)?;
        Self::with_films(input, &input.ready()?, films, options)
    }

    /// The same of a scene that is ready already: that of `input`, as it is now or was before a change of its `render` table.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_ready(input: &Input, ready: &ReadyScene, options: &JobOptions) -> Result<Self, SessionError> {
        let films = empty_films(input.description(), &observers(input.description()))?;
        Self::with_films(input, ready, films, options)
    }

    fn with_films(
        input: &Input,
        ready: &ReadyScene,
        films: Vec<Film>,
        options: &JobOptions,
    ) -> Result<Self, SessionError> {
        let ReadyScene { built, hash } = ready;
        let description = input.description();
        let observers = observers(description);
        let estimators = options.estimators;
        let integrator = description.render.integrator;
        if estimators != Estimators::default() && integrator != Integrator::Reference {
            return Err(SessionError::refuse(
                input.name(),
                "estimators can be chosen for the reference integrator only; leave them or the fast one out",
            ));
        }
        estimators
            .validate(&built.scene)
            .map_err(|reason| SessionError::refuse(input.name(), reason.to_string()))?;
        let mut notes: Vec<String> = input.notes().iter().chain(&built.notes).cloned().collect();
        notes.extend(estimators.notes().iter().map(ToString::to_string));
        notes.extend(spectral_note(&built.scene));
        notes.extend(precision_note(&built.scene, integrator));
        // When all that the scene takes is taken.
        films.iter().try_for_each(Film::ask_for_memory_to_come)?;
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        let pictures = empty_pictures(films, &observers, description, *hash, estimators);
        Ok(Self {
            options: RenderOptions {
                integrator,
                sampler: description.render.sampler,
                seed: u64::from(description.render.seed),
                threads: options.threads.unwrap_or_else(cores),
                estimators,
            },
            scenes: seen_by(&built.scene, &observers),
            pictures,
            notes,
            resumed: None,
            is_adaptive: description.render.adaptive,
        })
    }

    /// What was guessed and what the user should know, one line each; those of the input come first.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Pixels of all films together.
    pub fn pixels(&self) -> u64 {
        let of_film =
            |picture: &Accumulation| u64::from(picture.film.width()) * u64::from(picture.film.height());
        self.pictures.iter().map(of_film).sum()
    }

    /// The picture so far.
    pub fn pictures(&self) -> &[Accumulation] {
        &self.pictures
    }

    /// The picture so far, for good.
    pub fn into_pictures(self) -> Vec<Accumulation> {
        self.pictures
    }

    /// Goes on from the picture in an `.acc` file, in place of an empty one.
    ///
    /// # Errors
    /// If the file cannot be read, is of another scene or made in another way, or the picture is several films.
    pub fn resume(&mut self, path: &Path) -> Result<(), SessionError> {
        let saved = Accumulation::read(path)?;
        let [picture] = &mut self.pictures[..] else {
            return Err(SessionError::refuse_file(path, "an .acc file holds at most three bands"));
        };
        let is_otherwise = !saved.film.is_empty() && saved.film.rates().is_some() != self.is_adaptive;
        if is_otherwise || !are_alike(&saved, picture) {
            return Err(SessionError::refuse_file(
                path,
                "is of another scene, size, seed, integrator, sampler, estimators, layers or version, or adaptive or not; name another \
                 --checkpoint",
            ));
        }
        *picture = saved;
        self.resumed = Some(path.to_owned());
        Ok(())
    }

    /// Renders pass after pass, each for all films, until the plan is fulfilled or `control.cancel` is set; `after_pass`
    /// sees the picture after each.
    ///
    /// # Errors
    /// If the picture that was resumed holds samples that the plan does not reach, or a thread panicked; all that was
    /// rendered before is in the picture.
    pub fn run(
        &mut self,
        plan: &Plan,
        control: &Control,
        mut after_pass: impl FnMut(&[Accumulation]),
    ) -> Result<Outcome, SessionError> {
        let Some(first) = self.pictures.first() else { return Ok(Outcome::Complete) };
        let renderers: Vec<Renderer<'_>> =
            self.scenes.iter().map(|scene| Renderer::new(scene, self.options.integrator)).collect();
        let mut clock = Clock::start(first.metadata.seconds, first.film.complete().count());
        if self.is_adaptive
            && allot(&mut self.pictures, &renderers[0], &self.options, control)? == Outcome::Cancelled
        {
            return Ok(Outcome::Cancelled);
        }
        clock.begin_passes();
        // Only what was resumed can hold more than was asked for now.
        let resumed = self.resumed.as_deref().unwrap_or(Path::new("the picture"));
        while let Some(pass) = plan.next_pass(&self.pictures, &clock) {
            if control.cancel.load(Ordering::Relaxed) {
                return Ok(Outcome::Cancelled);
            }
            for (picture, renderer) in self.pictures.iter_mut().zip(&renderers) {
                let refuse =
                    |error| SessionError::refuse_file(resumed, format!("{error} (--spp or --samples)"));
                picture.film.open_range(pass.start).map_err(refuse)?;
                // The film holds whatever tiles were done, as after a cancellation.
                let outcome = catch_unwind(AssertUnwindSafe(|| {
                    renderer.render_pass(&mut picture.film, pass.end, &self.options, control)
                }));
                picture.metadata.seconds = clock.seconds();
                let outcome = outcome.map_err(|_| SessionError::Panicked)?;
                if outcome == Outcome::Cancelled {
                    return Ok(Outcome::Cancelled);
                }
                picture.film.complete_through(pass.end).map_err(refuse)?;
            }
            after_pass(&self.pictures);
        }
        Ok(Outcome::Complete)
    }
}

/// Gives the pixels of a picture without samples different numbers of them, as a pilot of its first film tells.
fn allot(
    pictures: &mut [Accumulation],
    first: &Renderer<'_>,
    options: &RenderOptions,
    control: &Control,
) -> Result<Outcome, SessionError> {
    if !pictures.iter().all(|picture| picture.film.is_empty() && picture.film.rates().is_none()) {
        return Ok(Outcome::Complete);
    }
    let film = &pictures[0].film;
    let rates = catch_unwind(AssertUnwindSafe(|| first.rates(film, options, control)));
    let Some(rates) = rates.map_err(|_| SessionError::Panicked)?? else { return Ok(Outcome::Cancelled) };
    pictures.iter_mut().for_each(|picture| picture.film.set_rates(rates.clone()));
    Ok(Outcome::Complete)
}

/// Whether all `outputs` are there already: whole, and of this scene, made in this way, with the samples of the plan.
///
/// # Errors
/// If a file that the scene names cannot be read.
pub fn is_rendered(
    input: &Input,
    options: &JobOptions,
    plan: &Plan,
    outputs: &[Output],
) -> Result<bool, SessionError> {
    // The scene's files are only read if there is something to compare them with.
    if !outputs.iter().all(|output| output.path().is_file()) {
        return Ok(false);
    }
    let observer = observers(input.description())[0];
    let making = metadata(input.description(), input.scene_hash()?, options.estimators, observer);
    Ok(outputs.iter().all(|output| output.holds(&making, plan)))
}

fn seen_by(scene: &Scene, observers: &[Observer]) -> Vec<Scene> {
    observers.iter().map(|observer| Scene { observer: *observer, ..scene.clone() }).collect()
}

fn precision_note(scene: &Scene, integrator: Integrator) -> Option<String> {
    let volume = scene.too_dense_for_single_precision().filter(|_| integrator == Integrator::Fast)?;
    Some(format!(
        "{}: is so dense that it takes double precision: the integrator for one path at a time renders it",
        volume.name
    ))
}

fn spectral_note(scene: &Scene) -> Option<String> {
    let why = if scene.is_chromatic() {
        "some extinction or phase function depends on colour"
    } else {
        "the picture is computed from wavelengths"
    };
    scene.is_spectral().then(|| format!("{why}: the spectral integrator renders it"))
}
