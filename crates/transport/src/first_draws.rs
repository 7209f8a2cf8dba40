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
    LightPlace,
    Direction,
    /// The distance in the first volume, and which light is asked from there; plus the number of the volume.
    DistanceAndLight,
    /// In homogeneous media; beyond the number of any volume.
    LitWay = 1 << 24,
    /// In homogeneous media, of each branch.
    Turn,
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

    /// Which light is asked at the path's first turn.
    #[inline(always)]
    pub fn light(&self, random: &mut Random) -> f64 {
        match self {
            Self::Independent => random.f64(),
            Self::Stratified(stratified) => f64::from(stratified.point2(Set::DistanceAndLight as u32)[1]),
        }
    }

    /// The place on that light, or the direction to it.
    #[inline(always)]
    pub fn light_place(&self, random: &mut Random) -> [f64; 2] {
        self.pair(Set::LightPlace, random)
    }

    /// The place in that light, if it is a volume.
    #[inline(always)]
    pub fn light_place_inside(&self, random: &mut Random) -> [f64; 3] {
        match self {
            Self::Independent => [random.f64(), random.f64(), random.f64()],
            Self::Stratified(stratified) => {
                let [a, b, c, _] = stratified.point4(Set::LightPlace as u32);
                [a, b, c].map(f64::from)
            }
        }
    }

    /// Where the path goes on from there.
    #[inline(always)]
    pub fn direction(&self, random: &mut Random) -> [f32; 2] {
        match self {
            Self::Independent => random.f32x2(),
            Self::Stratified(stratified) => stratified.point2(Set::Direction as u32),
        }
    }

    /// Exponential variate of mean 1: the optical thickness, under the majorant, up to the first tentative collision of the
    /// camera's ray with the volume of this number.
    #[inline(always)]
    pub fn optical_thickness(&self, volume: usize, random: &mut Random) -> f32 {
        match self {
            Self::Independent => random.exponential(),
            Self::Stratified(stratified) => {
                let u = stratified.point1(Set::DistanceAndLight as u32 + volume as u32);
                -tyndall_lanes::ln(1.0 - u)
            }
        }
    }

    /// Uniform in (0, 1]: where the camera's ray collides with a homogeneous medium.
    #[inline(always)]
    pub fn collision(&self, random: &mut Random) -> f32 {
        1.0 - match self {
            Self::Independent => random.f32(),
            Self::Stratified(stratified) => stratified.point1(Set::DistanceAndLight as u32),
        }
    }

    /// Two numbers for the places on the camera's ray that light is looked for from, and two for those on the light.
    #[inline(always)]
    pub fn lit_way(&self, random: &mut Random) -> [[f32; 2]; 2] {
        let [a, b, c, d] = self.four(Set::LitWay, random);
        [[a, b], [c, d]]
    }

    /// How the path goes on: a choice, its direction, and where the next ray collides.
    #[inline(always)]
    pub fn turn(&self, random: &mut Random) -> [f32; 4] {
        self.four(Set::Turn, random)
    }

    /// The numbers of one of several branches, for what all of them draw.
    #[inline(always)]
    pub fn of_branch(self, branch: u32, branches: u32) -> Self {
        match self {
            Self::Independent => Self::Independent,
            Self::Stratified(stratified) => Self::Stratified(stratified.branch(branch, branches)),
        }
    }

    #[inline(always)]
    fn four(&self, set: Set, random: &mut Random) -> [f32; 4] {
        match self {
            Self::Independent => {
                let ([a, b], [c, d]) = (random.f32x2(), random.f32x2());
                [a, b, c, d]
            }
            Self::Stratified(stratified) => stratified.point4(set as u32),
        }
    }

    #[inline(always)]
    fn pair(&self, set: Set, random: &mut Random) -> [f64; 2] {
        match self {
            Self::Independent => [random.f64(), random.f64()],
            Self::Stratified(stratified) => stratified.point2(set as u32).map(f64::from),
        }
    }
}
