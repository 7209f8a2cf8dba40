//! `tyndall render`: a scene or a volume becomes a picture with its error.

mod animation;
mod estimators;
mod picture;
mod progress;
pub mod stop;

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use miette::miette;
use tyndall_film::Colours;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::observers;
use tyndall_session::{Frames, Input, Job, JobOptions, Output, check_no_input, check_writable, colours};
use tyndall_transport::Control;

use crate::Done;
use crate::input_args::{ImportArgs, RawArgs, open, open_frames};
use crate::interrupt::stop_on_signals;
use crate::terminal::{answer, tell};
use estimators::EstimatorArgs;
use picture::{Target, open_checkpoint};
use progress::ProgressStyle;
use stop::{GoalArgs, parse_time};

/// Time between two checkpoints if nothing else is asked for.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(60);

/// Render a scene file or a volume file to a picture with its error
///
/// A volume file (.vdb .nvdb .vol .npy .nii .raw) needs no scene: camera, sun, sky and density are chosen from the
/// data; --print-scene shows the choices as a scene file.
#[derive(Debug, Clone, clap::Args)]
#[command(group = clap::ArgGroup::new("resumable").multiple(true))]
#[command(after_help = "\
Examples:
  tyndall render smoke.vdb                          smoke.exr and smoke.png, 64 samples a pixel
  tyndall render smoke.vdb --set volume.0.mu_t=3    ... thicker
  tyndall render smoke.vdb --print-scene > smoke.toml
  tyndall render smoke.toml -o smoke.exr --error 1% --time 10min     until either is reached
  tyndall render smoke.toml -o part.acc --samples 64..128            a share of the work, for `tyndall merge`
  tyndall render smoke.toml -o smoke.exr --checkpoint smoke.acc --resume
  tyndall render 'smoke.####.vdb' --frames 1..240 -o 'smoke.####.exr' --resume")]
pub struct Args {
    /// Scene file (.toml, or .pbrt and Mitsuba's .xml) or volume file; the built-in cumulus if left out
    input: Option<PathBuf>,
    /// Where to write the picture: .exr, .png, .acc or .json; may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<Output>,
    #[command(flatten)]
    goal: GoalArgs,
    /// Render only the samples A to B−1 of each pixel; A..=B has B as well
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
    /// Give pixels different numbers of samples, `spp` on average: more where the picture is noisy and samples cost little
    #[arg(long)]
    adaptive: bool,
    #[command(flatten)]
    estimators: EstimatorArgs,
    /// Save the exact sums here every now and then and at the end, for --resume
    #[arg(long, value_name = "FILE.acc", group = "resumable")]
    checkpoint: Option<PathBuf>,
    /// How often the checkpoint is saved, such as 30s or 10min; between passes of a sample a pixel at least
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = parse_time, requires = "checkpoint")]
    checkpoint_every: Duration,
    /// Go on from the checkpoint, if it exists; with --frames, skip frames whose pictures are there
    #[arg(long, requires = "resumable")]
    resume: bool,
    /// Render an animation: the frames A to B, both included, or every STEP-th of them, or a single one
    ///
    /// #### in the input, in `file` keys of the scene, in --set and in names of outputs is the frame's number, padded with
    /// zeros; outputs without it get .0001 before the extension. Camera, light and density of a bare volume are chosen from
    /// the first frame. All frames have the same seed, unless --set render.seed=# says otherwise; --time is for each frame.
    #[arg(long, value_name = "A..B[:STEP]", group = "resumable")]
    frames: Option<Frames>,
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
            adaptive: false,
            estimators: EstimatorArgs::default(),
            checkpoint: None,
            checkpoint_every: CHECKPOINT_EVERY,
            frames: None,
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
    let input = match args.frames {
        Some(frames) => {
            open_frames(args.input.as_deref(), &overrides(&args), &args.raw, &args.import, frames)?
        }
        None => open(args.input.as_deref(), &overrides(&args), &args.raw, &args.import)?,
    };
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
    if let Some(frames) = args.frames {
        return animation::run(&args, input, frames);
    }
    let outputs = outputs(&args, &input)?;
    let files = || outputs.iter().map(Output::path).chain(args.checkpoint.as_deref());
    check_writable(files())?;
    check_no_input(files(), &input)?;
    let checkpoint = open_checkpoint(args.checkpoint.as_deref(), args.checkpoint_every, args.resume)?;
    let job = Job::new(&input, &job_options(&args))?;
    job.notes().iter().for_each(|note| tell(format!("note: {note}")));
    args.estimators.tell_integrator(args.integrator);
    let control = Arc::new(Control::default());
    stop_on_signals(&control.cancel)?;
    let target = Target {
        outputs,
        exposure: args.exposure.unwrap_or(description.film.exposure) as f32,
        checkpoint,
        progress: args.progress,
        frame: None,
    };
    let plan = args.goal.with_samples(args.samples).plan(description.render.spp);
    target.render(job, &plan, &control)
}

fn job_options(args: &Args) -> JobOptions {
    JobOptions { threads: args.threads.map(usize::from), estimators: args.estimators.chosen() }
}

/// The files to write, once it is known that they can hold the picture.
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
    Ok(outputs)
}

/// A picture to work with and, of colours, one to look at, otherwise the numbers, in the working folder.
fn default_outputs(stem: &str, colours: &Colours) -> Vec<Output> {
    [".exr", if *colours == Colours::Rgb { ".png" } else { ".json" }]
        .iter()
        .filter_map(|extension| format!("{stem}{extension}").parse().ok())
        .collect()
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
    overrides.extend(args.adaptive.then(|| "render.adaptive=true".to_owned()));
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

fn parse_samples(text: &str) -> Result<Range<u64>, String> {
    let range = text.split_once("..").and_then(|(start, end)| {
        let end = match end.strip_prefix('=') {
            Some(last) => last.parse::<u64>().ok()?.checked_add(1)?,
            None => end.parse().ok()?,
        };
        Some(start.parse().ok()?..end)
    });
    range
        .filter(|range: &Range<u64>| range.start < range.end)
        .ok_or("write A..B with A < B, such as 0..64, or A..=B".into())
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
    fn samples_end_before_the_last_number_or_with_it() {
        assert_eq!(parse_samples("0..64"), Ok(0..64));
        assert_eq!(parse_samples("0..=63"), Ok(0..64));
        assert_eq!(parse_samples("7..=7"), Ok(7..8));
        for wrong in ["5..5", "5..=4", "0..=18446744073709551615", "..4", "1-4", "0..==3"] {
            assert!(parse_samples(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn exposures_are_finite() {
        assert_eq!(parse_exposure("-1.5"), Ok(-1.5));
        assert!(["nan", "inf", "1e30", ""].iter().all(|text| parse_exposure(text).is_err()));
    }
}
