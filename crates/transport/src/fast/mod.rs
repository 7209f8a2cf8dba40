//! The fast engine: the estimators of the reference integrator, with many paths in flight on each thread.
//!
//! A thread keeps a pool of 256 rays. Each round takes every ray one step through its grid ([`march`]), and then
//! looks after the few to which something happened: a path that collided is scattered, one that left is added to
//! its pixel and its place goes to the next path. Paths do not touch each other and draw from random numbers of
//! their own, so the picture does not depend on who shared a pool with whom.
//!
//! It differs from the reference in five ways, none of which changes an expected value: one random voxel in place of
//! eight interpolated (see [`march`], and [`glow`], which has weights of its own), f32 relative to the scene's centre,
//! roulette before shadow rays ([`next_event`]), in thin grids and fires camera rays that bring light from every tentative
//! collision ([`gather`]), and paths that split around fires ([`split`]).
//!
//! Scenes of one homogeneous medium, or none, need no march and are traced otherwise ([`homogeneous`]).

mod at_surface;
mod coarse;
mod gather;
mod glow;
mod homogeneous;
mod light_cache;
mod march;
mod next_event;
mod pool;
mod sided;
mod split;
mod volume;

pub(crate) use volume::FastScene;

use crate::beginning::Beginning;
use crate::counters::{self, Event};
use crate::emission::{path_weight, weighted_emission_along};
use crate::first_draws::FirstDraws;
use crate::found_light;
use crate::path_layers::FirstMet;
use crate::render::{RenderOptions, effort};
use crate::roulette::survival;
use crate::way::{Span, is_plain};
use crate::wide;
use crate::work::{Pixel, Work};
use glam::{DVec3, Vec3};
use march::List;
use next_event::{choose_correction, choose_direct};
use pool::{GATHERS, OWN, POOL, Path, Rays, SHADOW};
use sided::Sided;
use tyndall_film::Sample;
use tyndall_lanes::Random;
use volume::Kind;

/// Rounds between two looks at whether the render was cancelled.
const ROUNDS_BETWEEN_LOOKS: u32 = 256;

/// Renders all samples that there are for this thread, unless the render is cancelled.
pub(crate) fn render(scene: &FastScene, work: Work, options: &RenderOptions) {
    match &scene.homogeneous {
        Some(homogeneous) => wide::run(homogeneous::Paths { homogeneous, work, options }),
        None => wide::run(Engine::new(scene, work, options)),
    }
}

struct Engine<'a, 'f> {
    scene: &'a FastScene<'a>,
    work: Work<'a, 'f>,
    options: &'a RenderOptions,
    rays: Box<Rays>,
    paths: Vec<Path>,
    /// What surfaces need of each path, if there are any.
    sided: Vec<Sided>,
    active: usize,
    is_cancelled: bool,
}

/// What a path does next.
enum Next {
    /// Its place in the pool gets a new path.
    Start,
    /// Its own ray starts.
    Fly,
    /// Its shadow ray starts.
    LookAtLight,
    /// The ray enters the volume of this number, or the first one after it that lies in its way.
    Enter(usize),
    /// The ray has passed all volumes.
    Finish,
    /// The path is added to its pixel.
    Record,
}

impl wide::Task for Engine<'_, '_> {
    /// It waits for cells and voxels: 0.97 to 1.0 of the speed.
    const GAINS_FROM_AVX512: bool = false;

