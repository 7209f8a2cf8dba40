//! The fast engine: the estimators of the reference integrator, with many paths in flight on each thread.
//!
//! A thread keeps a pool of 512 rays. Each round takes every ray one step through its grid ([`march`]), and then
//! looks after the few to which something happened: a path that collided is scattered, one that left is added to
//! its pixel and its place goes to the next path. Paths do not touch each other and draw from random numbers of
//! their own, so the picture does not depend on who shared a pool with whom.
//!
//! It differs from the reference in three ways, none of which changes an expected value: one random voxel in place of
//! eight interpolated (see [`march`]), f32 relative to the scene's centre, and roulette on next-event estimation:
//! a shadow ray whose contribution would be small is traced with a small probability and weighs the more. With a
//! forward-peaked phase function most shadow rays are of that kind.

mod march;
mod pool;
mod sided;
mod volume;

pub(crate) use volume::FastScene;
use volume::FastVolume;

use crate::counters::{self, Event};
use crate::emission::{path_weight, weighted_emission_along};
use crate::found_light;
use crate::path_layers::FirstMet;
use crate::roulette::survival;
use crate::shadow_catcher;
use crate::way::Span;
use glam::{DVec3, Vec3};
use march::List;
use pool::{POOL, Path, Pixel, Rays};
use sided::{Direct, Sided, draw_light};
use std::sync::atomic::{AtomicBool, Ordering};
use tyndall_film::{FilmTile, Sample};
use tyndall_lanes::Random;
use tyndall_scene::Scene;
use volume::Kind;

/// Throughput below which roulette is played; survivors get twice this.
const ROULETTE_THROUGHPUT: f32 = 0.25;

/// A shadow ray is traced for certain if its contribution is this share of what the unweakened light would bring
/// by isotropic scattering, and in proportion below. Efficiency 1/(error²·time) of the built-in cumulus and the
/// Disney cloud is level to 5 % between 0.5 and 1; 2 loses a quarter to variance, 0.25 a tenth to time.
const CERTAIN_CONTRIBUTION: f32 = 0.7;

/// Rounds between two looks at whether the render was cancelled.
const ROUNDS_BETWEEN_LOOKS: u32 = 256;

/// Renders all samples of `tiles`; `false` if `cancel` was set before they were complete.
pub(crate) fn render_tiles(
    scene: &FastScene,
    tiles: &mut [FilmTile],
    seed: u64,
    cancel: &AtomicBool,
) -> bool {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi2") {
        // SAFETY: the processor has the features, as just asked.
        #[allow(unsafe_code)]
        return unsafe { run_avx2(scene, tiles, seed, cancel) };
    }
    Engine::new(scene, tiles, seed).run(cancel)
}

/// The same code, compiled for wider vectors. Fused multiply-add stays off, so that the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2(scene: &FastScene, tiles: &mut [FilmTile], seed: u64, cancel: &AtomicBool) -> bool {
    Engine::new(scene, tiles, seed).run(cancel)
}

struct Engine<'a> {
    scene: &'a FastScene<'a>,
    tiles: &'a mut [FilmTile],
    seed: u64,
    film_width: u64,
    rays: Box<Rays>,
    paths: Vec<Path>,
    /// What surfaces need of each path, if there are any.
    sided: Vec<Sided>,
    work: Work,
    active: usize,
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

