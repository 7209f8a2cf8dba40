//! Planck's law and the colours of black bodies against `truth/emission.json`, whose tolerances are stated there.

use glam::DVec3;
use tyndall_optics::{Spectrum, cie, planck};

fn rows(table: &str) -> Vec<Vec<f64>> {
    let truth: serde_json::Value =
        serde_json::from_str(include_str!("truth/emission.json")).expect("the table is JSON");
    serde_json::from_value(truth[table].clone()).expect("rows of numbers")
}

#[test]
fn the_radiance_of_black_bodies_is_that_of_the_table() {
    let rows = rows("planck");
    assert!(rows.len() > 50);
    for row in rows {
        let &[kelvin, nm, per_metre] = &row[..] else { panic!("{row:?}") };
        let radiance = planck::radiance(nm, kelvin);
        assert!((radiance * 1e9 / per_metre - 1.0).abs() < 1e-9, "{kelvin} K, {nm} nm: {radiance:e}");
    }
}

#[test]
fn the_colours_of_black_bodies_are_those_of_the_table() {
    let rows = rows("blackbody_colour");
    assert!(rows.len() > 10);
    let colours = planck::BlackbodyColours::new();
    for row in rows {
        let &[kelvin, luminance, x, y, r, g, b, clipped_r, clipped_g, clipped_b] = &row[..] else {
            panic!("{row:?}")
        };
        let xyz = cie::xyz(|nm| planck::radiance(nm, kelvin));
        assert!((xyz.y * cie::LUMINANCE_OF_Y / luminance - 1.0).abs() < 1e-8, "{kelvin} K: {xyz}");
        assert!((planck::luminance(kelvin) / xyz.y - 1.0).abs() < 1e-12);
        let sum = xyz.element_sum();
        assert!((xyz.x / sum - x).abs() < 1e-5 && (xyz.y / sum - y).abs() < 1e-5, "{kelvin} K: {xyz}");
        let of_luminance_one = planck::rgb(kelvin) / xyz.y;
        assert!((of_luminance_one - DVec3::new(r, g, b)).abs().max_element() < 1e-4, "{kelvin} K");

        // In the gamut, as RGB pictures have it: the clipped colour, at the same luminance.
        let clipped = DVec3::new(clipped_r, clipped_g, clipped_b);
        let light = Spectrum::Blackbody { kelvin, scale: 2.0 }.light_rgb();
        assert!((cie::luminance(light) / xyz.y - 2.0).abs() < 1e-12);
        assert!((light / light.max_element() - clipped).abs().max_element() < 1e-4, "{kelvin} K: {light}");
        assert!((colours.at(kelvin) * 2.0 / light.max_element() - clipped).abs().max_element() < 3e-4);
    }
}
