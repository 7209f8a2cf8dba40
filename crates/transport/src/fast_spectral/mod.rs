//! The fast engine for one even medium whose extinction or phase function depends on colour: the estimator of
//! [`spectral`](crate::spectral), with many paths in flight on each thread.
//!
//! Flights have closed forms there, so that all there is to a vertex of a path is arithmetic: [`vertex`] takes every path of
//! the pool through one at a time, in loops that the compiler turns into vector code. Between two rounds the few paths that
//! ended make room for others.
//!
//! A sample is some paths for each channel c in place of one for a channel drawn at random, and all of them are weighted by the
//! balance heuristic for so many samples (Veach & Guibas 1995): with m paths a channel,
//!
//!   weight of λ = A_λ p_λ / (m Σ_c p_c),
//!
//! which takes away the noise of that draw: most of all there is, where extinctions differ so much that a path is
//! likely for one channel only. The paths of a sample share the camera's ray. What passes the medium unscattered is added in
//! closed form, T_λ L_λ, and so all of them collide on that ray (forced collision): within the chord of length s their
//! distances t have the densities μ_c exp(−μ_c t)/(1 − T_c), of which each of the m paths draws from one of m equal shares.
//!
//! Light that comes evenly from everywhere is found by paths alone, delta lights by next-event estimation alone, and no two
//! ways to the same light have to be weighed.

mod connect;
mod pool;
mod scene;
mod turn;
mod vertex;
mod way_out;

use glam::Vec3;
use tyndall_film::Sample;
use tyndall_lanes::Random;

use self::pool::{Lanes, OpenSample, OpenSamples, PARTS, POOL, STRATA};
use self::scene::CHANNELS;
use self::vertex::List;
use crate::beginning::Beginning;
use crate::render::{RenderOptions, effort};
use crate::wide;
use crate::work::{Pixel, Work};

pub(crate) use self::scene::FastSpectralScene;

/// Rounds between two looks at whether the render was cancelled.
const ROUNDS_BETWEEN_LOOKS: u32 = 256;

/// Renders all samples that there are for this thread, unless the render is cancelled.
pub(crate) fn render(scene: &FastSpectralScene, work: Work, options: &RenderOptions) {
    wide::run(Engine::new(scene, work, options));
}

struct Engine<'a, 'f> {
    scene: &'a FastSpectralScene<'a>,
    work: Work<'a, 'f>,
    options: &'a RenderOptions,
    lanes: Box<Lanes>,
    open: OpenSamples,
    /// The sample whose paths start next.
    starting: Option<Starting>,
    active: usize,
}

/// A sample some of whose paths have not started yet.
struct Starting {
    number: u16,
    /// The next path.
    part: usize,
    random: Random,
    /// Where the camera's ray enters the medium, and its direction.
    position: Vec3,
    direction: Vec3,
    /// Transmittance of the chord in each channel.
    transmittance: [f32; CHANNELS],
    /// Its complement, to more digits.
    opacity: [f32; CHANNELS],
    /// p_c/Σp before the flight.
    density: [f32; CHANNELS],
}

impl wide::Task for Engine<'_, '_> {
    const GAINS_FROM_AVX512: bool = true;

    #[inline(always)]
    fn run(mut self) {
        for slot in 0..POOL {
            self.fill(slot);
        }
        let mut ended = List::new();
        let mut round = 0_u32;
        while self.active > 0 {
            vertex::pass_all(self.scene, &mut self.lanes, &mut ended);
            for &slot in ended.slots() {
                self.finish(usize::from(slot));
                self.fill(usize::from(slot));
            }
            round = round.wrapping_add(1);
            if round.is_multiple_of(ROUNDS_BETWEEN_LOOKS) && self.work.is_cancelled() {
                return;
            }
        }
    }
}

impl<'a, 'f> Engine<'a, 'f> {
    fn new(scene: &'a FastSpectralScene<'a>, work: Work<'a, 'f>, options: &'a RenderOptions) -> Self {
        let (lanes, open) = (Lanes::new(), OpenSamples::new());
        Self { scene, work, options, lanes, open, starting: None, active: 0 }
    }