    #[inline(always)]
    fn run(mut self) {
        self.active = POOL;
        for slot in 0..POOL {
            self.proceed(slot, Next::Start);
        }
        let (mut tentative, mut left, mut happened) = (List::new(), List::new(), List::new());
        let mut round = 0_u32;
        while self.active > 0 && !self.is_cancelled {
            let (clock, active) = (counters::clock(), self.active);
            march::step(&mut self.rays, &self.scene.volumes, &mut tentative, &mut left);
            march::collide(&mut self.rays, &self.scene.volumes, &tentative, &mut happened);
            counters::count_round(clock, active, &self.rays.shadow, tentative.slots(), happened.slots());
            for &slot in left.slots() {
                let slot = usize::from(slot);
                let next = Next::Enter(self.paths[slot].place as usize + 1);
                self.proceed(slot, next);
            }
            for &slot in happened.slots() {
                let slot = usize::from(slot);
                if self.rays.shadow[slot] < 0.0 && self.gather_at(slot) {
                    continue;
                }
                let next = if self.rays.shadow[slot] != 0.0 {
                    Next::Finish
                } else {
                    let volume = self.rays.volume[slot];
                    self.paths[slot].nearest = Some((volume, self.rays.t[slot]));
                    Next::Enter(self.paths[slot].place as usize + 1)
                };
                self.proceed(slot, next);
            }
            round = round.wrapping_add(1);
            self.is_cancelled |= round.is_multiple_of(ROUNDS_BETWEEN_LOOKS) && self.work.is_cancelled();
        }
    }
}

impl<'a, 'f> Engine<'a, 'f> {
    #[inline(always)]
    fn new(scene: &'a FastScene<'a>, work: Work<'a, 'f>, options: &'a RenderOptions) -> Self {
        Engine {
            scene,
            work,
            options,
            rays: Rays::new(),
            paths: vec![Path::default(); POOL],
            sided: if scene.is_sided { vec![Sided::new(is_plain(scene.scene)); POOL] } else { Vec::new() },
            active: 0,
            is_cancelled: false,
        }
    }

    /// Takes the path in `slot` through what happens to it until its ray marches again.
    #[inline(always)]
    fn proceed(&mut self, slot: usize, mut next: Next) {
        loop {
            next = match next {
                Next::Start => match self.next_sample() {
                    Some((pixel, sample)) => self.start(slot, pixel, sample),
                    None => {
                        self.rays.end[slot] = 0.0;
                        self.rays.t[slot] = 0.0;
                        self.active -= 1;
                        return;
                    }
                },
                Next::Fly => {
                    self.paths[slot].nearest = None;
                    let end = if self.scene.is_sided { self.look_ahead(slot) } else { f32::INFINITY };
                    let is_first = self.paths[slot].turns == 0;
                    let kind = if is_first && self.scene.gathers { GATHERS } else { OWN };
                    self.begin_ray(slot, kind, end)
                }
                Next::LookAtLight => {
                    counters::count(Event::ShadowRay, 1);
                    let distance = self.paths[slot].light_distance;
                    self.begin_ray(slot, SHADOW, distance)
                }
                Next::Enter(first) => match self.enter(slot, first) {
                    true => return,
                    false => Next::Finish,
                },
                Next::Finish if self.rays.shadow[slot] > 0.0 => {
                    self.add_direct(slot);
                    let traced = self.next_light(slot);
                    self.turned(slot, traced)
                }
                Next::Finish if self.rays.shadow[slot] < 0.0 => self.finish_gathering(slot),
                Next::Finish => {
                    counters::count(Event::Segment, 1);
                    if self.scene.shines {
                        self.gather(slot);
                    }
                    match self.paths[slot].nearest {
                        Some((volume, distance)) => self.scatter(slot, volume as usize, distance, false),
                        None if self.scene.is_sided => self.arrive(slot),
                        None => self.escape(slot),
                    }
                }
                Next::Record => {
                    if let Some(next) = self.branch(slot) {
                        next
                    } else if let Some(next) = self.resume(slot) {
                        next
                    } else {
                        self.record(slot);
                        Next::Start
                    }
                }
            };
        }
    }

    /// The next sample to begin, unless the render is cancelled. Asked for each path: through dense media without a grid
    /// whole paths go by in a round.
    #[inline(always)]
    fn next_sample(&mut self) -> Option<(Pixel, u64)> {
        self.is_cancelled |= self.work.is_cancelled();
        if self.is_cancelled { None } else { self.work.next() }
    }

