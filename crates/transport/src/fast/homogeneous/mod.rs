//! Paths among surfaces in one homogeneous medium, or none: fog in a room, and rooms without fog.
//!
//! Beer's law gives the transmittance of any way here, so that hardly anything is left to chance along a ray that runs from x
//! to a surface z. Of
//!
//!   L(x,ω) = ∫₀^z T(x,y) μs Ls(y,ω) dy + T(x,z) Lo(z,ω)
//!
//! every ray gets an estimate of the first term as far as light is concerned that is scattered there once ([`lit_way`]), and
//! that of a lamp or of the surroundings at its end times T; the camera's ray also T times what the surface reflects of the
//! lamps. Only where the path goes on, for light that has turned more often, is chosen: a collision, drawn with density μt T,
//! or the surface; from the camera's ray it goes on in several branches. Half of the directions aim at the light around lamps
//! ([`aim`]). The reference integrator leaves all of this to chance, and has the same mean.
//!
//! There is nothing to march through. Still a thread follows some tens of paths side by side ([`rounds`]).

mod aim;
mod distances;
mod lit_way;
mod points;
mod rounds;
mod stretch;

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;
use tyndall_optics::PhaseFunction;
use tyndall_scene::light::AreaLight;
use tyndall_scene::surface::Meeting;
use tyndall_scene::{Channels, Density, Hit, Light, LightSample, Ray, Scene};

use self::lit_way::{Lamps, Unshadowed};
pub(super) use self::rounds::Paths;
use self::stretch::{Fog, Stretch};
use crate::first_draws::FirstDraws;
use crate::found_light::{self, Turned};
use crate::path_layers::{FirstMet, PathLayers};
use crate::roulette::survival;
use crate::surface_vertex::{SurfaceTurn, SurfaceVertex};
use crate::way::is_plain;

/// Throughput of a branch, relative to its beginning, below which roulette is played; survivors get twice this. Of scene C 0.25
/// leaves a tenth more of the variance for 0.95 of the time; below 0.1 paths cost more time than they bring.
const ROULETTE_THROUGHPUT: f64 = 0.15;

/// Branches into which the camera's ray splits: its own light is known well, and what comes after brings the noise. Variance
/// times time of scene C is 0.86 with 1 branch, 0.65 with 4, 0.58 with 8 and 0.67 with 16.
const BRANCHES: u32 = 8;

/// Candidates for light scattered once towards the camera, and on later rays.
const FIRST: usize = 4;
const LATER: usize = 2;

/// A scene that is one homogeneous medium, or none, among surfaces that stop every ray.
pub(super) struct Homogeneous<'a> {
    scene: &'a Scene,
    fog: Option<Fog<'a>>,
    lamps: Lamps,
    infinite: Vec<usize>,
}

impl<'a> Homogeneous<'a> {
    /// The scene as this; `None` if it is another kind of scene.
    pub fn new(scene: &'a Scene) -> Option<Self> {
        let fog = match scene.volumes.as_slice() {
            [] => None,
            [volume] => {
                let is_even = !matches!(volume.density, Density::Grid(_) | Density::Atmosphere { .. });
                let is_dark =
                    volume.medium.emission == DVec3::ZERO && volume.medium.emission_per_length == DVec3::ZERO;
                let is_oriented = matches!(volume.medium.phase_function, PhaseFunction::Sggx(_));
                if !is_even || !is_dark || is_oriented || volume.fields.is_some() || volume.medium.mu_t <= 0.0
                {
                    return None;
                }
                Some(Fog::new(volume))
            }
            _ => return None,
        };
        // Without surfaces and lamps a path that is only ever scattered has less noise: none at all in a white furnace.
        let is_lamp = |light: &Light| matches!(light, Light::Point(_) | Light::Spot(_) | Light::Area(_));
        if scene.surfaces.is_empty() && !scene.lights.iter().any(is_lamp) {
            return None;
        }
        let glows = scene.lights.iter().any(|light| matches!(light, Light::Volume(_)));
        let catches = scene.surfaces.shapes.iter().any(|shape| shape.is_shadow_catcher);
        // A tree of many lights says what matters at a place, and leaves out what may matter elsewhere on a ray.
        if glows || catches || scene.light_tree.is_some() || !is_plain(scene) {
            return None;
        }
        let lamps = Lamps::new(scene, fog.as_ref());
        let infinite = (0..scene.lights.len()).filter(|&light| scene.lights[light].is_infinite()).collect();
        Some(Self { scene, fog, lamps, infinite })
    }
}

