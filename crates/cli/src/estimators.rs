//! `tyndall estimators`: every distance sampler and every transmittance estimator on a scene, side by side.

mod comparison;
mod figures;
mod page;
mod pictures;
mod rays;
mod table;
mod trial;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, miette};
use serde::Serialize;
use tyndall_scene::{Ray, Scene, SceneDescription};
use tyndall_session::check_writable;

use crate::input_args::{ImportArgs, RawArgs, open};
use crate::terminal::{answer, tell};
use comparison::{Declared, Homogeneous, RayComparison};
use pictures::{PictureOptions, Pictures};
use rays::{ChosenRay, Request};

/// Compare every distance sampler and transmittance estimator on a scene: mean, error, variance, cost, efficiency
///
/// Each is run many times along some rays of the camera, thin and thick ones, and held against the exact transmittance (by
/// formula or voxel by voxel) and a quadrature. Those that a ray or a scene does not suit are listed with the reason.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall estimators smoke.toml -o report.html           a table, and a report with plots
  tyndall estimators smoke.toml --pixel 640,360 --samples 100000 --json
  tyndall estimators smoke.vdb --ray 0,0,5,0,0,-1        from a point in a direction
  tyndall estimators smoke.toml --pictures               whole pictures by each of them as well")]
pub struct Args {
    /// Scene file (.toml, or .pbrt and Mitsuba's .xml) or volume file; the built-in cumulus if left out
    input: Option<PathBuf>,
    /// Write a report with plots: .html, or .svg for the plots alone
    #[arg(short, long, value_name = "FILE", value_parser = parse_output)]
    output: Option<PathBuf>,
    /// Answer in JSON
    #[arg(long)]
    json: bool,
    /// The ray through the middle of this pixel, counted from the upper left; may be given several times
    #[arg(long, value_name = "X,Y", value_parser = rays::parse_pixel)]
    pixel: Vec<[u32; 2]>,
    /// The ray from a point in a direction; may be given several times
    #[arg(long, value_name = "OX,OY,OZ,DX,DY,DZ", allow_negative_numbers = true, value_parser = rays::parse_ray)]
    ray: Vec<Ray>,
    /// Samples of each estimator on each ray [default: 32768, fewer of those that take many lookups]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1 << 20))]
    samples: Option<u32>,
    /// Render small pictures by each of them as well, with the reference integrator
    #[arg(long)]
    pictures: bool,
    /// Width of these pictures, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 64, requires = "pictures",
          value_parser = clap::value_parser!(u32).range(4..=1024))]
    width: u32,
    /// Samples a pixel of these pictures
    #[arg(long, value_name = "N", default_value_t = 8, requires = "pictures",
          value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    spp: u32,
    /// Number of threads for the pictures; as many as there are cores by default. Rays are always timed on one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Change one value of the scene, such as volume.0.mu_t=3
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    raw: RawArgs,
    #[command(flatten)]
    import: ImportArgs,
}

/// What was found.
#[derive(Debug, Serialize)]
struct Report {
    scene: String,
    seed: u32,
    notes: Vec<String>,
    properties: Vec<Declared>,
    rays: Vec<RayComparison>,
    homogeneous: Vec<Homogeneous>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<Pictures>,
}

/// Samples, and prints or writes what came of it.
pub fn run(args: Args) -> miette::Result<()> {
    check_writable(args.output.as_deref())?;
    let input = open(args.input.as_deref(), &args.set, &args.raw, &args.import)?;
    let built = input.build()?;
    let mut notes: Vec<String> = input.notes().iter().chain(&built.notes).map(ToString::to_string).collect();
    if built.scene.is_chromatic() {
        notes.push(
            "some extinction depends on colour: on rays the estimators see the mean of its channels".into(),
        );
    }
    for note in &notes {
        tell(format!("note: {note}"));
    }
    let report = report(&args, &built.scene, input.description(), notes)?;
    if let Some(path) = &args.output {
        let text = if is_html(path) { page::page(&report) } else { figures::sheet(&report) };
        tyndall_film::write_atomically(path, |file| file.write_all(text.as_bytes())).into_diagnostic()?;
        tell(format!("wrote {}", path.display()));
    }
    if args.json {
        answer(serde_json::to_string(&report).into_diagnostic()? + "\n")
    } else {
        answer(table::table(&report))
    }
}

fn report(
    args: &Args,
    scene: &Scene,
    description: &SceneDescription,
    notes: Vec<String>,
) -> miette::Result<Report> {
    let name = args.input.as_ref().map_or("the built-in scene".into(), |path| path.display().to_string());
    let (samples, seed) = (args.samples.map(u64::from), u64::from(args.seed));
    let rays = choose_rays(args, scene, &name)?;
    let numbered = (0..).zip(&rays);
    let comparisons = numbered.map(|(number, ray)| comparison::compare(number, ray, samples, seed)).collect();
    let pictures = args.pictures.then(|| {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let options = PictureOptions {
            width: args.width,
            spp: u64::from(args.spp),
            seed,
            threads: args.threads.map_or(cores, usize::from),
        };
        pictures::render_all(scene, description, options, |name| tell(format!("picture by {name}")))
    });
    Ok(Report {
        scene: name,
        seed: args.seed,
        notes,
        properties: comparison::declared(),
        rays: comparisons,
        homogeneous: comparison::homogeneous_family(seed),
        pictures: pictures.transpose()?,
    })
}

/// The rays asked for, or some of the camera's.
fn choose_rays<'a>(args: &Args, scene: &'a Scene, name: &str) -> miette::Result<Vec<ChosenRay<'a>>> {
    if scene.volumes.is_empty() {
        return Err(miette!("{name}: has no medium for estimators to work on; add a [[volume]]"));
    }
    let pixels = args.pixel.iter().map(|&pixel| Request::Pixel(pixel));
    let requests: Vec<Request> = pixels.chain(args.ray.iter().map(|&ray| Request::Ray(ray))).collect();
    if !requests.is_empty() {
        return rays::requested(scene, &requests);
    }
    let chosen = rays::chosen_from_camera(scene);
    if chosen.is_empty() {
        return Err(miette!(
            "{name}: no camera ray meets a medium; turn the camera, or give a --ray through one"
        ));
    }
    Ok(chosen)
}

fn parse_output(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if is_html(&path) || has_extension(&path, "svg") {
        Ok(path)
    } else {
        Err("the name must end in .html or .svg".into())
    }
}

fn is_html(path: &Path) -> bool {
    has_extension(path, "html")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}
