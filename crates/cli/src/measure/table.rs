//! A reading for people.

use std::fmt::Write as _;

use tyndall_scene::description::MeterDescription;
use tyndall_session::Reading;
use tyndall_transport::Measurement;
use tyndall_transport::walk::{BodyPowers, LayerFluxes};

use crate::measured::with_error;

/// One reading; columns are left to JSON.
pub fn table(reading: &Reading) -> String {
    let mut text = format!("{}\n", reading.name);
    // Writing to a string cannot fail.
    let _ = match (&reading.measurement, reading.meter) {
        (Measurement::Layer(fluxes), MeterDescription::Layer(meter)) => {
            layer(&mut text, fluxes, &meter.radiance)
        }
        (Measurement::Body(powers), _) => body(&mut text, powers),
        (Measurement::Light(values, _), MeterDescription::Radiance(_)) => {
            writeln!(text, "  radiance (R, G, B)   {}", values.map(with_error).join("  "))
        }
        (Measurement::Light(values, _), _) => {
            writeln!(text, "  irradiance (R, G, B) {}", values.map(with_error).join("  "))
        }
        (Measurement::Layer(_), _) => Ok(()),
    };
    let (samples, seconds) = (reading.measurement.samples(), reading.seconds);
    let _ = writeln!(text, "  {samples} photons, {seconds:.1} s; +- is the standard error\n");
    text
}

fn layer(text: &mut String, fluxes: &LayerFluxes, radiance: &[[f64; 2]]) -> std::fmt::Result {
    writeln!(text, "  reflectance     {}", with_error(fluxes.reflectance))?;
    writeln!(text, "  transmittance   {}", with_error(fluxes.transmittance))?;
    writeln!(text, "    unscattered   {}", with_error(fluxes.unscattered))?;
    writeln!(text, "  absorptance     {}", with_error(fluxes.absorptance))?;
    for ([theta, phi], estimate) in radiance.iter().zip(&fluxes.radiance) {
        writeln!(text, "  radiance        {}  1/sr, theta {theta}, phi {phi}", with_error(*estimate))?;
    }
    if let Some(columns) = &fluxes.columns {
        let [x, z] = columns.shape;
        writeln!(text, "  {x} x {z} columns: with --json")?;
    }
    Ok(())
}

fn body(text: &mut String, powers: &BodyPowers) -> std::fmt::Result {
    writeln!(text, "  absorbed        {}", with_error(powers.absorbed))?;
    writeln!(text, "  unscattered     {}", with_error(powers.unscattered))?;
    writeln!(text, "  scattered       {}", with_error(powers.scattered))?;
    let width = 2.0 / powers.bins.len() as f64;
    for (number, bin) in powers.bins.iter().enumerate() {
        let from = -1.0 + width * number as f64;
        writeln!(text, "    cosine {from:>6.3} to {:>6.3}   {}", from + width, with_error(*bin))?;
    }
    Ok(())
}
