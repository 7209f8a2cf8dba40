//! Light among surfaces: furnaces, Fresnel slabs, the agreement of the integrators, volumes as lights, and same bits.
//!
//! With `TYNDALL_PROOF=full` in the environment every estimate takes ten times as many samples.

mod agreement;
mod estimators;
mod fresnel_slabs;
mod furnace;
mod homogeneous;
mod same_bits;
mod volume_lights;

use glam::DVec3;
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;

use crate::agreement::{Batches, assert_same_batches};
use crate::chromatic::chromatic;

/// Factor on the numbers of samples.
fn effort() -> u64 {
    if crate::effort::is_full() { 10 } else { 1 }
}

/// The scene for each of the three integrators. That for the spectral one has extinction that is `factors` times as great
/// in red, green and blue; whoever renders it, it is the spectral one.
fn for_all_integrators(scene: &Scene, factors: DVec3) -> [(&'static str, Scene, Integrator); 3] {
    let spectral = chromatic(scene.clone(), factors, None);
    assert!(spectral.is_spectral(), "a scene without media has no spectral twin");
    [
        ("reference", scene.clone(), Integrator::Reference),
        ("fast", scene.clone(), Integrator::Fast),
        ("spectral", spectral, Integrator::Reference),
    ]
}

/// Fails if any region of any quantity differs significantly, or the mean of any over the whole picture, in which a small
/// error shows that is hidden in the noise of each region.
fn assert_same_pictures(name: &str, integrators: [Integrator; 2], pair: &[Batches; 2]) {
    assert_same_batches(name, integrators, pair);
    let wholes = [0, 1].map(|i| whole(&pair[i]));
    assert_same_batches(&format!("{name}, on the whole"), integrators, &wholes);
}

/// Mean of each quantity over all regions, which stand beside each other.
pub fn whole(batches: &Batches) -> Batches {
    let layer = |name: &str| name.split(" at").next().unwrap_or_default().to_owned();
    let regions = batches.chunk_by(|(a, _), (b, _)| layer(a) == layer(b));
    regions
        .map(|regions| {
            let (name, first) = &regions[0];
            let mean =
                |i: usize| regions.iter().map(|(_, values)| values[i]).sum::<f64>() / regions.len() as f64;
            (layer(name), (0..first.len()).map(mean).collect())
        })
        .collect()
}

/// Materials that absorb nothing, and two that do.
pub const MATERIALS: &str = r#"
    [[material]]
    name = "white"
    type = "diffuse"
    reflectance = 1
    [[material]]
    name = "grey"
    type = "diffuse"
    reflectance = 0.5
    [[material]]
    name = "chequered"
    type = "diffuse"
    reflectance = { checker = [[0.8, 0.6, 0.4], [0.1, 0.2, 0.3]], scale = [3, 2] }
    [[material]]
    name = "mirror"
    type = "conductor"
    reflectance = 1
    [[material]]
    name = "glass"
    type = "dielectric"
    index = 1.5
    [[material]]
    name = "pane"
    type = "thin_dielectric"
    index = 1.5
    [[material]]
    name = "none"
    type = "null"
    [[material]]
    name = "lattice"
    type = "mix"
    materials = ["none", "white"]
    amount = { checker = [0.3, 0.9], scale = [3, 4] }
    "#;
