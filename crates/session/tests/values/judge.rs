//! What becomes of a scene: it is refused by a line that a user can act on, or it renders.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use tyndall_film::Accumulation;
use tyndall_scene::SceneDocument;
use tyndall_scene::description::{ColourMode, Integrator, SceneDescription};
use tyndall_session::{Goal, Input, Job, JobOptions, read_meters};
use tyndall_transport::Control;
use tyndall_transport::walk::{self, WalkOptions};

/// Pictures with more pixels are not rendered.
const MOST_PIXELS: u64 = 64;

/// What renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// The fast integrator, with red, green and blue.
    Fast,
    /// The reference.
    Reference,
    /// Wavelengths, by the fast integrator where it can.
    Spectral,
}

impl Engine {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Reference, Self::Spectral];
}

/// The fate of a scene that was dealt with as it should be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fate {
    /// By this line.
    Refused(String),
    /// With a picture, in which every number is finite.
    Rendered {
        /// Samples that were left out of it.
        left_out: u64,
        /// What was said of the scene.
        notes: Vec<String>,
    },
}

/// The fate of the scene of this text; or what is wrong with how it was dealt with.
///
/// `names` are those of which a refusal must hold one.
pub fn fate(text: &str, folder: &Path, names: &[&str], engines: &[Engine]) -> Result<Fate, String> {
    let document = SceneDocument::parse("case.toml", text);
    let description = match document.and_then(|document| document.description()) {
        Ok(description) => description,
        Err(error) => {
            if let Some(problem) = error.problems().iter().find(|problem| problem.position.is_none()) {
                return Err(format!("the refusal has no line and column: {problem}"));
            }
            return refusal(&error.to_string(), names);
        }
    };
    let (mut left_out, mut notes) = (0, Vec::new());
    for &engine in engines {
        match rendered(description.clone(), folder, engine) {
            Ok(Ok(job)) => {
                notes.extend_from_slice(job.notes());
                for picture in job.pictures() {
                    sound(picture, engine).map_err(|why| format!("{engine:?}: {why}"))?;
                    left_out += picture.film.rejected();
                }
            }
            Ok(Err(refused)) => return refusal(&refused, names),
            Err(why) => return Err(format!("{engine:?}: {why}")),
        }
    }
    Ok(Fate::Rendered { left_out, notes })
}

/// The render, done, after a look at the meters; or by which line the scene was refused as it was built.
fn rendered(
    mut description: SceneDescription,
    folder: &Path,
    engine: Engine,
) -> Result<Result<Job, String>, String> {
    description.render.integrator =
        if engine == Engine::Reference { Integrator::Reference } else { Integrator::Fast };
    if engine == Engine::Spectral {
        description.render.mode = ColourMode::Spectral;
    }
    let input = Input::from_description("case.toml", description, folder);
    let made = || {
        let ready = input.ready().map_err(|error| error.to_string())?;
        meters(input.description(), &ready.built.scene)?;
        let options = JobOptions { threads: Some(1), ..JobOptions::default() };
        Job::of_ready(&input, &ready, &options).map_err(|error| error.to_string())
    };
    let mut job = match made() {
        Ok(job) => job,
        Err(refused) => return Ok(Err(refused)),
    };
    if job.pixels() <= MOST_PIXELS {
        let plan = Goal { spp: Some(2), ..Goal::default() }.plan(2);
        job.run(&plan, &Control::default(), |_| {}).map_err(|error| error.to_string())?;
    }
    Ok(Ok(job))
}

fn refusal(message: &str, names: &[&str]) -> Result<Fate, String> {
    if message.contains('\n') || message.len() > 1000 {
        return Err(format!("the refusal is no line: {message}"));
    }
    if !names.iter().any(|name| message.contains(name)) {
        return Err(format!("the refusal names none of {names:?}: {message}"));
    }
    Ok(Fate::Refused(message.to_owned()))
}

fn sound(picture: &Accumulation, engine: Engine) -> Result<(), String> {
    let film = &picture.film;
    // A colour of wavelengths may lie outside of what red, green and blue can show. Differences of single floats are
    // rounded.
    let least = if engine == Engine::Spectral { f64::NEG_INFINITY } else { -1e-6 };
    for y in 0..film.height() {
        for x in 0..film.width() {
            if !film.mean(x, y).into_iter().all(|mean| mean.is_finite() && mean >= least) {
                return Err(format!("the pixel at {x}, {y} is {:?}", film.mean(x, y)));
            }
        }
    }
    Ok(())
}

fn meters(description: &SceneDescription, scene: &tyndall_scene::Scene) -> Result<(), String> {
    if description.meters.is_empty() {
        return Ok(());
    }
    let goal = walk::Goal { samples: 64, error: None, time: None };
    let options = |stream| WalkOptions { seed: 0, stream, threads: 1, goal };
    let never = AtomicBool::new(false);
    let readings = read_meters("case.toml", description, scene, options, &never);
    readings.map(drop).map_err(|error| error.to_string())
}
