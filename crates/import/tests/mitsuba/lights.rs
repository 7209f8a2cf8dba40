//! Emitters and the spectra of light.

use glam::DVec3;
use tyndall_import::NoteKind;
use tyndall_scene::description::{LightDescription, SpectrumDescription, SpotFalloff};
use tyndall_scene::light::uv_to_direction;

use crate::support::*;

fn light(content: &str) -> LightDescription {
    let imported = import(content);
    assert_silent(&imported);
    imported.description.lights[0].clone()
}

fn radiance(content: &str) -> SpectrumDescription {
    let LightDescription::Constant(constant) =
        light(&format!("<emitter type=\"constant\">{content}</emitter>"))
    else {
        panic!()
    };
    constant.radiance
}

#[test]
fn points_and_directions_may_come_from_a_transform() {
    let moved =
        r#"<transform name="to_world"><rotate y="1" angle="90"/><translate x="1" y="2" z="3"/></transform>"#;
    let LightDescription::Point(point) = light(&format!("<emitter type=\"point\">{moved}</emitter>")) else {
        panic!()
    };
    assert_eq!((point.position, point.intensity), ([1.0, 2.0, 3.0], 1.0.into()));
    let LightDescription::Distant(sun) = light(&format!("<emitter type=\"directional\">{moved}</emitter>"))
    else {
        panic!()
    };
    assert!(near(sun.direction, [1.0, 0.0, 0.0]));
}

#[test]
fn a_spot_falls_off_linearly_from_three_quarters_of_its_angle() {
    let LightDescription::Spot(spot) = light(
        r#"<emitter type="spot"><rgb name="intensity" value="1,2,3"/><float name="cutoff_angle" value="40"/>
           <transform name="to_world"><lookat origin="0,5,0" target="0,0,0" up="1,0,0"/></transform></emitter>"#,
    ) else {
        panic!()
    };
    assert_eq!((spot.angle, spot.inner_angle, spot.falloff), (40.0, 30.0, SpotFalloff::Linear));
    assert_eq!(spot.position, [0.0, 5.0, 0.0]);
    assert!(near(spot.direction, [0.0, -1.0, 0.0]));
}

#[test]
fn numbers_are_white_and_spectra_are_spectra() {
    assert_eq!(radiance("<float name=\"radiance\" value=\"2\"/>"), 2.0.into());
    assert_eq!(radiance("<rgb name=\"radiance\" value=\"1,2,3\"/>"), [1.0, 2.0, 3.0].into());
    assert_eq!(
        radiance(r#"<spectrum type="d65" name="radiance"><float name="scale" value="3"/></spectrum>"#),
        3.0.into()
    );
    // The same at all wavelengths is the white of equal energy, which is reddish beside D65.
    let flat = radiance("<spectrum name=\"radiance\" value=\"1\"/>").light().unwrap().light_rgb();
    assert!((flat - DVec3::new(1.2048, 0.9483, 0.9089)).abs().max_element() < 2e-3, "{flat}");
    let green = radiance("<spectrum name=\"radiance\" value=\"530:1, 560:1\"/>").light().unwrap();
    assert!((green.at(545.0) - 1.0).abs() < 1e-12);
    assert_eq!([green.at(500.0), green.at(600.0)], [0.0, 0.0]);
    let body = radiance(
        r#"<spectrum type="blackbody" name="radiance"><float name="temperature" value="3000"/></spectrum>"#,
    );
    let SpectrumDescription::Table(table) = body else { panic!() };
    assert_eq!((table.blackbody, table.scale), (Some(3000.0), Some(1.0)));
    let list = radiance(
        r#"<spectrum type="regular" name="radiance"><float name="wavelength_min" value="360"/>
           <float name="wavelength_max" value="830"/><string name="values" value="1, 2"/></spectrum>"#,
    );
    assert!((list.light().unwrap().at(595.0) - 1.5).abs() < 1e-12);
}

#[test]
fn a_spectrum_may_stand_in_a_file() {
    let scene = format!(
        "<scene version=\"3.0.0\"><emitter type=\"constant\"><spectrum name=\"radiance\" filename=\"lamp.spd\"/></emitter>{SENSOR}</scene>"
    );
    let folder = Folder::with(&[("scene.xml", scene.as_bytes()), ("lamp.spd", b"# a lamp\n300 1\n900 3\n")]);
    let LightDescription::Constant(constant) = &folder.import().description.lights[0] else { panic!() };
    assert!((constant.radiance.light().unwrap().at(600.0) - 2.0).abs() < 1e-12);
}

/// Mitsuba looks up a direction at u = atan2(x, −z)/2π, from the left edge.
#[test]
fn surroundings_keep_their_directions() {
    let turn = |content: &str| {
        let scene = format!(
            "<scene version=\"3.0.0\"><emitter type=\"envmap\"><string name=\"filename\" value=\"sky.exr\"/>\
             <transform name=\"to_world\">{content}</transform></emitter>{SENSOR}</scene>"
        );
        let folder = Folder::with(&[("scene.xml", scene.as_bytes()), ("sky.exr", b"never read")]);
        let LightDescription::Image(image) = folder.import().description.lights[0].clone() else { panic!() };
        image
    };
    let plain = turn("");
    assert_eq!((plain.rotation, plain.orientation), (180.0, None));
    assert_eq!(turn("<rotate y=\"1\" angle=\"90\"/>").rotation, -90.0);
    let tilted = turn("<rotate x=\"1\" angle=\"90\"/><scale value=\"5\"/>");
    assert_eq!(tilted.rotation, 0.0);
    let rows = tilted.orientation.unwrap();
    let to_scene =
        |v: DVec3| DVec3::from_array(std::array::from_fn(|row| v.dot(DVec3::from_slice(&rows[3 * row..]))));
    for (u, v) in [(0.1, 0.3), (0.6, 0.8), (0.95, 0.5)] {
        // The direction in Mitsuba of a texel, turned about x by a quarter.
        let (theta, phi) = (std::f64::consts::PI * v, std::f64::consts::TAU * u);
        let local = DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin());
        let expected = DVec3::new(local.x, -local.z, local.y);
        let found = to_scene(uv_to_direction(u, v));
        assert!((found - expected).length() < 1e-12, "{u} {v}: {found} and not {expected}");
    }
}

#[test]
fn the_sky_is_told_to_be_another() {
    let imported = import(
        r#"<emitter type="sunsky"><vector name="sun_direction" x="0" y="0.5" z="1"/><float name="turbidity" value="4"/>
           <transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>"#,
    );
    let LightDescription::Sky(sky) = &imported.description.lights[0] else { panic!() };
    assert!(near(sky.toward_sun().to_array(), DVec3::new(0.0, 1.0, -0.5).normalize().to_array()));
    assert_eq!((sky.turbidity, sky.sun), (4.0, true));
    let said = messages(&imported, NoteKind::Unsupported);
    assert!(said.len() == 1 && said[0].contains("another brightness"), "{said:?}");
}