    #[inline(always)]
    fn start(&mut self, slot: usize, pixel: Pixel, sample: u64) -> Next {
        let scene = self.scene.scene;
        let Beginning { begun, random, draws, ray } =
            Beginning::new(scene, self.options, (pixel, sample), scene.camera.has_lens());
        self.rays.random[slot] = random;
        self.paths[slot] = Path {
            pixel,
            begun,
            draws,
            position: (ray.origin - self.scene.centre).as_vec3(),
            direction: ray.direction.as_vec3(),
            throughput: Vec3::ONE,
            ..Path::default()
        };
        if self.scene.is_sided {
            let sided = &mut self.sided[slot];
            sided.presence = self.scene.scene.presence_at_camera(ray.origin);
            (sided.ray, sided.refraction) = (ray, 1.0);
        }
        Next::Fly
    }

    #[inline(always)]
    fn begin_ray(&mut self, slot: usize, kind: f32, end: f32) -> Next {
        self.rays.shadow[slot] = kind;
        self.rays.transmittance[slot] = 1.0;
        self.rays.end[slot] = end;
        self.paths[slot].ray_end = end;
        Next::Enter(0)
    }

    /// Puts the ray at the start of the first grid in its way, from span number `first` on (without surfaces every volume
    /// is one span), and settles the volumes with a closed form before it; `false` if there is no grid left.
    #[inline(always)]
    fn enter(&mut self, slot: usize, first: usize) -> bool {
        let shadow = self.rays.shadow[slot] > 0.0;
        let path = &mut self.paths[slot];
        let direction = if shadow { path.shadow_direction } else { path.direction };
        let spans = self.sided.get(slot).and_then(|sided| sided.spans(shadow));
        let count = spans.map_or(self.scene.volumes.len(), <[Span]>::len);
        for place in first..count {
            let end = path.nearest.map_or(path.ray_end, |(_, distance)| distance);
            let end = if shadow { path.ray_end } else { end };
            let (number, begin, end) = match spans.map(|spans| spans[place]) {
                Some(span) => (span.volume, span.start as f32, end.min(span.end as f32)),
                None => (place, 0.0, end),
            };
            let volume = &self.scene.volumes[number];
            let mu_t = volume.mu_t * volume.phase.projected_area(direction);
            match &volume.kind {
                Kind::ClosedForm(closed) => {
                    let local = closed.local_ray(&self.scene.world_ray(path.position, direction));
                    let Some((enter, leave)) = closed.interval(&local, (f64::from(begin), f64::from(end)))
                    else {
                        continue;
                    };
                    let mu_t = f64::from(mu_t);
                    if shadow {
                        let integral = closed.density_integral(&local, (enter, leave)).unwrap_or(0.0);
                        self.rays.transmittance[slot] *= tyndall_lanes::exp((-mu_t * integral) as f32);
                    } else {
                        let integral =
                            f64::from(path.draws.optical_thickness(number, &mut self.rays.random[slot]))
                                / mu_t;
                        let distance = closed.distance_of_integral(&local, enter, integral) as f32;
                        if distance < leave as f32 {
                            path.nearest = Some((number as u32, distance));
                        }
                    }
                }
                Kind::Grid(grid) => {
                    let origin = grid.to_local.transform_point3(path.position);
                    let direction = keep_from_zero(grid.to_local.transform_vector3(direction));
                    let inverse = direction.recip();
                    let a = (grid.min - origin) * inverse;
                    let b = (grid.max - origin) * inverse;
                    let enter = a.min(b).max_element().max(begin);
                    let leave = a.max(b).min_element().min(end);
                    if enter >= leave || mu_t <= 0.0 {
                        continue;
                    }
                    let rays = &mut *self.rays;
                    [rays.ox[slot], rays.oy[slot], rays.oz[slot]] = origin.to_array();
                    let nudge = march::nudge(grid.max);
                    let ahead = origin + direction.signum() * nudge;
                    [rays.ax[slot], rays.ay[slot], rays.az[slot]] = ahead.to_array();
                    [rays.dx[slot], rays.dy[slot], rays.dz[slot]] = direction.to_array();
                    [rays.ix[slot], rays.iy[slot], rays.iz[slot]] = inverse.to_array();
                    rays.t[slot] = enter;
                    rays.end[slot] = leave;
                    // From far away f32 may not tell distances apart that differ by so little, and the ray would stand still.
                    rays.nudge[slot] =
                        (nudge / direction.abs().max_element()).max(4.0 * f32::EPSILON * leave);
                    rays.mu_t[slot] = mu_t;
                    rays.rate[slot] = if rays.shadow[slot] < 0.0 { mu_t * gather::RATE } else { mu_t };
                    rays.volume[slot] = number as u32;
                    path.place = place as u32;
                    rays.tau[slot] = match shadow {
                        true => rays.random[slot].exponential(),
                        false => path.draws.optical_thickness(number, &mut rays.random[slot]),
                    };
                    return true;
                }
            }
        }
        false
    }

