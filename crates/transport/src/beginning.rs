//! How every sample begins, in whatever engine: its random numbers, and the camera's ray.

use tyndall_lanes::Random;
use tyndall_scene::{Ray, Scene};

use crate::first_draws::FirstDraws;
use crate::render::RenderOptions;
use crate::work::Pixel;

/// A sample that begins.
pub(crate) struct Beginning {
    /// Its random numbers before the first.
    pub begun: Random,
    /// Those after the camera's.
    pub random: Random,
    pub draws: FirstDraws,
    /// From the camera.
    pub ray: Ray,
}

impl Beginning {
    /// Sample `sample` of the pixel: a function of these and the seed, whoever renders it. A place on the lens may be left undrawn
    /// where there is no lens; the random numbers after it are then others.
    #[inline(always)]
    pub fn new(
        scene: &Scene,
        options: &RenderOptions,
        (pixel, sample): (Pixel, u64),
        draws_lens: bool,
    ) -> Self {
        let RenderOptions { sampler, seed, .. } = *options;
        let number = u64::from(pixel.y) * u64::from(scene.resolution[0]) + u64::from(pixel.x);
        let begun = Random::new(seed, number, sample);
        let mut random = begun;
        let draws = FirstDraws::new(sampler, seed, number, sample);
        let film_u = draws.film(&mut random);
        let lens_u = if draws_lens { draws.lens(&mut random) } else { [0.5; 2] };
        let ray = scene.camera.ray([pixel.x, pixel.y], film_u, lens_u);
        Self { begun, random, draws, ray }
    }
}
