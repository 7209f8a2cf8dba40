//! Lights have the values that pbrt's picture shows.

use std::f64::consts::PI;

use tyndall_optics::cie;
use tyndall_scene::description::{ImageMapping, LightDescription, SpectrumDescription};

use crate::{scene_with, world};

fn lights(text: &str) -> Vec<LightDescription> {
    world(text).imported.description.lights
}

fn radiance(text: &str) -> SpectrumDescription {
    match lights(&format!("LightSource \"infinite\" {text}")).as_slice() {
        [LightDescription::Constant(light)] => light.radiance.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_rgb_is_what_the_picture_shows() {
    assert_eq!(radiance("\"rgb L\" [1 2 3]"), [1.0, 2.0, 3.0].into());
    assert_eq!(radiance("\"rgb L\" [2 2 2] \"float scale\" 3"), 6.0.into());
    assert_eq!(radiance(""), 1.0.into());
    assert_eq!(radiance("\"float illuminance\" 10"), (10.0 / PI).into());
}

#[test]
fn other_spectra_of_light_have_luminance_1_whatever_their_values() {
    for values in ["1 1", "100 100", "0.1 7"] {
        let [low, high]: [&str; 2] = values.split(' ').collect::<Vec<_>>().try_into().unwrap();
        let light = radiance(&format!("\"spectrum L\" [ 300 {low} 900 {high} ] \"float scale\" 2"));
        let spectrum = light.light().unwrap();
        assert!((cie::xyz(|nm| spectrum.at(nm)).y - 2.0).abs() < 1e-9, "{values}: {light:?}");
    }
    let light = radiance("\"blackbody L\" 3000 \"float scale\" 5").light().unwrap();
    assert!((cie::xyz(|nm| light.at(nm)).y - 5.0).abs() < 1e-9);
    assert_eq!(radiance("\"spectrum L\" \"stdillum-D65\" \"float scale\" 4"), 4.0.into());
}

#[test]
fn a_spectrum_is_0_beyond_its_samples() {
    let light = radiance("\"spectrum L\" [ 500 1 600 1 ]").light().unwrap();
    assert_eq!((light.at(499.0), light.at(601.0)), (0.0, 0.0));
    assert!(light.at(500.0) > 0.0 && light.at(500.0) == light.at(600.0));
}

#[test]
fn spectra_are_read_from_files() {
    let file: &[u8] = b"# wavelength value\n400 1\n700 3 # the last\n";
    let text = "WorldBegin LightSource \"point\" \"spectrum I\" \"lamp.spd\"";
    let scene = scene_with(text, &[("lamp.spd", file)]);
    let LightDescription::Point(light) = &scene.imported.description.lights[0] else { panic!() };
    let spectrum = light.intensity.light().unwrap();
    assert!((spectrum.at(700.0) / spectrum.at(400.0) - 3.0).abs() < 1e-9);
}

#[test]
fn power_is_spread_over_all_directions_and_all_parts_of_a_surface() {
    let [LightDescription::Point(point), LightDescription::Spot(spot)] = &lights(
        "LightSource \"point\" \"rgb I\" [1 2 1] \"float power\" 100
         LightSource \"spot\" \"float power\" 10 \"float coneangle\" 60 \"float conedeltaangle\" 60",
    )[..] else {
        panic!()
    };
    let per_angle = 100.0 / (4.0 * PI);
    assert_eq!(point.intensity, [per_angle, 2.0 * per_angle, per_angle].into());
    // From the axis to 60 degrees, where the cosine is 1/2: on average half of 2 π (1 − 1/2).
    let SpectrumDescription::Grey(intensity) = spot.intensity else { panic!() };
    assert!((intensity - 10.0 / (PI / 2.0)).abs() < 1e-9, "{intensity}");
    let lamp = world(
        "AreaLightSource \"diffuse\" \"float power\" 5 \"bool twosided\" true Scale 2 2 2 Shape \"sphere\"",
    );
    let emission = lamp.imported.description.shapes[0].emission.clone().unwrap();
    let SpectrumDescription::Grey(radiance) = emission.radiance else { panic!() };
    assert!((radiance - 5.0 / (2.0 * PI * 16.0 * PI)).abs() < 1e-12 && emission.two_sided, "{radiance}");
}

#[test]
fn lights_stand_where_the_transform_puts_them() {
    let [LightDescription::Distant(distant), LightDescription::Point(point), LightDescription::Spot(spot)] =
        &lights(
            "AttributeBegin Rotate 90 0 1 0
         LightSource \"distant\" \"point3 from\" [0 0 1] \"point3 to\" [0 0 0] \"float illuminance\" 3
         AttributeEnd
         Translate 1 2 3
         LightSource \"point\" \"point3 from\" [1 0 0]
         LightSource \"spot\" \"point3 from\" [0 0 1] \"point3 to\" [0 -5 1] \"float coneangle\" 40",
        )[..]
    else {
        panic!()
    };
    let is_near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    assert!(is_near(distant.direction, [-1.0, 0.0, 0.0]), "{distant:?}");
    assert_eq!(distant.irradiance, 3.0.into());
    assert_eq!(point.position, [2.0, 2.0, 3.0]);
    assert!(is_near(spot.position, [1.0, 2.0, 4.0]) && is_near(spot.direction, [0.0, -1.0, 0.0]), "{spot:?}");
    assert_eq!((spot.angle, spot.inner_angle), (40.0, 35.0));
}

#[test]
fn a_picture_of_the_surroundings_turns_with_the_transform() {
    let text = "WorldBegin Rotate 90 1 0 0 LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 2";
    let scene = scene_with(text, &[("sky.exr", b"not looked into")]);
    let [LightDescription::Image(light)] = scene.imported.description.lights.as_slice() else { panic!() };
    assert_eq!((light.file.as_str(), light.scale), (scene.path("sky.exr").as_str(), 2.0));
    assert_eq!(light.mapping, ImageMapping::EqualArea);
    // Row by row: the picture's +y becomes the world's +z, its +z the world's −y.
    let expected = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0];
    let orientation = light.orientation.unwrap();
    assert!(orientation.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{orientation:?}");
}
