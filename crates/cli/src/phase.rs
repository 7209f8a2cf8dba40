//! `tyndall phase`: what a phase function is: values, mean cosine, picture.

mod angles;
mod picture;

use std::io::Write;
use std::path::PathBuf;

use glam::DVec3;
use miette::{IntoDiagnostic, miette};
use serde_json::json;
use tyndall_optics::PhaseFunction;
use tyndall_optics::mie::MieAverage;
use tyndall_scene::{MieSpheres, PhaseCurve};
use tyndall_session::check_writable;

use crate::plot::Kind;
use crate::terminal::{answer, tell};
use angles::Angles;

/// Show phase functions: how light is spread over directions when it is scattered
///
/// The angle is that between the directions in which light travels before and after: 0 is forward. Values are per
/// steradian and integrate to 1 over the sphere; g is the mean cosine.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Phase functions:
  isotropic   rayleigh   hg(g=0.85)   schlick(k=0.8)   cornette-shanks(g=0.6)   draine(g=0.6,alpha=0.5)
  double-hg(g1=0.9,g2=-0.3,weight=0.8)   fog(d=10um)   tabulated(file=cloud.txt)
  sggx(kind=fibre,roughness=0.3,axis=[0,1,0])   sggx(kind=surface,roughness=0.3)
  mie(m=1.33+1e-5i,x=10)   mie(material=water,wavelength=550nm,distribution=gamma(r_eff=10um,v_eff=0.1))
  mie:water:10um:gamma(0.1)   (also single, log_normal, modified_gamma, power_law; ice, soot, dust, sea_salt, sulfate)

Examples:
  tyndall phase hg:0.85
  tyndall phase 'fog(d=10um)' hg:0.85 -o fog.svg
  tyndall phase rayleigh --json --angles 0,5,...,180
  tyndall phase 'sggx(kind=fibre,roughness=0.2)' --incidence 1,1,0")]
pub struct Args {
    /// Phase functions such as hg(g=0.85)
    #[arg(required = true, value_name = "SPEC")]
    specs: Vec<String>,
    /// Answer in JSON: an object for each SPEC, in an array if there are several
    #[arg(long)]
    json: bool,
    /// Angles in degrees, such as 0,30,90 or 0,5,...,180
    #[arg(long, default_value = "0,1,...,180", hide_default_value = true, value_name = "LIST")]
    angles: Angles,
    /// Draw the phase functions
    #[arg(short, long, value_name = "FILE.svg", value_parser = svg_file)]
    output: Option<PathBuf>,
    /// Radius of the polar diagram
    #[arg(long, default_value = "log", value_name = "SCALE")]
    radius: Radius,
    /// Direction in which light arrives at oriented particles (their axis unless given); values are then means over
    /// the azimuth
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    incidence: Option<DVec3>,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Radius {
    Log,
    Linear,
}

/// Computes, draws, prints.
pub fn run(args: Args) -> miette::Result<()> {
    check_writable(args.output.as_deref())?;
    let curves =
        args.specs.iter().map(|spec| read(spec, args.incidence)).collect::<miette::Result<Vec<_>>>()?;
    if args.incidence.is_some() && curves.iter().all(|curve| curve.projected_area().is_none()) {
        return Err(miette!(
            "--incidence: none of the phase functions depends on it; leave it out, or give an sggx"
        ));
    }
    if let Some(path) = &args.output {
        let kind = match args.radius {
            Radius::Log => Kind::Log,
            Radius::Linear => Kind::Linear,
        };
        let svg = picture::draw(&curves, kind);
        tyndall_film::write_atomically(path, |file| file.write_all(svg.as_bytes())).into_diagnostic()?;
    }
    if args.json {
        let mut objects: Vec<_> = curves.iter().map(|curve| object(curve, &args.angles.0)).collect();
        let value = if objects.len() == 1 { objects.swap_remove(0) } else { json!(objects) };
        return answer(format!("{value}\n"));
    }
    answer(table(&curves, &args.angles.0))
}

fn read(spec: &str, incidence: Option<DVec3>) -> miette::Result<PhaseCurve> {
    let (curve, note) = PhaseCurve::read(spec, incidence)?;
    if let Some(note) = note {
        tell(format!("note: {note}"));
    }
    Ok(curve)
}

/// The phase function of a one-line description; files it names are relative to the working folder.
pub fn phase_function(spec: &str) -> miette::Result<PhaseFunction> {
    read(spec, None).map(|curve| curve.phase_function().clone())
}

fn object(curve: &PhaseCurve, angles: &[f64]) -> serde_json::Value {
    let values: Vec<f64> = angles.iter().map(|angle| curve.value(*angle)).collect();
    let mut object =
        json!({ "phase": curve.name(), "g": curve.mean_cosine(), "angles_deg": angles, "values": values });
    if let Some(area) = curve.projected_area() {
        object["projected_area"] = area.into();
    }
    if let Some(MieSpheres { average, single }) = curve.spheres() {
        object["q_ext"] = average.q_ext.into();
        object["q_sca"] = average.q_sca.into();
        object["albedo"] = average.albedo().into();
        if let Some(sphere) = single {
            object["q_back"] = sphere.q_back.into();
        }
    }
    object
}

fn table(curves: &[PhaseCurve], angles: &[f64]) -> String {
    let width = |curve: &PhaseCurve| curve.name().chars().count().max(12) + 2;
    let line = |name: &str, cell: &dyn Fn(&PhaseCurve) -> String| {
        let cells: String = curves.iter().map(|curve| format!("{:>1$}", cell(curve), width(curve))).collect();
        format!("{name:<10}{cells}\n")
    };
    let mut text = line("", &|curve| curve.name().to_owned());
    text += &line("g", &|curve| format!("{:.6}", curve.mean_cosine()));
    if curves.iter().any(|curve| curve.projected_area().is_some()) {
        text += &line("area", &|curve| format!("{:.6}", curve.projected_area().unwrap_or(1.0)));
    }
    let efficiency = |average: &MieAverage, of_scattering: bool| {
        if of_scattering { average.q_sca } else { average.q_ext }
    };
    for (name, of_scattering) in [("q_ext", false), ("q_sca", true)] {
        if curves.iter().any(|curve| curve.spheres().is_some()) {
            text += &line(name, &|curve| {
                curve.spheres().map_or("-".into(), |spheres| {
                    format!("{:.6}", efficiency(&spheres.average, of_scattering))
                })
            });
        }
    }
    text += "angle/deg  value/(1/sr)\n";
    for angle in angles {
        text += &line(&angle.to_string(), &|curve| format!("{:.6e}", curve.value(*angle)));
    }
    text
}

fn svg_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_svg = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if is_svg { Ok(path) } else { Err("the name must end in .svg".into()) }
}

fn direction(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let vector = numbers.and_then(|numbers| <[f64; 3]>::try_from(numbers).ok()).map(DVec3::from_array);
    let unit = vector.and_then(DVec3::try_normalize);
    unit.ok_or("write three numbers, not all 0, such as 0,1,0".into())
}
