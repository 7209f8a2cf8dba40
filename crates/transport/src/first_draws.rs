//! The random numbers that a path begins with: where it starts, how far it goes at first, which light it asks there, and
//! where it goes on.
//!
//! Every path of a pixel draws these, and the picture depends on them most smoothly; so they may be drawn evenly over the
//! pixel's paths, by [`Stratified`] points. All later ones are independent.

use tyndall_lanes::{Random, Stratified};
use tyndall_scene::description::Sampler;

/// A set of stratified points for each use.
#[derive(Clone, Copy)]
enum Set {
    Film,
    Lens,
}

/// Where the numbers come from.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) enum FirstDraws {
    /// The path's own, in the order of their use.
    #[default]
    Independent,
    /// Points of the pixel.
    Stratified(Stratified),
}

impl FirstDraws {
    /// The numbers of sample `sample` of pixel `pixel` under `seed`.
    #[inline(always)]
    pub fn new(sampler: Sampler, seed: u64, pixel: u64, sample: u64) -> Self {
        match sampler {
            Sampler::Independent => Self::Independent,
            Sampler::Sobol => Self::Stratified(Stratified::new(seed, pixel, sample)),
        }
    }

    /// The place in the pixel.
    #[inline(always)]
    pub fn film(&self, random: &mut Random) -> [f64; 2] {
        self.pair(Set::Film, random)
    }

    /// The place on the lens.
    #[inline(always)]
    pub fn lens(&self, random: &mut Random) -> [f64; 2] {
        self.pair(Set::Lens, random)
    }

    #[inline(always)]
    fn pair(&self, set: Set, random: &mut Random) -> [f64; 2] {
        match self {
            Self::Independent => [random.f64(), random.f64()],
            Self::Stratified(stratified) => stratified.point2(set as u32).map(f64::from),
        }
    }
}