impl Homogeneous<'_> {
    /// Whether the path may turn once more.
    #[inline(always)]
    fn goes_on(&self, path: &Path) -> bool {
        self.scene.max_depth.is_none_or(|depth| path.turns < depth)
    }

    /// Follows the path's ray to what it meets, and adds the light that shines there.
    #[inline(always)]
    fn reach(&self, path: &Path, met: Option<&Meeting>, way: &mut Reached, layers: &mut PathLayers<Vec3>) {
        let scene = self.scene;
        let is_first = path.turns == 0;
        let end = met.map_or(f64::INFINITY, Meeting::distance);
        way.stretch = Stretch::new(self.fog.as_ref(), &path.ray, end);
        let collision = way.stretch.collision(path.u);
        (way.hit, way.vertex) = (None, None);
        way.arrives = is_first || collision.is_none();
        let through = path.throughput * way.stretch.through;
        match met {
            // What the path passes by in the end need not be known, but if it shines.
            Some(met) if way.arrives || scene.surfaces.shapes[met.shape()].light.is_some() => {
                let hit = way.hit.insert(scene.surfaces.hit(&path.ray, met));
                if let Some((number, lamp)) = scene.lamp(hit) {
                    layers.add(path.scatterings, through * self.lamp(number, lamp, hit, path));
                }
            }
            Some(_) => {}
            None => layers.add(path.scatterings, through * self.surroundings(path)),
        }
        if is_first {
            let collision = collision.map(|t| way.stretch.start + f64::from(t));
            layers.first = self.first_met(collision, way.hit.as_ref(), &path.ray);
        }
    }

    /// What the surface at the end of the path's way, if the path comes to one, reflects of one lamp, unless something stands
    /// between them.
    #[inline(always)]
    fn arrive(
        &self,
        path: &Path,
        way: &mut Reached,
        draws: FirstDraws,
        random: &mut Random,
    ) -> Option<Unshadowed> {
        let Reached { stretch, hit, vertex, .. } = way;
        let hit = hit.as_ref().filter(|_| way.arrives)?;
        let vertex = vertex.insert(SurfaceVertex::new(self.scene, hit, path.ray.direction, &Channels::Rgb));
        // Towards the camera with the weight of what gets through, later as often as the path does.
        let weight = if path.turns == 0 { path.throughput * stretch.through } else { path.throughput };
        let reflected = self.reflected(vertex, draws, random)?;
        Some(Unshadowed { light: weight * reflected.light, ..reflected })
    }

    /// Turns a path whose ray ended there, the camera's for the branch of this number: at a collision, drawn with density μt T,
    /// or at the surface; `false` if it ends there.
    #[inline(always)]
    fn turn(
        &self,
        path: &mut Path,
        (stretch, vertex): (&Stretch, Option<&SurfaceVertex>),
        branch: u32,
        draws: FirstDraws,
        random: &mut Random,
    ) -> bool {
        if path.turns == 0 {
            path.throughput /= BRANCHES as f32;
            path.u = (path.u + branch as f32) / BRANCHES as f32;
        }
        let collision = stretch.collision(path.u);
        let [choice, v, w, next] = draws.turn(random);
        path.u = 1.0 - next;
        path.turns += 1;
        match (collision, &self.fog, vertex) {
            (Some(t), Some(fog), _) => {
                path.throughput *= fog.albedo;
                if !path.survives_roulette(random) {
                    return false;
                }
                path.scatterings += 1;
                let before = path.ray.direction.as_vec3();
                let position = stretch.ray.at(f64::from(t));
                let aim = self.lamps.targets.from(position, stretch.mu_t);
                let onward = match aim.sample(choice, [v, w]) {
                    Some(onward) => onward,
                    None => fog.phase.sample(before, [v, w]),
                };
                let value = fog.phase.value(before, onward);
                path.throughput *= value / aim.pdf(onward, value);
                let pdf = f64::from(value);
                let candidates = if path.turns == 1 { FIRST } else { LATER };
                path.turn = Turn::Collision { stretch: *stretch, t, pdf, candidates };
                path.ray = Ray { origin: position, direction: onward.as_dvec3().normalize() };
            }
            (_, _, Some(vertex)) => {
                let Some(onward) = self.leave(vertex, [choice, v, w]) else { return false };
                path.throughput *= onward.weight.truncate().as_vec3();
                path.refraction *= onward.radiance_scale;
                if !path.survives_roulette(random) {
                    return false;
                }
                path.turn = match onward.pdf {
                    Some(pdf) => Turn::Surface { from: vertex.position(), pdf },
                    None => Turn::None,
                };
                path.ray = vertex.depart(onward.direction);
            }
            _ => return false,
        }
        true
    }

    /// How the path goes on from a surface.
    #[inline(always)]
    fn leave(&self, vertex: &SurfaceVertex, [choice, v, w]: [f32; 3]) -> Option<SurfaceTurn> {
        let sampled = || vertex.sample_by(choice.into(), [v.into(), w.into()]);
        if !vertex.is_matte() {
            return sampled();
        }
        let mu_t = self.fog.as_ref().map_or(0.0, |fog| fog.mu_t);
        let aim = self.lamps.targets.from(vertex.position(), mu_t);
        let direction = match aim.sample(choice, [v, w]) {
            Some(direction) => direction.as_dvec3().normalize(),
            None => sampled()?.direction,
        };
        let pdf = vertex.pdf(direction);
        let weight = vertex.value(direction) / f64::from(aim.pdf(direction.as_vec3(), pdf as f32));
        (pdf > 0.0).then_some(SurfaceTurn { direction, weight, pdf: Some(pdf), radiance_scale: 1.0 })
    }

    /// Light of one lamp that the surface reflects towards the path, after its way through the medium, unless something stands in
    /// that.
    #[inline(always)]
    fn reflected(
        &self,
        vertex: &SurfaceVertex,
        draws: FirstDraws,
        random: &mut Random,
    ) -> Option<Unshadowed> {
        if vertex.is_delta() {
            return None;
        }
        let from = vertex.position();
        let (number, probability) = self.scene.choose_light(from, draws.light(random))?;
        let u = draws.light_place(random);
        let sample = points::sample(&self.scene.lights[number], from, u);
        let LightSample { toward, distance, .. } = sample;
        let light_pdf = probability * sample.pdf;
        let weight = if sample.is_delta { 1.0 } else { light_pdf / (light_pdf + vertex.pdf(toward)) };
        let unshadowed = vertex.value(toward).truncate() * sample.radiance_over_pdf * (weight / probability);
        if unshadowed == DVec3::ZERO {
            return None;
        }
        let ray = vertex.depart(toward);
        let through = self.fog.as_ref().map_or(1.0, |fog| fog.transmittance(&ray, distance));
        Some(Unshadowed { light: unshadowed.as_vec3() * through, ray, distance })
    }

    /// Radiance of the lamp that the path meets, with its weight.
    #[inline(never)]
    fn lamp(&self, number: usize, lamp: &AreaLight, hit: &Hit, path: &Path) -> Vec3 {
        let direction = path.ray.direction;
        let light_pdf = |from| points::lamp_pdf(lamp, from, direction, hit);
        let weight = match &path.turn {
            Turn::Collision { stretch, t, pdf, candidates } => {
                let densities = [*pdf, light_pdf(path.ray.origin), *candidates as f64];
                self.lamps.path_weight(self.scene, number, stretch, *t, densities)
            }
            _ => found_light::weight(self.scene, number, path.turned(), light_pdf),
        };
        (lamp.radiance_from(hit.normal, direction) * weight).as_vec3()
    }

    /// Radiance of the lights at infinity along the path, with its weight.
    #[inline(always)]
    fn surroundings(&self, path: &Path) -> Vec3 {
        let mut sum = DVec3::ZERO;
        let direction = path.ray.direction;
        for &number in &self.infinite {
            let light = &self.scene.lights[number];
            let weight = match &path.turn {
                Turn::Collision { stretch, t, pdf, candidates } => {
                    let light_pdf = light.pdf(direction);
                    let densities = [*pdf, light_pdf, *candidates as f64];
                    self.lamps.path_weight(self.scene, number, stretch, *t, densities)
                }
                _ => found_light::weight(self.scene, number, path.turned(), |_| light.pdf(direction)),
            };
            sum += light.radiance(direction) * weight;
        }
        sum.as_vec3()
    }

    /// What a camera ray meets first.
    #[cold]
    fn first_met(&self, collision: Option<f64>, hit: Option<&Hit>, ray: &Ray) -> Option<FirstMet> {
        if let (Some(distance), Some(fog)) = (collision, &self.fog) {
            return Some(FirstMet { distance, albedo: fog.albedo.as_dvec3(), ..FirstMet::default() });
        }
        let vertex = SurfaceVertex::new(self.scene, hit?, ray.direction, &Channels::Rgb);
        Some(vertex.first_met(self.scene, vertex.albedo().truncate()))
    }
}

