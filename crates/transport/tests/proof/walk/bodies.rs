//! Bodies of finite size in a beam, and the light meters.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use tyndall_scene::SceneDocument;
use tyndall_transport::walk::{BodyPowers, Estimate};
use tyndall_transport::{Measurement, measure};

use super::{Family, options, photons};

/// What the scene's only meter measures.
fn measured(text: &str, seed: u64, photons: u64) -> Measurement {
    let text = format!("camera = {{ position = [0, 0, 9], target = [0, 0, 0] }}\n{text}");
    let description = SceneDocument::parse("bodies", &text).and_then(|document| document.description());
    let description = description.unwrap_or_else(|error| panic!("{error}\n{text}"));
    let scene = tyndall_scene::build(&description, Path::new("")).expect("a scene").scene;
    measure(&scene, &description.meters[0], &options(seed, photons), &AtomicBool::new(false))
        .expect("a meter that fits the scene")
        .0
}

fn body(text: &str, seed: u64, photons: u64) -> BodyPowers {
    match measured(text, seed, photons) {
        Measurement::Body(powers) => powers,
        other => panic!("no body: {other:?}"),
    }
}

#[test]
fn balls_and_cubes_absorb_and_scatter_what_plain_monte_carlo_says() {
    let table: serde_json::Value =
        serde_json::from_str(include_str!("../../truth/ball_and_cube.json")).expect("the table is JSON");
    let n = photons(1 << 15);
    for (seed, row) in table["rows"].as_array().expect("rows").iter().enumerate() {
        let number = |key: &str| row[key].as_f64().expect("a number");
        let (shape, mu_t) = match row["shape"].as_str() {
            Some("ball") => ("sphere = { center = [0.3, 0, 1], radius = 1 }", number("tau")),
            _ => ("box = { min = [-1, -1, 2], max = [1, 1, 4] }", number("tau") / 2.0),
        };
        let powers = body(
            &format!(
                "[[volume]]\n{shape}\nmu_t = {mu_t}\nalbedo = {}\nphase = {{ type = 'hg', g = {} }}\n\
                 [[meter]]\ntype = 'body'\ndirection = [0, 0, 1]",
                number("albedo"),
                number("g")
            ),
            seed as u64,
            n,
        );
        let mut family = Family::default();
        family.add(
            "unscattered".into(),
            number("unscattered_exact"),
            1e-6,
            Estimate {
                standard_error: powers
                    .unscattered
                    .standard_error
                    .max((number("unscattered_exact") / n as f64).sqrt()),
                ..powers.unscattered
            },
        );
        let own_error = (number("absorbed") / number("photons")).sqrt();
        family.add("absorbed".into(), number("absorbed"), own_error, powers.absorbed);
        let list = |key: &str| -> Vec<f64> {
            row[key].as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
        };
        let (bins, errors) = (list("scattered_exit_power_in_20_cos_bins"), list("scattered_power_se"));
        for (number, result) in powers.bins.iter().enumerate() {
            family.add(format!("bin {number}"), bins[number], errors[number], *result);
        }
        family.assert(&format!("{row}"), false);
    }
}

/// The unscattered light of absorbing balls of several sizes in a beam: the closed form of the table.
#[test]
fn a_beam_through_an_absorbing_ball_is_that_of_the_closed_form() {
    let mut family = Family::default();
    for (seed, row) in
        super::rows(include_str!("../../truth/infinite_medium.json"), "ball").iter().enumerate()
    {
        let powers = body(
            &format!(
                "[[volume]]\nsphere = {{ center = [0, 0, 0], radius = {} }}\nmu_t = 1\nalbedo = 0\n\
                 [[meter]]\ntype = 'body'\ndirection = [1, 2, 3]\nbins = 1",
                row[0]
            ),
            seed as u64,
            photons(1 << 15),
        );
        assert_eq!(powers.scattered.mean, 0.0);
        family.add(format!("{row:?}"), row[1], 1e-10, powers.unscattered);
        family.add(format!("absorbed {row:?}"), 1.0 - row[1], 1e-10, powers.absorbed);
    }
    family.assert("absorbing balls", false);
}

/// Under an absorbing slab of optical thickness 1, sun and sky of known radiance: E = E₀ μ₀ e^(−1/μ₀) + π L 2 E₃(1).
#[test]
fn irradiance_under_an_absorbing_layer_is_that_of_the_closed_form() {
    let text = "[[volume]]\nslab = { bottom = 0, top = 2 }\nmu_t = 0.5\nalbedo = 0\n\
                [[light]]\ntype = 'distant'\ndirection = [0.6, -0.8, 0]\nirradiance = 3\n\
                [[light]]\ntype = 'constant'\nradiance = [1, 2, 0]\n\
                [[meter]]\ntype = 'irradiance'\nposition = [5, -1, 5]\nnormal = [0, 1, 0]";
    let Measurement::Light(values, _) = measured(text, 1, photons(1 << 15)) else { panic!("no light") };
    let sun = 3.0 * 0.8 * (-1.0_f64 / 0.8).exp();
    let sky = std::f64::consts::PI * 2.0 * 0.109_691_967;
    let mut family = Family::default();
    for (value, radiance) in values.into_iter().zip([1.0, 2.0, 0.0]) {
        family.add(format!("radiance {radiance}"), sun + radiance * sky, 1e-7, value);
    }
    family.assert("irradiance", false);
}

/// A white furnace: in even light a medium that absorbs nothing cannot be seen, and every irradiance is π.
#[test]
fn meters_in_a_white_furnace_read_its_radiance() {
    let furnace = "[[volume]]\nsphere = { center = [0, 0, 0], radius = 1 }\nmu_t = 3\nalbedo = 1\n\
                   [[light]]\ntype = 'constant'\nradiance = 1\n";
    let mut family = Family::default();
    for (meter, truth) in [
        ("type = 'irradiance'\nposition = [0.2, 0.3, 0]\nnormal = [0, 1, 0]", std::f64::consts::PI),
        ("type = 'irradiance'\nposition = [0, -1.5, 0]\nnormal = [1, 1, 0]", std::f64::consts::PI),
        ("type = 'radiance'\nposition = [0, 0, 0]\ndirection = [0, 0, 1]", 1.0),
    ] {
        let text = format!("{furnace}[[meter]]\n{meter}");
        let Measurement::Light(values, _) = measured(&text, 2, photons(1 << 13)) else { panic!("no light") };
        family.add(meter.into(), truth, 1e-6, values[1]);
    }
    family.assert("white furnace", false);
}
