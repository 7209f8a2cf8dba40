//! Pictures of surfaces, too, are the same to the last bit however the work is shared out.

use glam::DVec3;

use tyndall_film::{Film, Layers};
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;
use tyndall_transport::RenderOptions;

use super::agreement::room;
use super::for_all_integrators;
use super::homogeneous::lamp_in_fog;
use crate::rendering::{add_pass, options};

#[test]
fn threads_and_passes_change_no_bit_among_surfaces() {
    let mut room = room();
    room.max_depth = Some(6);
    for (name, scene, integrator) in for_all_integrators(&room, DVec3::new(1.0, 2.0, 4.0)) {
        assert_same_bits(name, scene, integrator);
    }
    assert_same_bits("fast in homogeneous fog", lamp_in_fog(), Integrator::Fast);
}

fn assert_same_bits(name: &str, mut scene: Scene, integrator: Integrator) {
    // Six blocks of tiles, some of them cut.
    let [width, height] = [150, 90];
    scene.resolution = [width, height];
    let film = |threads, passes: &[[u64; 2]]| {
        let mut film = Film::new(width, height, Layers::ALL).expect("a small picture");
        let options = RenderOptions { threads, ..options(integrator, 7) };
        for &[start, end] in passes {
            add_pass(&scene, &mut film, start..end, options);
        }
        film
    };
    let whole = film(1, &[[0, 3]]);
    // Films are large to print: only whether they are equal is asserted.
    assert!(whole == film(2, &[[0, 3]]), "{name}: 2 threads");
    assert!(whole == film(3, &[[1, 3], [0, 1]]), "{name}: two passes in the other order, 3 threads");
    let mut left = film(1, &[[0, 1]]);
    left.merge(&film(2, &[[1, 3]])).expect("disjoint samples of one picture");
    assert!(whole == left, "{name}: two films merged");
    assert!(whole != film(1, &[[1, 4]]), "{name}: other samples are other pictures");
}