/// Where a path's ray leads.
#[derive(Clone)]
struct Reached {
    /// Through the medium.
    stretch: Stretch,
    /// What it meets, as far as it matters.
    hit: Option<Hit>,
    /// Whether the path may come there.
    arrives: bool,
    /// The place there, if it is a surface and the path may come to it.
    vertex: Option<SurfaceVertex>,
}

/// A path under way.
#[derive(Clone, Copy)]
struct Path {
    ray: Ray,
    /// Number in (0, 1] by which the ray's collision is drawn; those of several branches are spread evenly.
    u: f32,
    throughput: Vec3,
    /// The part of the throughput that is due to refraction, which roulette leaves out.
    refraction: f64,
    turn: Turn,
    turns: u32,
    scatterings: u32,
}

/// How a path turned last.
#[derive(Clone, Copy)]
enum Turn {
    /// Not at all, or at a mirror: nothing else finds what it finds.
    None,
    /// At a surface, with this density into its direction.
    Surface { from: DVec3, pdf: f64 },
    /// At the distance `t` in a stretch of the medium, on which so many candidates were looked at.
    Collision { stretch: Stretch, t: f32, pdf: f64, candidates: usize },
}

impl Path {
    /// The camera's, which collides by `u`.
    #[inline(always)]
    fn from_camera(ray: Ray, u: f32) -> Self {
        let (throughput, refraction) = (Vec3::ONE, 1.0);
        Self { ray, u, throughput, refraction, turn: Turn::None, turns: 0, scatterings: 0 }
    }

    /// What found light is weighted by, but after a collision.
    #[inline(always)]
    fn turned(&self) -> Turned {
        match self.turn {
            Turn::Surface { from, pdf } => Some((from, pdf)),
            Turn::None | Turn::Collision { .. } => None,
        }
    }

    /// Ends a weak path with a probability that its survivors' weight makes up for.
    #[inline(always)]
    fn survives_roulette(&mut self, random: &mut Random) -> bool {
        let strength = f64::from(self.throughput.max_element() * BRANCHES as f32) / self.refraction;
        let probability = survival(strength, ROULETTE_THROUGHPUT, self.turns);
        if probability < 1.0 && random.f64() >= probability {
            return false;
        }
        self.throughput /= probability as f32;
        true
    }
}
