//! `tyndall slab`: what a plane-parallel layer reflects, transmits and absorbs.

use std::fmt::Write as _;
use std::sync::atomic::Ordering;
use std::time::Instant;

use miette::{IntoDiagnostic, miette};
use serde::Serialize;
use tyndall_optics::PhaseFunction;
use tyndall_transport::walk::{Incidence, LayerFluxes, Slab, slab_input};

use crate::Done;
use crate::effort::Effort;
use crate::interrupt::cancel_on_signals;
use crate::measured::{Value, with_error};
use crate::phase;
use crate::terminal::answer;

/// Reflectance, transmittance and absorptance of a plane-parallel layer, with their standard errors
///
/// Light falls on a homogeneous layer from above. The fractions of it that come back, get through and are absorbed are
/// estimated by photon packets; TRANSMITTANCE includes the unscattered light, which is known exactly.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall slab --tau 2 --albedo 0.9 --g 0.75               van de Hulst's and MCML's: R 0.0974, T 0.6610
  tyndall slab --tau 8 --albedo 1 --phase rayleigh --incidence 60 --error 0.1%
  tyndall slab --tau 1 --albedo 0.9 --g 0.8 --n 1.33       in water, with its smooth faces to air
  tyndall slab --tau inf --albedo 0.99 --incidence diffuse --radiance 1,0.5,0.2 --json")]
pub struct Args {
    /// Optical thickness, the extinction coefficient times the thickness; `inf` for a half-space
    #[arg(long, value_name = "TAU", allow_negative_numbers = true, value_parser = parse_tau)]
    tau: f64,
    /// Single-scattering albedo: the scattered share of the light that collides
    #[arg(long, value_name = "ALBEDO", allow_negative_numbers = true, value_parser = parse_fraction)]
    albedo: f64,
    /// Mean cosine of the Henyey-Greenstein phase function; above 0 is forward
    #[arg(long, value_name = "G", default_value = "0", allow_negative_numbers = true, value_parser = parse_g)]
    g: f64,
    /// Phase function in its place, such as rayleigh or draine(g=0.6,alpha=0.5); see `tyndall phase`
    #[arg(long, value_name = "SPEC", conflicts_with = "g")]
    phase: Option<String>,
    /// Where the light comes from: along the normal, DEG degrees off it, or evenly from the whole hemisphere
    #[arg(long, value_name = "normal|diffuse|DEG", default_value = "normal", allow_negative_numbers = true,
          value_parser = parse_incidence)]
    incidence: Incidence,
    /// Refractive index of the layer, whose smooth faces to air reflect
    #[arg(long, value_name = "N", default_value = "1", allow_negative_numbers = true, value_parser = parse_index)]
    n: f64,
    /// Albedo of a Lambertian ground below
    #[arg(long, value_name = "A", default_value = "0", allow_negative_numbers = true, value_parser = parse_fraction)]
    ground_albedo: f64,
    /// Radiance at these cosines to the normal as well: that of the light that leaves at the top and the bottom
    #[arg(long, value_name = "MU,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = parse_mu)]
    radiance: Vec<f64>,
    /// Azimuth of that radiance, in degrees from the way a slanted beam travels
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, requires = "radiance",
          value_parser = parse_degrees)]
    azimuth: f64,
    #[command(flatten)]
    effort: Effort,
    /// Answer in JSON
    #[arg(long)]
    json: bool,
}

/// Sends the photons and prints what became of them.
pub fn run(args: Args) -> miette::Result<Done> {
    if args.tau.is_infinite() && args.ground_albedo > 0.0 {
        return Err(miette!("--ground-albedo: there is no ground below --tau inf; give a finite --tau"));
    }
    if args.n != 1.0 && !args.radiance.is_empty() {
        return Err(miette!("--radiance: is not known behind reflecting faces; leave --n away"));
    }
    let phase_function = match &args.phase {
        Some(spec) => phase::phase_function(spec)?,
        None => PhaseFunction::HenyeyGreenstein { g: args.g },
    };
    let slab = Slab {
        tau: args.tau,
        albedo: args.albedo,
        phase_function,
        incidence: args.incidence,
        refractive_index: args.n,
        ground_albedo: args.ground_albedo,
        views: slab_input::views(&args.radiance, args.azimuth, args.tau.is_finite()),
    };
    let cancel = cancel_on_signals()?;
    let start = Instant::now();
    let fluxes = slab.measure(&args.effort.options(0), &cancel);
    if fluxes.samples == 0 {
        return Ok(Done::Interrupted);
    }
    let seconds = start.elapsed().as_secs_f64();
    if args.json {
        let report = Report::new(&args, &fluxes, seconds);
        answer(serde_json::to_string(&report).into_diagnostic()? + "\n")?;
    } else {
        answer(table(&args, &fluxes, seconds))?;
    }
    Ok(if cancel.load(Ordering::Relaxed) { Done::Interrupted } else { Done::All })
}

