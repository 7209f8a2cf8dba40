//! `tyndall render`: a scene or a volume becomes a picture with its error.

mod estimators;
pub mod input;
mod progress;
pub mod stop;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use miette::{IntoDiagnostic, miette};
use tyndall_film::{Accumulation, Colours, Crop, Film, ImageMetadata, Layers};
use tyndall_scene::description::{FilmDescription, Integrator, Layer, Sampler, SceneDescription};
use tyndall_scene::{Observer, Scene, build, observers, scene_hash};
use tyndall_transport::counters;
use tyndall_transport::{Control, Estimators, Outcome, RenderOptions, Renderer};

use crate::Done;
use crate::imported::ImportArgs;
use crate::output::{Output, check_writable, parse_exposure, write_all};
use crate::terminal::{answer, tell};
use crate::volume_input::RawArgs;
use estimators::EstimatorArgs;
use input::Input;
use progress::{Progress, ProgressStyle};
use stop::{Goal, Plan};

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
    goal: Goal,
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
            goal: Goal::default(),
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

/// Loads, builds, renders, writes.
pub fn run(args: Args) -> miette::Result<Done> {
    let input = input::load(args.input.as_deref(), &overrides(&args), &args.raw, &args.import)?;
    let description = &input.description;
    if args.resolution.is_some() && description.film.crop.is_some() {
        return Err(miette!(
            "--resolution: the scene has film.crop, which counts pixels of its own resolution; give both as --set \
             film.resolution=[W,H] --set film.crop=[LEFT,TOP,W,H]"
        ));
    }
    if args.print_scene {
        return print_scene(&input).map(|()| Done::All);
    }
    let observers = observers(description);
    let colours = colours(observers[0]);
    let outputs = if args.output.is_empty() { input.default_outputs(&colours) } else { args.output.clone() };
    for output in &outputs {
        output.check_colours(&colours, observers.len())?;
    }
    if args.checkpoint.is_some() && observers.len() > 1 {
        return Err(miette!(
            "--checkpoint: an .acc file holds at most three bands; give fewer in film.bands"
        ));
    }
    check_writable(outputs.iter().map(Output::path).chain(args.checkpoint.as_deref()))?;

    let [width, height] = description.film.picture_size();
    // First of all, as it may be too large for this machine.
    let new_film = || Film::new(width, height, layers(description)).into_diagnostic();
    let films = observers.iter().map(|_| new_film()).collect::<miette::Result<Vec<Film>>>()?;
    let built = build(description, &input.folder)?;
    let estimators =
        args.estimators.choose(description.render.integrator, args.input.as_deref(), &built.scene)?;
    for note in input.notes.iter().chain(&built.notes).chain(&estimators.notes()) {
        tell(format!("note: {note}"));
    }
    if args.integrator.is_none() && args.estimators.integrator().is_some() {
        tell("note: --distance and --transmittance belong to the reference integrator, which is taken");
    }
    if built.scene.is_spectral() {
        let why = if built.scene.is_chromatic() {
            "some extinction or phase function depends on colour"
        } else {
            "the picture is computed from wavelengths"
        };
        tell(format!("note: {why}: the spectral integrator renders it"));
    }
    let mut pictures = Vec::new();
    for (film, observer) in films.into_iter().zip(&observers) {
        pictures.push(open_picture(&args, description, &input.folder, estimators, film, *observer)?);
    }
    let plan = Plan::new(&args.goal, args.samples.clone(), u64::from(description.render.spp));
    let end = render(&args, built.scene, &observers, description, &plan, &mut pictures)?;

    if pictures.iter().any(|picture| picture.film.mean_sample_count() == 0.0) {
        tell("interrupted before all was rendered once; nothing is written");
        return Ok(end);
    }
    let exposure = args.exposure.unwrap_or(description.film.exposure) as f32;
    let saved = args.checkpoint.as_deref().map_or(Ok(()), |checkpoint| pictures[0].write(checkpoint));
    write_all(&outputs, &pictures, exposure)?;
    saved.into_diagnostic()?;
    report(&pictures, &outputs, &end);
    Ok(end)
}

/// `--print-scene`: what is not as in the renderer that the scene is for is told as well.
fn print_scene(input: &Input) -> miette::Result<()> {
    if let Some(written) = &input.written {
        input.notes.iter().for_each(|note| tell(format!("note: {note}")));
        if !written.paths().is_empty() {
            tell(
                "note: files in the folder of temporary files are gone after this; `tyndall convert` keeps them",
            );
        }
    }
    answer(&input.text)
}

