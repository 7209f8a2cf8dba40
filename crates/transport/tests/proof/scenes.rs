//! Scenes from the text of a scene file, and what tests put into them that no file can say.

use std::path::Path;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::description::ImageFilter;
use tyndall_scene::light::{ImageLight, LightImage};
use tyndall_scene::{Light, Scene, SceneDocument};

/// The scene of a scene file's text; files it names are in `folder`.
pub fn scene_in(folder: &Path, text: &str) -> Scene {
    let description = SceneDocument::parse("test scene", text).and_then(|document| document.description());
    let description = description.unwrap_or_else(|error| panic!("{error:?}\n{text}"));
    let built = tyndall_scene::build(&description, folder);
    built.unwrap_or_else(|error| panic!("{error:?}\n{text}")).scene
}

/// The scene of a scene file's text that names no files.
pub fn scene(text: &str) -> Scene {
    scene_in(Path::new(""), text)
}

/// The same scene with next-event estimation towards its lights in these proportions, wanted or not.
pub fn with_next_event(mut scene: Scene, probabilities: &[f64]) -> Scene {
    assert_eq!(scene.lights.len(), probabilities.len());
    scene.set_light_probabilities(probabilities.to_vec());
    scene
}

/// Surroundings of `upper` radiance over `lower`, with the step at the horizon.
pub fn two_halves(upper: [f32; 3], lower: [f32; 3]) -> Light {
    let texels = [[upper; 4], [lower; 4]].concat();
    image(texels, ImageFilter::Nearest)
}

/// An image light of 4x2 texels.
pub fn image(texels: Vec<[f32; 3]>, filter: ImageFilter) -> Light {
    let image = LightImage::new(4, 2, texels).expect("8 texels are a picture of 4x2");
    Light::Image(ImageLight::new(image, filter, 1.0, 0.0))
}

/// Writes a NumPy array of single floats whose element (i, j, k) is `value([i, j, k])`.
pub fn write_npy(path: &Path, shape: [usize; 3], mut value: impl FnMut([usize; 3]) -> f32) {
    let [nx, ny, nz] = shape;
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({nx}, {ny}, {nz}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    for i in 0..nx {
        for j in 0..ny {
            for k in 0..nz {
                bytes.extend(value([i, j, k]).to_le_bytes());
            }
        }
    }
    std::fs::write(path, bytes).expect("the folder for test files can be written to");
}

/// Writes an array of independent uniform values in [0, 1): as rough a field as a grid can hold.
pub fn write_random_npy(path: &Path, shape: [usize; 3], seed: u64) {
    let mut random = Random::new(seed, 0, 0);
    write_npy(path, shape, |_| random.f32());
}

/// Uniform over the sphere.
pub fn random_direction(random: &mut Random) -> DVec3 {
    let y = 2.0 * random.f64() - 1.0;
    let (sin, cos) = (std::f64::consts::TAU * random.f64()).sin_cos();
    let across = (1.0 - y * y).sqrt();
    DVec3::new(across * cos, y, across * sin)
}