/// The answer in JSON.
#[derive(Serialize)]
struct Report {
    reflectance: Value,
    transmittance: Value,
    unscattered: Value,
    absorptance: Value,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    radiance: Vec<RadianceReport>,
    samples: u64,
    seconds: f64,
}

/// Radiance at a cosine to the normal, 1/sr.
#[derive(Serialize)]
struct RadianceReport {
    mu: f64,
    reflected: Value,
    #[serde(skip_serializing_if = "Option::is_none")]
    transmitted: Option<Value>,
}

impl Report {
    fn new(args: &Args, fluxes: &LayerFluxes, seconds: f64) -> Self {
        let radiance = |(number, &mu): (usize, &f64)| RadianceReport {
            mu,
            reflected: fluxes.radiance[number].into(),
            transmitted: fluxes.radiance.get(args.radiance.len() + number).map(|&estimate| estimate.into()),
        };
        Self {
            reflectance: fluxes.reflectance.into(),
            transmittance: fluxes.transmittance.into(),
            unscattered: fluxes.unscattered.into(),
            absorptance: fluxes.absorptance.into(),
            radiance: args.radiance.iter().enumerate().map(radiance).collect(),
            samples: fluxes.samples,
            seconds,
        }
    }
}

/// The answer for people.
fn table(args: &Args, fluxes: &LayerFluxes, seconds: f64) -> String {
    let mut text = format!(
        "reflectance     {}   of the light comes back{}\n\
         transmittance   {}   gets through\n\
         \u{20} unscattered   {}   ... without a scattering\n\
         absorptance     {}   is absorbed\n",
        with_error(fluxes.reflectance),
        if args.n == 1.0 { "" } else { ", what the upper face reflects included" },
        with_error(fluxes.transmittance),
        with_error(fluxes.unscattered),
        with_error(fluxes.absorptance),
    );
    if !args.radiance.is_empty() {
        text += "\nradiance in 1/sr, per irradiance across the light; of scattered light alone\n";
        text += "mu        at the top              at the bottom\n";
        for (number, mu) in args.radiance.iter().enumerate() {
            let below = fluxes.radiance.get(args.radiance.len() + number);
            let below = below.map_or_else(String::new, |&estimate| with_error(estimate));
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{mu:<9} {:<23} {below}", with_error(fluxes.radiance[number]));
        }
    }
    let _ = writeln!(
        text,
        "\n+- is the standard error: twice as much either way holds the true value in 95 of 100 cases.\n\
         {} photons, {seconds:.1} s",
        fluxes.samples
    );
    text
}

fn parse_tau(text: &str) -> Result<f64, &'static str> {
    slab_input::TAU.parse(text)
}

fn parse_fraction(text: &str) -> Result<f64, &'static str> {
    slab_input::ALBEDO.parse(text)
}

fn parse_g(text: &str) -> Result<f64, &'static str> {
    slab_input::ASYMMETRY.parse(text)
}

fn parse_index(text: &str) -> Result<f64, &'static str> {
    slab_input::REFRACTIVE_INDEX.parse(text)
}

fn parse_mu(text: &str) -> Result<f64, &'static str> {
    slab_input::COSINE.parse(text)
}

fn parse_degrees(text: &str) -> Result<f64, &'static str> {
    slab_input::AZIMUTH.parse(text)
}

fn parse_incidence(text: &str) -> Result<Incidence, &'static str> {
    match text {
        "diffuse" => Ok(Incidence::Diffuse),
        "normal" => slab_input::slanted(0.0),
        _ => slab_input::slanted(slab_input::INCIDENCE.parse(text)?),
    }
}
