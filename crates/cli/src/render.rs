//! `tyndall render`: a scene or a volume becomes a picture with its error.

mod estimators;
mod progress;
pub mod stop;

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use miette::{IntoDiagnostic, miette};
use tyndall_film::{Accumulation, Colours};
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::observers;
use tyndall_session::{Checkpoint, Input, Job, JobOptions, Output, check_writable, colours, write_all};
use tyndall_transport::{Control, Outcome, counters};

use crate::Done;
use crate::input_args::{ImportArgs, RawArgs, open};
use crate::terminal::{answer, tell};
use estimators::EstimatorArgs;
use progress::{Progress, ProgressStyle};
use stop::GoalArgs;

/// Time between two checkpoints.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(60);

/// Render a scene file or a volume file to a picture with its error
///
/// A volume file (.vdb .nvdb .vol .npy .nii .raw) needs no scene: camera, sun, sky and density are chosen from the
/// data; --print-scene shows the choices as a scene file.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall render smoke.vdb                          smoke.exr and smoke.png, 64 samples a pixel
  tyndall render smoke.vdb --set volume.0.mu_t=3    ... thicker
  tyndall render smoke.vdb --print-scene > smoke.toml
  tyndall render smoke.toml -o smoke.exr --error 1% --time 10min     until either is reached
  tyndall render smoke.toml -o part.acc --samples 64..128            a share of the work, for `tyndall merge`
  tyndall render smoke.toml -o smoke.exr --checkpoint smoke.acc --resume")]
pub struct Args {
    /// Scene file (.toml, or .pbrt and Mitsuba's .xml) or volume file; the built-in cumulus if left out
    input: Option<PathBuf>,
    /// Where to write the picture: .exr, .png, .acc or .json; may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<Output>,
    #[command(flatten)]
    goal: GoalArgs,
    /// Render only the samples A to B−1 of each pixel
    #[arg(long, value_name = "A..B", value_parser = parse_samples, conflicts_with_all = ["spp", "error", "time"])]
    samples: Option<Range<u64>>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// Number of threads; as many as there are cores by default. The picture does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Width and height of the picture
    #[arg(long, value_name = "WxH", value_parser = parse_resolution)]
    resolution: Option<[u32; 2]>,
    /// Brighten the .png by 2^STOPS
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = parse_exposure)]
    exposure: Option<f64>,
    /// Change one value of the scene, such as camera.vertical_fov=30 or volume.0.mu_t=3
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Which integrator: one path at a time to read beside the equations, or many at once
    #[arg(long, value_name = "reference|fast", value_parser = parse_integrator)]
    integrator: Option<Integrator>,
    /// How the first random numbers of paths are drawn: each path for itself, or evenly over the paths of a pixel, with
    /// less noise and standard errors that are upper estimates
    #[arg(long, value_name = "independent|sobol", value_parser = parse_sampler)]
    sampler: Option<Sampler>,
    #[command(flatten)]
    estimators: EstimatorArgs,
    /// Save the exact sums here every minute and at the end, for --resume
    #[arg(long, value_name = "FILE.acc")]
    checkpoint: Option<PathBuf>,
    /// Go on from the checkpoint, if it exists
    #[arg(long, requires = "checkpoint")]
    resume: bool,
    /// How to report progress
    #[arg(long, value_enum, default_value_t)]
    progress: ProgressStyle,
    /// Print the scene as a scene file and stop
    #[arg(long)]
    print_scene: bool,
    #[command(flatten)]
    raw: RawArgs,
    #[command(flatten)]
    import: ImportArgs,
}

impl Args {
    /// What `tyndall` alone does.
    pub fn default_scene() -> Args {
        Args {
            input: None,
            output: Vec::new(),
            goal: GoalArgs::default(),
            samples: None,
            seed: None,
            threads: None,
            resolution: None,
            exposure: None,
            set: Vec::new(),
            integrator: None,
            sampler: None,
            estimators: EstimatorArgs::default(),
            checkpoint: None,
            resume: false,
            progress: ProgressStyle::default(),
            print_scene: false,
            raw: RawArgs::default(),
            import: ImportArgs::default(),
        }
    }
}