/// What the channels of an observer's film are.
fn colours(observer: Observer) -> Colours {
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

/// The options as they are kept with the picture: samples of different ones are not merged, as their errors differ.
fn options(description: &SceneDescription, estimators: Estimators) -> String {
    let sampler = match description.render.sampler {
        Sampler::Independent => String::new(),
        // Readers of the picture should know as well.
        Sampler::Sobol => " sampler=sobol standard-errors=upper-estimates".to_owned(),
    };
    let estimators = estimators::as_options(estimators);
    format!("integrator={}{sampler}{estimators}", name(description.render.integrator))
}

/// An empty film, or the one of the checkpoint.
fn open_picture(
    args: &Args,
    description: &SceneDescription,
    folder: &Path,
    estimators: Estimators,
    film: Film,
    observer: Observer,
) -> miette::Result<Accumulation> {
    let metadata = ImageMetadata {
        scene_hash: scene_hash(description, folder)?.to_string(),
        version: env!("CARGO_PKG_VERSION").to_string(),
        options: options(description, estimators),
        seed: u64::from(description.render.seed),
        colours: colours(observer),
        crop: crop(&description.film),
        seconds: 0.0,
    };
    let empty = Accumulation { film, metadata };
    let Some(checkpoint) = args.checkpoint.as_deref().filter(|path| path.exists()) else { return Ok(empty) };
    if !args.resume {
        return Err(miette!(
            "{}: exists already; add --resume to go on from it, or name another file",
            checkpoint.display()
        ));
    }
    let saved = Accumulation::read(checkpoint).into_diagnostic()?;
    let same = |a: &ImageMetadata, b: &ImageMetadata| {
        (&a.scene_hash, &a.version, &a.options, a.seed) == (&b.scene_hash, &b.version, &b.options, b.seed)
    };
    let shape = |film: &Film| (film.width(), film.height(), film.layers());
    if !same(&saved.metadata, &empty.metadata) || shape(&saved.film) != shape(&empty.film) {
        return Err(miette!(
            "{}: is of another scene, size, seed, integrator, sampler, estimators, layers or version; name another --checkpoint",
            checkpoint.display()
        ));
    }
    Ok(saved)
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
        shadow_catcher: has_catcher || asked.is_some_and(|layers| layers.contains(&Layer::ShadowCatcher)),
    }
}

/// Renders pass after pass, each for all observers, until the plan is fulfilled or Ctrl-C is pressed.
fn render(
    args: &Args,
    scene: Scene,
    observers: &[Observer],
    description: &SceneDescription,
    plan: &Plan,
    pictures: &mut [Accumulation],
) -> miette::Result<Done> {
    let control = Arc::new(Control::default());
    stop_on_interrupt(&control)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let options = RenderOptions {
        integrator: description.render.integrator,
        sampler: description.render.sampler,
        seed: pictures[0].metadata.seed,
        threads: args.threads.map_or(cores, usize::from),
        estimators: args.estimators.chosen(),
    };
    let [width, height] = scene.resolution.map(u64::from);
    let pixels = width * height * observers.len() as u64;
    let scenes: Vec<Scene> =
        observers.iter().map(|observer| Scene { observer: *observer, ..scene.clone() }).collect();
    let renderers: Vec<Renderer<'_>> =
        scenes.iter().map(|scene| Renderer::new(scene, options.integrator)).collect();
    let mut clock = stop::Clock::start(pictures[0].metadata.seconds);
    let progress = Progress::start(args.progress, pixels, plan.spp(), Arc::clone(&control));
    let mut end = Done::All;
    'passes: while let Some(pass) = plan.next_pass(pictures, &clock) {
        for (picture, renderer) in pictures.iter_mut().zip(&renderers) {
            picture.film.open_range(pass.start).into_diagnostic()?;
            let outcome = renderer.render_pass(&mut picture.film, pass.end, &options, &control);
            picture.metadata.seconds = clock.seconds();
            if outcome == Outcome::Cancelled {
                end = Done::Interrupted;
                break 'passes;
            }
            // Only what was resumed can hold more than was asked for now.
            let resumed = args.checkpoint.as_deref().unwrap_or(Path::new("the picture"));
            picture
                .film
                .complete_through(pass.end)
                .map_err(|error| miette!("{}: {error} (--spp or --samples)", resumed.display()))?;
        }
        progress.pass_done(&pictures[0].film);
        if let Some(checkpoint) = args.checkpoint.as_deref().filter(|_| clock.checkpoint_is_due()) {
            // The next may go well, and the picture itself is not lost.
            if let Err(error) = pictures[0].write(checkpoint) {
                tell(format!("note: no checkpoint: {error}"));
            }
        }
    }
    progress.finish();
    if counters::COUNTED {
        tell(format!("counters: {}", control.counters.counters().json()));
    }
    Ok(end)
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
