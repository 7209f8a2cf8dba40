//! Readings in JSON: `{"meters": {name: …}}`, and the keys of a single layer at the top as well.

use serde_json::{Map, Value as Json, json};
use tyndall_scene::description::MeterDescription;
use tyndall_transport::Measurement;
use tyndall_transport::walk::{BodyPowers, Estimate, LayerFluxes};

use crate::Reading;

/// All readings, by name.
pub fn readings_report(readings: &[Reading]) -> Json {
    let mut root = Map::new();
    if let [Reading { measurement: Measurement::Layer(_), .. }] = readings {
        root = of_one(&readings[0]);
    }
    let meters: Map<String, Json> =
        readings.iter().map(|reading| (reading.name.clone(), Json::Object(of_one(reading)))).collect();
    root.insert("meters".into(), Json::Object(meters));
    Json::Object(root)
}

fn of_one(reading: &Reading) -> Map<String, Json> {
    let mut object = Map::new();
    match &reading.measurement {
        Measurement::Layer(fluxes) => layer(&mut object, reading.meter, fluxes),
        Measurement::Body(powers) => body(&mut object, powers),
        Measurement::Light(values, _) => {
            let key = if matches!(reading.meter, MeterDescription::Radiance(_)) {
                "radiance"
            } else {
                "irradiance"
            };
            object.insert(key.into(), several(values));
        }
    }
    if !reading.doubts.is_empty() {
        object.insert("warnings".into(), reading.doubts.as_slice().into());
    }
    object.insert("samples".into(), reading.measurement.samples().into());
    object.insert("seconds".into(), reading.seconds.into());
    object
}

fn layer(object: &mut Map<String, Json>, meter: &MeterDescription, fluxes: &LayerFluxes) {
    for (key, estimate) in [
        ("reflectance", fluxes.reflectance),
        ("transmittance", fluxes.transmittance),
        ("unscattered", fluxes.unscattered),
        ("absorptance", fluxes.absorptance),
    ] {
        object.insert(key.into(), one(estimate));
    }
    let MeterDescription::Layer(meter) = meter else { return };
    let views = meter.radiance.iter().zip(&fluxes.radiance).enumerate();
    let radiance: Vec<Json> = views
        .map(|(number, ([theta, phi], &estimate))| {
            let mut view = one(estimate);
            view["theta"] = (*theta).into();
            view["phi"] = (*phi).into();
            if let Some(columns) = &fluxes.columns {
                view["columns"] = several(&columns.radiance[number]);
            }
            view
        })
        .collect();
    if !radiance.is_empty() {
        object.insert("radiance".into(), Json::Array(radiance));
    }
    if let Some(columns) = &fluxes.columns {
        let columns = json!({
            "shape": columns.shape,
            "reflectance": several(&columns.reflectance),
            "transmittance": several(&columns.transmittance),
            "absorptance": several(&columns.absorptance),
        });
        object.insert("columns".into(), columns);
    }
}

fn body(object: &mut Map<String, Json>, powers: &BodyPowers) {
    object.insert("absorbed".into(), one(powers.absorbed));
    object.insert("unscattered".into(), one(powers.unscattered));
    object.insert("scattered".into(), one(powers.scattered));
    object.insert("bins".into(), several(&powers.bins));
}

fn one(estimate: Estimate) -> Json {
    json!({ "mean": estimate.mean, "standard_error": estimate.standard_error })
}

/// Means and standard errors as two lists.
fn several(estimates: &[Estimate]) -> Json {
    let means: Vec<f64> = estimates.iter().map(|estimate| estimate.mean).collect();
    let errors: Vec<f64> = estimates.iter().map(|estimate| estimate.standard_error).collect();
    json!({ "mean": means, "standard_error": errors })
}
