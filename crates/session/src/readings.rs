//! The meters of a scene, read one after the other.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use tyndall_scene::Scene;
use tyndall_scene::description::{MeterDescription, SceneDescription};
use tyndall_transport::walk::WalkOptions;
use tyndall_transport::{Measurement, measure};

use crate::SessionError;

/// What one meter has measured.
#[derive(Debug, Clone)]
pub struct Reading<'a> {
    /// Its name, or `meter.` and its number.
    pub name: String,
    /// The meter.
    pub meter: &'a MeterDescription,
    /// What it has measured.
    pub measurement: Measurement,
    /// One line for each reason to doubt its standard errors.
    pub doubts: Vec<String>,
    /// Time that it took.
    pub seconds: f64,
}

/// Reads the meters of the scene `name`, each with the `options` of its number, until `cancel` is set; a reading that has
/// no sample then is left out.
///
/// # Errors
/// If the scene has no meters, or is not one that a meter can measure.
pub fn read_meters<'a>(
    name: &str,
    description: &'a SceneDescription,
    scene: &Scene,
    options: impl Fn(u64) -> WalkOptions,
    cancel: &AtomicBool,
) -> Result<Vec<Reading<'a>>, SessionError> {
    if description.meters.is_empty() {
        let mend = "has no meters; add a [[meter]] table, such as type = \"layer\" with bottom and top";
        return Err(SessionError::refuse(name, mend));
    }
    let mut readings = Vec::new();
    for (number, meter) in (0..).zip(&description.meters) {
        let called = meter.name().map_or_else(|| format!("meter.{number}"), str::to_owned);
        let start = Instant::now();
        let (measurement, doubts) = measure(scene, meter, &options(number), cancel)
            .map_err(|problem| SessionError::refuse(name, format!("[[meter]] `{called}`: {problem}")))?;
        if measurement.samples() == 0 {
            break;
        }
        readings.push(Reading {
            name: called,
            meter,
            measurement,
            doubts,
            seconds: start.elapsed().as_secs_f64(),
        });
    }
    Ok(readings)
}
