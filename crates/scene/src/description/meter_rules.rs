//! What must hold between the keys of a meter.

use glam::DVec3;

use super::meter::{GREATEST_COLUMNS, LEAST_COSINE};
use super::rules::Findings;
use super::{LayerMeterDescription, MeterDescription};

/// Reports what is wrong with each meter.
pub(super) fn meters(found: &mut Findings, meters: &[MeterDescription]) {
    for (index, description) in meters.iter().enumerate() {
        let same_name =
            |other: &MeterDescription| other.name().is_some() && other.name() == description.name();
        let is_repeated = meters[..index].iter().any(same_name);
        found.within("meter", |found| {
            found.within(&index.to_string(), |found| {
                if is_repeated {
                    found.report("name", "two meters have this `name`: give each its own");
                }
                meter(found, description);
            });
        });
    }
}

fn meter(found: &mut Findings, meter: &MeterDescription) {
    match meter {
        MeterDescription::Layer(meter) => layer(found, meter),
        MeterDescription::Body(meter) => found.report_zero("direction", meter.direction),
        MeterDescription::Irradiance(meter) => found.report_zero("normal", meter.normal),
        MeterDescription::Radiance(meter) => found.report_zero("direction", meter.direction),
    }
}

fn layer(found: &mut Findings, meter: &LayerMeterDescription) {
    if meter.bottom >= meter.top {
        found.report("top", "the layer is empty: `bottom` must be less than `top`");
    }
    if let Some(direction) = meter.direction {
        let is_steep = DVec3::from_array(direction).try_normalize().is_some_and(|way| way.y <= -LEAST_COSINE);
        if !is_steep {
            found.report(
                "direction",
                "light falls on a layer from above: the y of `direction` must be below 0",
            );
        }
    }
    if let Some([x0, z0, x1, z1]) = meter.periodic
        && (x0 >= x1 || z0 >= z1)
    {
        found.report("periodic", "`periodic` is empty: write [x0, z0, x1, z1] with x0 < x1 and z0 < z1");
    }
    match meter.columns {
        Some(_) if meter.periodic.is_none() => {
            found.report("columns", "`columns` are those of a tile: give `periodic`, or remove them");
        }
        Some([x, z]) if u64::from(x) * u64::from(z) > GREATEST_COLUMNS => {
            found.report("columns", format!("at most {GREATEST_COLUMNS} columns are measured at a time"));
        }
        _ => {}
    }
    for [theta, _] in &meter.radiance {
        if !(0.0..=180.0).contains(theta) || libm::cos(theta.to_radians()).abs() < LEAST_COSINE {
            let message = format!(
                "`radiance` has theta = {theta}: write [theta, phi] with theta from 0 to 180 degrees, but not 90, where light \
                 leaves by no face"
            );
            found.report("radiance", message);
        }
    }
}