    /// The light that volumes send out along the path's ray, up to its collision.
    #[cold]
    fn gather(&mut self, slot: usize) {
        let path = &mut self.paths[slot];
        let scene = self.scene.scene;
        let ray = self.scene.world_ray(path.position, path.direction);
        let end = path.nearest.map_or(f64::from(path.ray_end), |(_, distance)| f64::from(distance));
        let everywhere: Vec<Span>;
        let spans = match self.sided.get(slot).and_then(|sided| sided.spans(false)) {
            Some(spans) => spans,
            None => {
                everywhere = Span::everywhere(self.scene.volumes.len(), f64::INFINITY);
                &everywhere
            }
        };
        for span in spans.iter().filter(|span| span.start < end) {
            let Some(volume) = self.scene.volumes[span.volume].shines else { continue };
            let turned = path.turned.filter(|_| scene.light_of_volume(span.volume).is_some());
            let weight = turned.map(|from| {
                let pdf = f64::from(path.turn_pdf);
                move |t: f64| path_weight(scene, span.volume, from, ray.at(t), pdf)
            });
            let weight = weight.as_ref().map(|weight| weight as &dyn Fn(f64) -> f64);
            let range = (span.start, span.end.min(end));
            let random = &mut self.rays.random[slot];
            let emission = weighted_emission_along(volume, &ray, range, weight, random);
            path.emission += path.throughput * emission.as_vec3();
        }
    }

    /// The path collides in `volume`: emission is gathered, a light is chosen, a direction drawn.
    #[inline(always)]
    fn scatter(&mut self, slot: usize, number: usize, distance: f32, gathered: bool) -> Next {
        let volume = &self.scene.volumes[number];
        let path = &mut self.paths[slot];
        let random = &mut self.rays.random[slot];
        path.position += path.direction * distance;
        let (albedo, emission) = self.scene.albedo_and_emission(volume, path.position, random);
        if !gathered {
            if path.turns == 0 {
                let (distance, albedo) = (f64::from(distance), albedo.as_dvec3());
                path.first = Some(FirstMet { distance, albedo, ..FirstMet::default() });
            }
            path.emission += path.throughput * emission * self.scene.glow_weight(path, number, emission);
        }
        if self.scene.scene.max_depth.is_some_and(|depth| path.turns >= depth) {
            return Next::Record;
        }
        path.throughput *= albedo;
        let refraction = self.sided.get(slot).map_or(1.0, |sided| sided.refraction as f32);
        if !gathered && !survives_roulette(path, refraction, self.scene.roulette_throughput, random) {
            return Next::Record;
        }
        path.turns += 1;
        path.scatterings += 1;

        let here = match self.sided.get_mut(slot) {
            Some(sided) => sided.collide(self.scene.scene, f64::from(distance)),
            None => self.scene.to_world(path.position),
        };
        let way = if self.scene.knows_all_lights {
            let turning = volume.phase.turning(path.direction);
            choose_correction(self.scene, here, path, turning, gathered, random)
        } else {
            choose_direct(self.scene, here, path, volume.phase, gathered, random)
        };
        let traced = match way {
            // In f64: rounded, the end of the shadow ray might lie behind the lamp's own surface.
            Some((toward, distance)) if self.scene.is_sided => {
                self.sided[slot].sees(self.scene.scene, toward, distance, random)
            }
            way => way.is_some(),
        };

        if path.turns == 1 {
            self.split(slot, number, None);
        }
        self.turn_in(slot, number, here);
        let (path, random) = (&mut self.paths[slot], &mut self.rays.random[slot]);
        if gathered && !survives_roulette(path, refraction, self.scene.roulette_throughput, random) {
            path.throughput = Vec3::ZERO;
        }
        self.turned(slot, traced)
    }

