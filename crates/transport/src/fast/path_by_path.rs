//! One path after the other, each from its start to its end: for scenes where paths turn so rarely, or so little is left to
//! march through, that many in flight at once are of no use.

use std::sync::atomic::{AtomicBool, Ordering};
use tyndall_film::{FilmTile, Sample};
use tyndall_lanes::Random;
use tyndall_scene::{Ray, Scene};

use crate::first_draws::FirstDraws;
use crate::render::RenderOptions;
use crate::wide;

/// What traces paths.
pub(super) trait Tracer {
    fn scene(&self) -> &Scene;

    /// One estimate of the radiance that arrives along `ray`.
    fn trace(&self, ray: Ray, random: &mut Random) -> Sample;
}

/// All samples of some tiles.
pub(super) struct PathByPath<'a, T> {
    pub tracer: &'a T,
    pub tiles: &'a mut [FilmTile],
    pub options: &'a RenderOptions,
    pub cancel: &'a AtomicBool,
}

impl<T: Tracer> wide::Task for PathByPath<'_, T> {
    #[inline(always)]
    fn run(self) -> bool {
        let scene = self.tracer.scene();
        let columns = u64::from(scene.resolution[0]);
        let (seed, sampler) = (self.options.seed, self.options.sampler);
        let has_lens = scene.camera.has_lens();
        for tile in self.tiles {
            let (rect, samples) = (tile.rect(), tile.samples());
            for y in rect.y..rect.y + rect.height {
                if self.cancel.load(Ordering::Relaxed) {
                    return false;
                }
                for x in rect.x..rect.x + rect.width {
                    let pixel = u64::from(y) * columns + u64::from(x);
                    for sample in samples.clone() {
                        let mut random = Random::new(seed, pixel, sample);
                        let draws = FirstDraws::new(sampler, seed, pixel, sample);
                        let film_u = draws.film(&mut random);
                        let lens_u = if has_lens { draws.lens(&mut random) } else { [0.5; 2] };
                        let ray = scene.camera.ray([x, y], film_u, lens_u);
                        tile.add(x, y, &self.tracer.trace(ray, &mut random));
                    }
                }
            }
        }
        true
    }
}
