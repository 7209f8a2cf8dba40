//! A picture is the same to the last bit however the work is shared out: among threads, and among passes.

use std::sync::Arc;

use glam::DVec3;
use tyndall_film::{Film, Layers};
use tyndall_scene::description::Sampler;
use tyndall_scene::{ChromaticMedium, Scene};
use tyndall_transport::RenderOptions;

use crate::rendering::{BOTH, add_pass, empty_adaptive, options};
use crate::scenes::scene;

/// Two overlapping volumes, a grid and a shape, under lights of two kinds; six blocks of tiles, some of them cut.
fn crowded() -> Scene {
    scene(
        r#"
        camera = { position = [0, 0, 4], target = [0, 0, 0], vertical_fov = 30, aperture_radius = 0.05 }
        film = { resolution = [150, 90] }
        [[volume]]
        procedural = { type = "cumulus", seed = 3, resolution = 32, size = 2 }
        mu_t = 8
        albedo = [0.9, 0.8, 0.7]
        phase = { type = "hg", g = 0.6 }
        [[volume]]
        sphere = { center = [0.3, 0, 0.2], radius = 0.5 }
        mu_t = 3
        albedo = 0.5
        emission = [1, 0.5, 0.2]
        [[light]]
        type = "constant"
        radiance = [0.2, 0.3, 0.5]
        [[light]]
        type = "distant"
        direction = [1, -1, -0.5]
        irradiance = 3
        "#,
    )
}

#[test]
fn threads_and_passes_change_no_bit() {
    let grey = crowded();
    // Whose integrator is the spectral one, whichever is asked for.
    let mut chromatic = grey.clone();
    let mu_t = DVec3::new(1.0, 2.0, 8.0);
    chromatic.volumes[1].medium.chromatic = Some(Arc::new(ChromaticMedium { mu_t, phase_functions: None }));
    let all = BOTH.map(|integrator| (&grey, integrator)).into_iter().chain([(&chromatic, BOTH[0])]);
    let ways = [(Sampler::Independent, false), (Sampler::Sobol, false), (Sampler::Sobol, true)];
    for ((scene, integrator), (sampler, is_adaptive)) in all.flat_map(|one| ways.map(|way| (one, way))) {
        let film = |threads, passes: &[[u64; 2]]| {
            let options = RenderOptions { threads, sampler, ..options(integrator, 7) };
            let mut film = match is_adaptive {
                true => empty_adaptive(scene, options),
                false => Film::new(150, 90, Layers::ALL).expect("a small picture"),
            };
            for &[start, end] in passes {
                add_pass(scene, &mut film, start..end, options);
            }
            film
        };
        let whole = film(1, &[[0, 6]]);
        // Films are large to print: only whether they are equal is asserted.
        for threads in [2, 3] {
            assert!(whole == film(threads, &[[0, 6]]), "{integrator:?}, {sampler:?}: {threads} threads");
        }
        assert!(whole == film(1, &[[0, 2], [2, 6]]), "{integrator:?}, {sampler:?}: two passes");
        assert!(
            whole == film(3, &[[2, 6], [0, 2]]),
            "{integrator:?}, {sampler:?}: two passes in the other order, three threads"
        );

        let mut left = film(1, &[[0, 2]]);
        left.merge(&film(2, &[[2, 6]])).expect("disjoint samples of one picture");
        assert!(whole == left, "{integrator:?}, {sampler:?}: two films merged");
        assert!(whole != film(1, &[[1, 7]]), "{integrator:?}, {sampler:?}: other samples are other pictures");
    }
}