/// Opens, builds, renders, writes.
pub fn run(args: Args) -> miette::Result<Done> {
    let input = open(args.input.as_deref(), &overrides(&args), &args.raw, &args.import)?;
    let description = input.description();
    if args.resolution.is_some() && description.film.crop.is_some() {
        return Err(miette!(
            "--resolution: the scene has film.crop, which counts pixels of its own resolution; give both as --set \
             film.resolution=[W,H] --set film.crop=[LEFT,TOP,W,H]"
        ));
    }
    if args.print_scene {
        return print_scene(&input).map(|()| Done::All);
    }
    args.estimators.check(description.render.integrator)?;
    let outputs = outputs(&args, &input)?;
    let options = JobOptions { threads: args.threads.map(usize::from), estimators: args.estimators.chosen() };
    let mut job = Job::new(&input, &options)?;
    job.notes().iter().for_each(|note| tell(format!("note: {note}")));
    if args.integrator.is_none() && args.estimators.integrator().is_some() {
        tell("note: --distance and --transmittance belong to the reference integrator, which is taken");
    }
    let mut checkpoint = open_checkpoint(&args, &mut job)?;
    let end = render(&args, description.render.spp, &mut job, checkpoint.as_mut())?;

    let pictures = job.pictures();
    if pictures.iter().any(|picture| picture.film.mean_sample_count() == 0.0) {
        tell("interrupted before all was rendered once; nothing is written");
        return Ok(end);
    }
    let exposure = args.exposure.unwrap_or(description.film.exposure) as f32;
    let saved = checkpoint.map_or(Ok(()), |mut checkpoint| checkpoint.save(&pictures[0]));
    write_all(&outputs, pictures, exposure)?;
    saved.into_diagnostic()?;
    report(pictures, &outputs, &end);
    Ok(end)
}

/// The files to write, once it is known that they can hold the picture and be written.
fn outputs(args: &Args, input: &Input) -> miette::Result<Vec<Output>> {
    let observers = observers(input.description());
    let colours = colours(observers[0]);
    let outputs =
        if args.output.is_empty() { default_outputs(input.stem(), &colours) } else { args.output.clone() };
    for output in &outputs {
        output.check_colours(&colours, observers.len())?;
    }
    if args.checkpoint.is_some() && observers.len() > 1 {
        return Err(miette!(
            "--checkpoint: an .acc file holds at most three bands; give fewer in film.bands"
        ));
    }
    check_writable(outputs.iter().map(Output::path).chain(args.checkpoint.as_deref()))?;
    Ok(outputs)
}

/// A picture to work with and, of colours, one to look at, otherwise the numbers, in the working folder.
fn default_outputs(stem: &str, colours: &Colours) -> Vec<Output> {
    [".exr", if *colours == Colours::Rgb { ".png" } else { ".json" }]
        .iter()
        .filter_map(|extension| format!("{stem}{extension}").parse().ok())
        .collect()
}

/// The checkpoint that is asked for; the job goes on from it if it is there.
fn open_checkpoint(args: &Args, job: &mut Job) -> miette::Result<Option<Checkpoint>> {
    let Some(path) = &args.checkpoint else { return Ok(None) };
    if path.exists() {
        if !args.resume {
            return Err(miette!(
                "{}: exists already; add --resume to go on from it, or name another file",
                path.display()
            ));
        }
        job.resume(path)?;
    }
    Ok(Some(Checkpoint::new(path, CHECKPOINT_INTERVAL)))
}

/// `--print-scene`: what is not as in the renderer that the scene is for is told as well.
fn print_scene(input: &Input) -> miette::Result<()> {
    if let Some(written) = input.written() {
        input.notes().iter().for_each(|note| tell(format!("note: {note}")));
        if !written.paths().is_empty() {
            tell(
                "note: files in the folder of temporary files are gone after this; `tyndall convert` keeps them",
            );
        }
    }
    answer(input.to_toml())
}

/// The options that stand for keys of the scene, as `--set` would give them.
fn overrides(args: &Args) -> Vec<String> {
    let mut overrides = args.set.clone();
    overrides.extend(args.resolution.map(|[width, height]| format!("film.resolution=[{width}, {height}]")));
    overrides.extend(args.seed.map(|seed| format!("render.seed={seed}")));
    let integrator = args.integrator.or(args.estimators.integrator());
    overrides.extend(integrator.map(|integrator| format!("render.integrator={}", name(integrator))));
    overrides.extend(args.sampler.map(|sampler| format!("render.sampler={}", sampler_name(sampler))));
    overrides
}

fn name(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::Fast => "fast",
        Integrator::Reference => "reference",
    }
}

