//! Light of all wavelengths: the pictures that the standard observer sees, and bands of single wavelengths.

use glam::DVec3;
use tyndall_scene::Observer;
use tyndall_scene::description::Integrator;

use crate::agreement::{assert_same_batches, batches};
use crate::chromatic::{BATCHES, crowd};
use crate::rendering::render;
use crate::scenes::scene;
use crate::statistics::two_sided_quantile;

/// Where media are grey, and only light has colours, wavelengths change nothing.
#[test]
fn grey_media_look_the_same_in_rgb_and_by_wavelengths() {
    let mut grey = crowd();
    for (volume, albedo) in grey.volumes.iter_mut().zip([0.8, 0.9, 1.0, 0.5]) {
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

/// One wavelength of light of red, green and blue: white that is multiplied by them at that wavelength.
#[test]
fn xyz_is_the_matrix_of_rgb() {
    let mut sky = scene(
        "camera = { position = [0, 0, 3], target = [0, 0, 0] }
         film = { resolution = [8, 8] }
         [[light]]
         type = \"constant\"
         radiance = [0.2, 0.5, 0.9]",
    );
    let rgb = DVec3::new(0.2, 0.5, 0.9);
    for (observer, truth) in
        [(Observer::SpectralRgb, rgb), (Observer::SpectralXyz, tyndall_optics::cie::rgb_to_xyz(rgb))]
    {
        sky.observer = observer;
        let film = render(&sky, Integrator::Fast, 1, 0..256);
        for (estimate, truth) in film.image_mean().iter().zip(truth.to_array()) {
            let z = (estimate.mean - truth) / estimate.standard_error;
            assert!(z.abs() < two_sided_quantile(1e-4), "{observer:?}: {estimate:?}, not {truth}");
            assert!(estimate.standard_error < 0.01, "{estimate:?} says nothing");
        }
    }
}
