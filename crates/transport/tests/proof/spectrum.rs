//! Light of all wavelengths: the pictures that the standard observer sees, and bands of single wavelengths.

use glam::DVec3;
use tyndall_optics::cie;
use tyndall_scene::Observer;
use tyndall_scene::description::Integrator;

use crate::agreement::{assert_same_batches, batches};
use crate::chromatic::{BATCHES, crowd};
use crate::rendering::{BOTH, render};
use crate::scenes::scene;
use crate::statistics::two_sided_quantile;

/// Where media are grey, and only light has colours, wavelengths change nothing.
#[test]
fn grey_media_look_the_same_in_rgb_and_by_wavelengths() {
    let mut grey = crowd();
    for (volume, albedo) in grey.volumes.iter_mut().zip([0.8, 0.9, 1.0, 0.5]) {
        // Without spectra, the medium is at each wavelength what its colours are.
        volume.medium.albedo = DVec3::splat(albedo);
        volume.medium.spectra = None;
    }
    let mut spectral = grey.clone();
    spectral.observer = Observer::SpectralRgb;
    let pair = [
        batches(&grey, Integrator::Reference, 54, BATCHES),
        batches(&spectral, Integrator::Fast, 53, BATCHES),
    ];
    assert_same_batches("by wavelengths", [Integrator::Reference, Integrator::Fast], &pair);
}

/// Black bodies seen through nothing, of luminance 1, against their colours in `optics/tests/truth/emission.json`, the
/// greatest |z| of all at a level of 1e-3. Colours outside the gamut have negative channels in a spectral picture.
#[test]
fn black_bodies_have_the_colours_that_planck_and_the_observer_give_them() {
    let truth: serde_json::Value =
        serde_json::from_str(include_str!("../../../optics/tests/truth/emission.json")).expect("JSON");
    let rows = truth["blackbody_colour"].as_array().expect("rows");
    let limit = two_sided_quantile(1e-3 / (3 * rows.len()) as f64);
    for row in rows {
        let kelvin = &row[0];
        let sky = scene(&format!(
            "camera = {{ position = [0, 0, 3], target = [0, 0, 0] }}
             film = {{ resolution = [16, 16] }}
             render = {{ mode = \"spectral\" }}
             [[light]]
             type = \"constant\"
             radiance = {{ blackbody = {kelvin} }}"
        ));
        let film = render(&sky, Integrator::Fast, 1, 0..64);
        for (column, estimate) in (4..7).zip(film.image_mean()) {
            let truth = row[column].as_f64().expect("a number");
            let z = (estimate.mean - truth) / estimate.standard_error;
            assert!(z.abs() < limit, "{kelvin} K: {estimate:?}, not {truth}, z = {z}");
            assert!(estimate.standard_error < 0.03, "{kelvin} K: {estimate:?} says nothing");
        }
    }
}

/// Rayleigh's λ⁻⁴ in bands: what comes straight through a slab is exp(−τ(λ)) of the light behind it, whether the slab
/// absorbs or scatters. Each band is at a level of 1e-4.
#[test]
fn bands_of_a_rayleigh_slab_have_the_transmittance_of_their_wavelengths() {
    let bands = [450.0, 532.0, 680.0];
    for albedo in [0, 1] {
        let slab = scene(&format!(
            "camera = {{ position = [0, 0, 3], target = [0, 0, 0], vertical_fov = 1e-6 }}
             film = {{ resolution = [8, 8], bands = {bands:?} }}
             render = {{ mode = \"spectral\", max_depth = 0 }}
             [[light]]
             type = \"constant\"
             radiance = {{ wavelengths = [400, 800], values = [1, 5] }}
             [[volume]]
             box = {{ min = [-9, -9, -1], max = [9, 9, 1] }}
             mu_t = {{ power_law = -4, at = 550, value = 0.5 }}
             albedo = {albedo}"
        ));
        for integrator in BOTH {
            let film = render(&slab, integrator, 3, 0..1024);
            for (band, estimate) in bands.into_iter().zip(film.image_mean()) {
                let light: f64 = 1.0 + (band - 400.0) / 100.0;
                let truth = light * (-2.0 * 0.5 * (band / 550.0_f64).powi(-4)).exp();
                // The fast one knows this in closed form, to the digits of f32.
                let z = (estimate.mean - truth) / estimate.standard_error.max(1e-6 * truth);
                assert!(z.abs() < two_sided_quantile(1e-4), "{band} nm: {estimate:?}, not {truth}, z = {z}");
                assert!(estimate.standard_error < 0.01 * truth, "{estimate:?} says nothing");
            }
        }
    }
}

/// A single scattering has the shape of the phase function and the strength of the scattering coefficient at each
/// wavelength: the light of thin air is that of its λ⁻⁴ in colour, by the sum over all wavelengths.
#[test]
fn thin_air_under_the_sun_has_the_colour_of_its_spectrum() {
    let thickness = 1e-3;
    let air = scene(
        "camera = { position = [0, 0, 3], target = [0, 0, 0], vertical_fov = 1e-6 }
         film = { resolution = [16, 16] }
         render = { mode = \"spectral\", max_depth = 1 }
         [[light]]
         type = \"distant\"
         direction = [0, -1, 0]
         irradiance = 1000
         [[volume]]
         box = { min = [-1e-3, -1e-3, -1], max = [1e-3, 1e-3, 1] }
         mu_s = { power_law = -4, at = 550, value = 0.5 }
         mu_a = 0
         phase = { type = \"rayleigh\" }",
    );
    let film = render(&air, Integrator::Fast, 4, 0..256);
    let phase = 3.0 / (16.0 * std::f64::consts::PI);
    let source = |nm: f64| {
        // Collisions along the 2 units of depth; the way out to the light is a thousandth.
        let mu_s = 0.5 * (nm / 550.0).powi(-4);
        1000.0 * cie::white(nm) * phase * (1.0 - (-2.0 * mu_s).exp()) * (-mu_s * thickness).exp()
    };
    let truth = cie::xyz_to_rgb(cie::xyz(source));
    for (estimate, truth) in film.image_mean().iter().zip(truth.to_array()) {
        let z = (estimate.mean - truth) / estimate.standard_error;
        assert!(z.abs() < two_sided_quantile(1e-4), "{estimate:?}, not {truth}, z = {z}");
        assert!(estimate.standard_error < 0.01 * truth, "{estimate:?} says nothing");
    }
}

/// Light given in RGB keeps its colour, in RGB and in XYZ.
#[test]
fn light_given_in_rgb_keeps_its_colour() {
    let mut sky = scene(
        "camera = { position = [0, 0, 3], target = [0, 0, 0] }
         film = { resolution = [8, 8] }
         [[light]]
         type = \"constant\"
         radiance = [0.2, 0.5, 0.9]",
    );
    let rgb = DVec3::new(0.2, 0.5, 0.9);
    for (observer, truth) in [(Observer::SpectralRgb, rgb), (Observer::SpectralXyz, cie::rgb_to_xyz(rgb))] {
        sky.observer = observer;
        let film = render(&sky, Integrator::Fast, 1, 0..256);
        for (estimate, truth) in film.image_mean().iter().zip(truth.to_array()) {
            let z = (estimate.mean - truth) / estimate.standard_error;
            assert!(z.abs() < two_sided_quantile(1e-4), "{observer:?}: {estimate:?}, not {truth}");
            assert!(estimate.standard_error < 0.01, "{estimate:?} says nothing");
        }
    }
}