impl<'a> Engine<'a> {
    #[inline(always)]
    fn new(scene: &'a FastScene<'a>, tiles: &'a mut [FilmTile], seed: u64) -> Engine<'a> {
        Engine {
            scene,
            tiles,
            seed,
            film_width: u64::from(scene.scene.resolution[0]),
            rays: Rays::new(),
            paths: vec![Path::default(); POOL],
            sided: if scene.is_sided { vec![Sided::new(); POOL] } else { Vec::new() },
            work: Work::default(),
            active: 0,
        }
    }

    #[inline(always)]
    fn run(mut self, cancel: &AtomicBool) -> bool {
        self.active = POOL;
        for slot in 0..POOL {
            self.proceed(slot, Next::Start);
        }
        let (mut tentative, mut left, mut happened) = (List::new(), List::new(), List::new());
        let mut round = 0_u32;
        while self.active > 0 {
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
                let next = if self.rays.shadow[slot] > 0.0 {
                    Next::Fly
                } else {
                    let volume = self.rays.volume[slot];
                    self.paths[slot].nearest = Some((volume, self.rays.t[slot]));
                    Next::Enter(self.paths[slot].place as usize + 1)
                };
                self.proceed(slot, next);
            }
            round = round.wrapping_add(1);
            if round.is_multiple_of(ROUNDS_BETWEEN_LOOKS) && cancel.load(Ordering::Relaxed) {
                return false;
            }
        }
        true
    }

    /// Takes the path in `slot` through what happens to it until its ray marches again.
    #[inline(always)]
    fn proceed(&mut self, slot: usize, mut next: Next) {
        loop {
            next = match next {
                Next::Start => match self.work.next(self.tiles) {
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
                    self.begin_ray(slot, false, end)
                }
                Next::LookAtLight => {
                    counters::count(Event::ShadowRay, 1);
                    let distance = self.paths[slot].light_distance;
                    self.begin_ray(slot, true, distance)
                }
                Next::Enter(first) => match self.enter(slot, first) {
                    true => return,
                    false => Next::Finish,
                },
                Next::Finish if self.rays.shadow[slot] > 0.0 => {
                    self.add_direct(slot);
                    if self.paths[slot].throughput == Vec3::ZERO { Next::Record } else { Next::Fly }
                }
                Next::Finish => {
                    counters::count(Event::Segment, 1);
                    if self.scene.shines {
                        self.gather(slot);
                    }
                    match self.paths[slot].nearest {
                        Some((volume, distance)) => self.scatter(slot, volume as usize, distance),
                        None if self.scene.is_sided => self.arrive(slot),
                        None => self.escape(slot),
                    }
                }
                Next::Record => {
                    self.record(slot);
                    Next::Start
                }
            };
        }
    }