    /// Gives the place to the next path there is.
    fn fill(&mut self, slot: usize) {
        let starting = loop {
            match &mut self.starting {
                Some(starting) if starting.part < PARTS => break starting,
                _ => {}
            }
            // Asked for each sample: rays that miss the medium go by without a round.
            if self.work.is_cancelled() {
                return;
            }
            let Some((pixel, sample)) = self.work.next() else { return };
            self.start(pixel, sample);
        };
        let (channel, stratum) = (starting.part / STRATA, starting.part % STRATA);
        let lanes = &mut *self.lanes;
        for axis in 0..3 {
            lanes.position[axis][slot] = starting.position[axis];
            lanes.direction[axis][slot] = starting.direction[axis];
        }
        for c in 0..CHANNELS {
            lanes.density[c][slot] = starting.density[c];
            lanes.weight[c][slot] = starting.opacity[c] / STRATA as f32;
            lanes.single[c][slot] = 0.0;
            lanes.multiple[c][slot] = 0.0;
        }
        lanes.free_path[slot] = self.scene.mu_t[channel].recip();
        lanes.g[slot] = self.scene.g(channel);
        lanes.span[slot] = starting.opacity[channel] / STRATA as f32;
        lanes.floor[slot] = starting.transmittance[channel] + stratum as f32 * lanes.span[slot];
        lanes.scatterings[slot] = 0;
        lanes.begun[slot] = Random::new(starting.random.bits(), starting.part as u64, 0);
        lanes.random[slot] = lanes.begun[slot];
        lanes.active[slot] = 1;
        lanes.part[slot] = (starting.number, starting.part as u16);
        starting.skip_to(starting.part + 1);
        self.active += 1;
    }

    /// Draws the camera's ray of a sample. What it sees without scattering is found at once.
    fn start(&mut self, pixel: Pixel, sample: u64) {
        let scene = self.scene;
        let Beginning { mut random, ray, .. } =
            Beginning::new(scene.scene, self.options, (pixel, sample), true);
        let within = scene.volume.interval(&scene.volume.local_ray(&ray), (0.0, f64::INFINITY));
        let Some((enter, leave)) = within else {
            self.record(OpenSample { pixel, background: scene.even, ..OpenSample::default() });
            return;
        };

        let thickness =
            scene.mu_t.map(|mu_t| if mu_t > 0.0 { f64::from(mu_t) * (leave - enter) } else { 0.0 });
        let transmittance = thickness.map(|thickness| libm::exp(-thickness) as f32);
        let opacity = thickness.map(|thickness| -libm::expm1(-thickness) as f32);
        let mut background = scene.even;
        (0..CHANNELS).for_each(|c| background[c] *= transmittance[c]);
        let channel = ((random.f64() * scene.witnesses) as usize).min(CHANNELS - 1);
        let witness = channel * STRATA + (random.f64() * STRATA as f64) as usize;
        let hit = random.f32() < opacity[channel];
        let missing = opacity.iter().filter(|&&opacity| opacity > 0.0).count() * STRATA;
        let open =
            OpenSample { pixel, missing, background, witness, hit, depth: enter, ..OpenSample::default() };
        if missing == 0 {
            self.record(open);
            return;
        }
        let density = opacity.map(|opacity| if opacity > 0.0 { opacity.recip() } else { 0.0 });
        let sum: f32 = density.iter().sum();
        let mut starting = Starting {
            number: self.open.open(open),
            part: 0,
            random,
            position: (ray.at(enter) - scene.centre).as_vec3(),
            direction: ray.direction.as_vec3(),
            transmittance,
            opacity,
            density: density.map(|density| density / sum),
        };
        starting.skip_to(0);
        self.starting = Some(starting);
    }

    /// The path in this place has ended: its sample gets what it found.
    fn finish(&mut self, slot: usize) {
        let lanes = &mut *self.lanes;
        lanes.active[slot] = 0;
        self.active -= 1;
        let (number, part) = lanes.part[slot];
        let part = usize::from(part);
        let sample = self.open.get(number);
        for c in 0..CHANNELS {
            sample.single[part][c] = lanes.single[c][slot];
            sample.multiple[part][c] = lanes.multiple[c][slot];
        }
        if sample.witness == part {
            sample.depth += f64::from(lanes.first[slot]);
        }
        let effort = effort(&lanes.begun[slot], &lanes.random[slot]);
        sample.effort = sample.effort.saturating_add(effort);
        sample.missing -= 1;
        if sample.missing == 0 {
            let sample = self.open.close(number);
            self.record(sample);
        }
    }

    fn record(&mut self, sample: OpenSample) {
        let sum = |parts: [[f32; CHANNELS]; PARTS]| parts.into_iter().map(Vec3::from_array).sum::<Vec3>();
        let (single, multiple) = (sum(sample.single), sum(sample.multiple));
        let radiance = Vec3::from_array(sample.background) + single + multiple;
        let described = Sample {
            radiance: radiance.to_array(),
            hit: sample.hit,
            depth: sample.depth as f32,
            albedo: self.scene.albedo,
            single: single.to_array(),
            multiple: multiple.to_array(),
            effort: sample.effort,
            ..Sample::default()
        };
        self.work.add(sample.pixel, &described);
    }
}

impl Starting {
    /// The next path to start is the first from this one on whose channel may collide at all.
    fn skip_to(&mut self, part: usize) {
        let may_collide = |part: &usize| self.opacity[*part / STRATA] > 0.0;
        self.part = (part..PARTS).find(may_collide).unwrap_or(PARTS);
    }
}