fn sampler_name(sampler: Sampler) -> &'static str {
    match sampler {
        Sampler::Independent => "independent",
        Sampler::Sobol => "sobol",
    }
}

/// Renders until the goal is reached or Ctrl-C is pressed.
fn render(
    args: &Args,
    scene_spp: u32,
    job: &mut Job,
    mut checkpoint: Option<&mut Checkpoint>,
) -> miette::Result<Done> {
    let control = Arc::new(Control::default());
    stop_on_interrupt(&control)?;
    let plan = args.goal.with_samples(args.samples.clone()).plan(scene_spp);
    let progress = Progress::start(args.progress, job.pixels(), plan.spp(), Arc::clone(&control));
    let outcome = job.run(&plan, &control, |pictures| {
        progress.pass_done(&pictures[0].film);
        if let Some(checkpoint) = &mut checkpoint {
            // The next may go well, and the picture itself is not lost.
            if let Err(error) = checkpoint.save_if_due(&pictures[0]) {
                tell(format!("note: no checkpoint: {error}"));
            }
        }
    });
    progress.finish();
    if counters::COUNTED {
        tell(format!("counters: {}", control.counters.counters().json()));
    }
    Ok(match outcome? {
        Outcome::Complete => Done::All,
        Outcome::Cancelled => Done::Interrupted,
    })
}

/// The first Ctrl-C ends the render, which saves what there is; the second ends the program.
fn stop_on_interrupt(control: &Arc<Control>) -> miette::Result<()> {
    let control = Arc::clone(control);
    ctrlc::set_handler(move || {
        if control.cancel.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .into_diagnostic()
}

fn report(pictures: &[Accumulation], outputs: &[Output], end: &Done) {
    let film = &pictures[0].film;
    let error = film.median_relative_error().filter(|error| error.is_finite());
    let error = error.map_or("error not known yet".into(), |e| format!("median error {:.2} %", 100.0 * e));
    let interrupted = if matches!(end, Done::Interrupted) { "interrupted: " } else { "" };
    let samples = film.mean_sample_count();
    let samples = if samples.fract() == 0.0 { format!("{samples}") } else { format!("{samples:.2}") };
    tell(format!(
        "{interrupted}{}x{}, {samples} samples a pixel, {error}, {:.1} s",
        film.width(),
        film.height(),
        pictures.iter().map(|picture| picture.metadata.seconds).fold(0.0, f64::max)
    ));
    let rejected: u64 = pictures.iter().map(|picture| picture.film.rejected()).sum();
    if rejected > 0 {
        tell(format!("note: {rejected} samples were not finite or too large and count as black"));
    }
    for output in outputs {
        tell(format!("wrote {}", output.path().display()));
    }
}

fn parse_samples(text: &str) -> Result<Range<u64>, String> {
    let range = text.split_once("..").and_then(|(start, end)| Some(start.parse().ok()?..end.parse().ok()?));
    range
        .filter(|range: &Range<u64>| range.start < range.end)
        .ok_or("write A..B with A < B, such as 0..64".into())
}

fn parse_resolution(text: &str) -> Result<[u32; 2], String> {
    let size =
        text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    size.filter(|size| size.iter().all(|edge| (1..=65536).contains(edge)))
        .ok_or("write WIDTHxHEIGHT, such as 1280x720".into())
}

/// `--exposure`: more stops than any picture has would only overflow.
pub fn parse_exposure(text: &str) -> Result<f64, String> {
    let stops = text.parse::<f64>().ok().filter(|stops| stops.abs() <= 64.0);
    stops.ok_or("write stops from -64 to 64, such as 1.5".into())
}

fn parse_integrator(text: &str) -> Result<Integrator, String> {
    match text {
        "fast" => Ok(Integrator::Fast),
        "reference" => Ok(Integrator::Reference),
        _ => Err("there are `fast` and `reference`".into()),
    }
}

fn parse_sampler(text: &str) -> Result<Sampler, String> {
    match text {
        "independent" => Ok(Sampler::Independent),
        "sobol" => Ok(Sampler::Sobol),
        _ => Err("there are `independent` and `sobol`".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures_are_finite() {
        assert_eq!(parse_exposure("-1.5"), Ok(-1.5));
        assert!(["nan", "inf", "1e30", ""].iter().all(|text| parse_exposure(text).is_err()));
    }
}