    #[inline(always)]
    fn start(&mut self, slot: usize, pixel: Pixel, sample: u64) -> Next {
        let mut random =
            Random::new(self.seed, u64::from(pixel.y) * self.film_width + u64::from(pixel.x), sample);
        let film_u = [random.f64(), random.f64()];
        let lens_u = [random.f64(), random.f64()];
        let ray = self.scene.scene.camera.ray([pixel.x, pixel.y], film_u, lens_u);
        self.rays.random[slot] = random;
        self.paths[slot] = Path {
            pixel,
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
    fn begin_ray(&mut self, slot: usize, shadow: bool, end: f32) -> Next {
        self.rays.shadow[slot] = f32::from(u8::from(shadow));
        self.rays.transmittance[slot] = 1.0;
        self.rays.end[slot] = end;
        self.paths[slot].ray_end = end;
        Next::Enter(0)
    }

    /// Finds the surface at which the path's ray ends; its distance.
    #[inline(never)]
    fn look_ahead(&mut self, slot: usize) -> f32 {
        counters::count(Event::Intersection, 1);
        self.sided[slot].look_ahead(self.scene.scene, &mut self.rays.random[slot]);
        self.sided[slot].way.end as f32
    }

    /// Puts the ray at the start of the first grid in its way, from span number `first` on (without surfaces every volume
    /// is one span), and settles the volumes with a closed form before it; `false` if there is no grid left.
    #[inline(always)]
    fn enter(&mut self, slot: usize, first: usize) -> bool {
        let shadow = self.rays.shadow[slot] > 0.0;
        let path = &mut self.paths[slot];
        let direction = if shadow { path.shadow_direction } else { path.direction };
        let spans = if self.scene.is_sided { Some(self.sided[slot].spans(shadow)) } else { None };
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
                        let integral = f64::from(self.rays.random[slot].exponential()) / mu_t;
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
                    rays.volume[slot] = number as u32;
                    path.place = place as u32;
                    rays.tau[slot] = rays.random[slot].exponential();
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
        let spans = if self.scene.is_sided {
            self.sided[slot].spans(false)
        } else {
            everywhere = Span::everywhere(self.scene.volumes.len(), f64::INFINITY);
            &everywhere
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
    fn scatter(&mut self, slot: usize, number: usize, distance: f32) -> Next {
        let volume = &self.scene.volumes[number];
        let path = &mut self.paths[slot];
        let random = &mut self.rays.random[slot];
        path.position += path.direction * distance;
        let (albedo, emission) = match volume.fields {
            None => (volume.albedo, volume.emission),
            Some(fields) => FastVolume::looked_up(fields, self.scene.to_world(path.position)),
        };
        if path.turns == 0 {
            let (distance, albedo) = (f64::from(distance), albedo.as_dvec3());
            path.first = Some(FirstMet { distance, albedo, ..FirstMet::default() });
        }
        path.emission += path.throughput * emission * self.scene.glow_weight(path, number, emission);
        if self.scene.scene.max_depth.is_some_and(|depth| path.turns >= depth) {
            return Next::Record;
        }
        path.throughput *= albedo;
        let refraction = self.sided.get(slot).map_or(1.0, |sided| sided.refraction as f32);
        if !survives_roulette(path, refraction, random) {
            return Next::Record;
        }
        path.turns += 1;
        path.scatterings += 1;

        let here = match self.sided.get_mut(slot) {
            Some(sided) => sided.collide(self.scene.scene, f64::from(distance)),
            None => self.scene.to_world(path.position),
        };
        let traced = match choose_direct(self.scene.scene, here, path, volume.phase, random) {
            // In f64: rounded, the end of the shadow ray might lie behind the lamp's own surface.
            Some((toward, distance)) if self.scene.is_sided => {
                self.sided[slot].sees(self.scene.scene, toward, distance, random)
            }
            direct => direct.is_some(),
        };

        let before = path.direction;
        path.direction = volume.phase.sample(before, random.f32x2());
        path.turn_pdf = volume.phase.value(before, path.direction);
        path.turned = Some(here);
        if let Some(sided) = self.sided.get_mut(slot) {
            sided.ray.direction = path.direction.as_dvec3().normalize();
        }
        if traced { Next::LookAtLight } else { Next::Fly }
    }

    /// The path's ray has gone through all volumes to a surface, or past all: the surface's own light is gathered, a light
    /// is chosen, a direction drawn.
    #[inline(never)]
    fn arrive(&mut self, slot: usize) -> Next {
        let Some(hit) = self.sided[slot].way.hit else { return self.escape(slot) };
        let scene = self.scene.scene;
        let sided = &mut self.sided[slot];
        let path = &mut self.paths[slot];
        let random = &mut self.rays.random[slot];
        let lamp = found_light::lamp(scene, &hit, sided.ray.direction, path.turned()).as_vec3();
        path.add_in_scattered(path.throughput * lamp);

        let vertex = sided.vertex(scene, &hit);
        if path.turns == 0 {
            let mut first = vertex.first_met(scene, vertex.albedo().truncate());
            if vertex.is_shadow_catcher(scene) {
                first.caught = Some(shadow_catcher::reflected(scene, &vertex, &sided.presence, random));
            }
            path.first = Some(first);
            if first.caught.is_some() {
                return Next::Record;
            }
        }
        if scene.max_depth.is_some_and(|depth| path.turns >= depth) {
            return Next::Record;
        }
        path.turns += 1;

        let mut traced = false;
        if !vertex.is_delta() {
            let value = |toward| (vertex.value(toward).truncate(), vertex.pdf(toward));
            if let Some(Direct { unshadowed, is_glow, toward, distance, .. }) =
                draw_light(scene, vertex.position(), value, random)
                && unshadowed != Vec3::ZERO
            {
                path.direct = path.throughput * unshadowed;
                path.direct_is_glow = is_glow;
                path.shadow_direction = toward.as_vec3();
                path.light_distance = distance as f32;
                traced = sided.sees_from(scene, &vertex, toward, distance, random);
            }
        }

        path.position = (vertex.position() - self.scene.centre).as_vec3();
        let onward = vertex.sample(random).filter(|onward| {
            path.throughput *= onward.weight.truncate().as_vec3();
            sided.refraction *= onward.radiance_scale;
            survives_roulette(path, sided.refraction as f32, random)
        });
        match onward {
            Some(onward) => {
                path.direction = onward.direction.as_vec3();
                path.turned = onward.pdf.map(|_| vertex.position());
                path.turn_pdf = onward.pdf.unwrap_or_default() as f32;
                (sided.ray, sided.presence) = vertex.leave(scene, onward.direction, &sided.presence);
            }
            None => path.throughput = Vec3::ZERO,
        }
        match (traced, path.throughput == Vec3::ZERO) {
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
            ..Sample::default()
        };
        let sample = FirstMet::describe(path.first, sample);
        self.tiles[path.pixel.tile as usize].add(path.pixel.x, path.pixel.y, &sample);
    }
}

/// Draws a light for the place `from`, and what it would bring by the next event; its direction and distance, or `None`
/// if there is nothing to trace or roulette, played on the contribution before the shadow ray is paid for, ended it.
#[inline(always)]
fn choose_direct(
    scene: &Scene,
    from: DVec3,
    path: &mut Path,
    phase: volume::Phase<'_>,
    random: &mut Random,
) -> Option<(DVec3, f64)> {
    let before = path.direction;
    let value = |toward: DVec3| {
        let phase = f64::from(phase.value(before, toward.as_vec3()));
        (DVec3::splat(phase), phase)
    };
    let direct = draw_light(scene, from, value, random);
    let Direct { unshadowed, arriving, is_glow, toward, distance } = direct?;
    let direct = path.throughput * unshadowed;
    let strength = direct.max_element();
    if strength <= 0.0 {
        return None;
    }
    let isotropic = arriving.max_element() * 0.25 * std::f32::consts::FRAC_1_PI;
    let traced = strength / (CERTAIN_CONTRIBUTION * isotropic);
    let mut boost = 1.0;
    if traced < 1.0 {
        if random.f32() >= traced {
            counters::count(Event::ShadowSpared, 1);
            return None;
        }
        boost = 1.0 / traced;
    }
    path.direct = direct * boost;
    path.direct_is_glow = is_glow;
    path.shadow_direction = toward.as_vec3();
    path.light_distance = distance as f32;
    Some((toward, distance))
}

/// Ends a weak path with a probability that its survivors' weight makes up for; `refraction` is the part of the throughput
/// that is no loss of light.
#[inline(always)]
fn survives_roulette(path: &mut Path, refraction: f32, random: &mut Random) -> bool {
    let strength = path.throughput.max_element() / refraction;
    let probability = survival(f64::from(strength), f64::from(ROULETTE_THROUGHPUT), path.turns) as f32;
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

/// The samples of the tiles, one after the other.
#[derive(Default)]
struct Work {
    tile: usize,
    column: u32,
    row: u32,
    done: u64,
}

impl Work {
    #[inline(always)]
    fn next(&mut self, tiles: &[FilmTile]) -> Option<(Pixel, u64)> {
        loop {
            let tile = tiles.get(self.tile)?;
            let (rect, samples) = (tile.rect(), tile.samples());
            if samples.start + self.done < samples.end && self.row < rect.height {
                let pixel = Pixel { tile: self.tile as u32, x: rect.x + self.column, y: rect.y + self.row };
                let sample = samples.start + self.done;
                self.column += 1;
                if self.column == rect.width {
                    (self.column, self.row) = (0, self.row + 1);
                }
                return Some((pixel, sample));
            }
            (self.column, self.row, self.done) = (0, 0, self.done + 1);
            if samples.start + self.done >= samples.end {
                (self.tile, self.done) = (self.tile + 1, 0);
            }
        }
    }
}