    /// The path goes on in another direction from `here`, where it is, in the volume of this number.
    #[inline(always)]
    fn turn_in(&mut self, slot: usize, number: usize, here: DVec3) {
        let (path, random) = (&mut self.paths[slot], &mut self.rays.random[slot]);
        let phase = &self.scene.volumes[number].phase;
        let before = path.direction;
        path.direction = phase.sample(before, path.draws.direction(random));
        path.draws = FirstDraws::Independent;
        path.turn_pdf = phase.value(before, path.direction);
        path.turned = Some(here);
        if let Some(sided) = self.sided.get_mut(slot) {
            sided.ray.direction = path.direction.as_dvec3().normalize();
        }
    }

    /// What a path does next that has turned, or been ended by roulette: its shadow ray first, if there is one.
    #[inline(always)]
    fn turned(&self, slot: usize, traced: bool) -> Next {
        match (traced, self.paths[slot].throughput == Vec3::ZERO) {
            (true, _) => Next::LookAtLight,
            (false, true) => Next::Record,
            (false, false) => Next::Fly,
        }
    }

    #[inline(always)]
    fn add_direct(&mut self, slot: usize) {
        let path = &mut self.paths[slot];
        let direct = path.direct * self.rays.transmittance[slot];
        if path.direct_is_glow {
            path.emission += direct;
        } else {
            path.add_in_scattered(direct);
        }
    }

    /// The path leaves all volumes: what the infinite lights shine along it, weighted against next-event
    /// estimation having drawn that direction.
    #[inline(always)]
    fn escape(&mut self, slot: usize) -> Next {
        let path = &mut self.paths[slot];
        let scene = self.scene.scene;
        let direction = path.direction.as_dvec3().normalize();
        let radiance = found_light::surroundings(scene, direction, path.turned()).as_vec3();
        path.add_in_scattered(path.throughput * radiance);
        Next::Record
    }

    #[inline(always)]
    fn record(&mut self, slot: usize) {
        let path = &self.paths[slot];
        let radiance = path.background + path.emission + path.single + path.multiple;
        let sample = Sample {
            radiance: radiance.to_array(),
            emission: path.emission.to_array(),
            single: path.single.to_array(),
            multiple: path.multiple.to_array(),
            effort: effort(&path.begun, &self.rays.random[slot]),
            ..Sample::default()
        };
        let sample = FirstMet::describe(path.first, sample);
        self.work.add(path.pixel, &sample);
    }
}

/// Ends a path that is weaker than `threshold` with a probability that its survivors' weight makes up for; `refraction` is the
/// part of the throughput that is no loss of light.
#[inline(always)]
fn survives_roulette(path: &mut Path, refraction: f32, threshold: f32, random: &mut Random) -> bool {
    let strength = path.throughput.max_element() / refraction;
    let probability = survival(f64::from(strength), f64::from(threshold), path.turns) as f32;
    if probability < 1.0 && random.f32() >= probability {
        return false;
    }
    path.throughput /= probability;
    true
}

/// Components of a direction that are 0, or nearly, would make planes at infinity indistinguishable.
#[inline(always)]
fn keep_from_zero(direction: Vec3) -> Vec3 {
    let least = direction.abs().max_element() * 1e-12;
    let keep = |x: f32| if x.abs() < least { least } else { x };
    Vec3::new(keep(direction.x), keep(direction.y), keep(direction.z))
}
