//! The paths in flight on one thread, and the samples they belong to.

use tyndall_lanes::Random;

use super::scene::CHANNELS;
use crate::work::Pixel;

/// Paths in flight on a thread: few enough that their state, and what is computed of it on the way, stays in a core's
/// nearest caches.
pub(super) const POOL: usize = 128;

/// Paths of a sample for each channel. More of them share the cost of the sample's camera ray and of the film, to which pixels
/// beside the medium owe all of theirs, and divide the first flight among them.
pub(super) const STRATA: usize = 4;

/// Paths of a sample: those of the first channel, then those of the next.
pub(super) const PARTS: usize = CHANNELS * STRATA;

/// A quantity of every path.
pub(super) type Group = [f32; POOL];

/// State of the paths: one array for each quantity. Positions and directions are centred world space.
pub(super) struct Lanes {
    /// Where the path last turned, or entered the medium.
    pub position: [Group; 3],
    pub direction: [Group; 3],
    /// p_c/Σp.
    pub density: [Group; CHANNELS],
    /// A: what albedo and roulette have made of the light.
    pub weight: [Group; CHANNELS],
    /// 1/μt of the channel that the path is drawn for.
    pub free_path: Group,
    /// Mean cosine of its phase function.
    pub g: Group,
    /// The flight ends where the transmittance in that channel is floor + u span: on the camera's ray its stratum above what
    /// passes the medium, then 0 + u.
    pub floor: Group,
    pub span: Group,
    /// Scatterings so far.
    pub scatterings: [u32; POOL],
    /// Distance of the first collision from where the path entered.
    pub first: Group,
    pub single: [Group; CHANNELS],
    pub multiple: [Group; CHANNELS],
    pub random: [Random; POOL],
    /// What those were before the first.
    pub begun: [Random; POOL],
    /// 1 for a place with a path.
    pub active: [u32; POOL],
    /// Number of the sample among those that are open, and of the path among its parts.
    pub part: [(u16, u16); POOL],
}

impl Lanes {
    pub fn new() -> Box<Lanes> {
        let zero = [0.0; POOL];
        Box::new(Lanes {
            position: [zero; 3],
            direction: [[1.0; POOL], zero, zero],
            density: [zero; CHANNELS],
            weight: [zero; CHANNELS],
            free_path: zero,
            g: zero,
            floor: zero,
            span: [1.0; POOL],
            scatterings: [0; POOL],
            first: zero,
            single: [zero; CHANNELS],
            multiple: [zero; CHANNELS],
            random: [Random::default(); POOL],
            begun: [Random::default(); POOL],
            active: [0; POOL],
            part: [(0, 0); POOL],
        })
    }
}

/// A sample some of whose paths are under way.
#[derive(Clone, Copy, Default)]
pub(super) struct OpenSample {
    pub pixel: Pixel,
    /// Paths that have not ended yet.
    pub missing: usize,
    /// What passes the medium unscattered.
    pub background: [f32; CHANNELS],
    /// What each path found, scattered once and more than once. Kept apart to be added in the order of parts.
    pub single: [[f32; CHANNELS]; PARTS],
    pub multiple: [[f32; CHANNELS]; PARTS],
    /// The part that stands for the camera's ray in the layers of depth and coverage, and whether it would have
    /// collided by itself.
    pub witness: usize,
    pub hit: bool,
    /// Distance to the medium, and then to the first collision of that path.
    pub depth: f64,
    /// Random numbers that its paths took.
    pub effort: u32,
}

/// Places of a list of open samples.
pub(super) struct OpenSamples {
    samples: Vec<OpenSample>,
    free: Vec<u16>,
}

impl OpenSamples {
    /// Every path may belong to a sample of its own, and one sample may have none under way yet.
    pub fn new() -> OpenSamples {
        OpenSamples { samples: vec![OpenSample::default(); POOL + 1], free: (0..=POOL as u16).collect() }
    }

    pub fn open(&mut self, sample: OpenSample) -> u16 {
        let number = self.free.pop().expect("there are more places than paths");
        self.samples[usize::from(number)] = sample;
        number
    }

    pub fn get(&mut self, number: u16) -> &mut OpenSample {
        &mut self.samples[usize::from(number)]
    }

    pub fn close(&mut self, number: u16) -> OpenSample {
        self.free.push(number);
        self.samples[usize::from(number)]
    }
}
