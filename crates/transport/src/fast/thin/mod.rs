//! Paths through one thin grid, with or without surfaces: smoke over a floor, a fire.
//!
//! Few paths collide in thin media, and what they bring is not the worst of the noise: that a path collides at all is, and
//! what shadow rays by ratio tracking find. So every ray is walked through in steps of a voxel or two once, and that
//! [profile] leads all that happens along it. Of
//!
//!   L(x,ω) = ∫₀^z T(x,y) [ μa(y) Le(y) + μs(y) Ls(y,ω) ] dy + T(x,z) Lo(z,ω)
//!
//! every ray gets an estimate of each of the three terms: emission, at places drawn in proportion to T and about the emitted
//! light; what lights send to a collision, which is forced; and what the surface sends out and reflects of the lights. Only
//! where the path goes on, for light that has turned more often, is chosen between the collision and the surface. The
//! reference integrator takes one choice for all of it, and has the same mean.

mod aim;
mod glow;
mod profile;

use glam::{DVec3, DVec4, Vec3};
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_optics::PhaseFunction;
use tyndall_scene::surface::Presence;
use tyndall_scene::{Channels, Density, Light, Ray, Scene, Volume};

use self::aim::{Ball, Cone};
use self::glow::Glow;
use self::profile::{LocalRay, Place, Profile};
use super::coarse::{Lattice, Rough};
use super::light_cache::LightCache;
use super::path_by_path::Tracer;
use super::sided::{Direct, light_of};
use super::volume::{FastGrid, Phase};
use crate::emission::source_at;
use crate::first_draws::FirstDraws;
use crate::found_light::{self, Turned};
use crate::path_layers::{FirstMet, PathLayers};
use crate::roulette::survival;
use crate::surface_vertex::{SurfaceTurn, SurfaceVertex};
use crate::way::Way;

/// Throughput below which roulette is played; survivors get twice this. Low, since the weights of forced collisions and of
/// paths that aim at the medium are small for good reason: 0.25 doubles the variance of scene D.
const ROULETTE_THROUGHPUT: f64 = 0.1;

/// Greatest optical thickness of a step of the profile by the grid's greatest value: beyond it a step is too rough.
const GREATEST_STEP: f64 = 0.3;

/// Greatest optical thickness, along an axis, of what counts as thin. Beyond it paths turn often, and many in flight at once
/// are the faster way.
const GREATEST_THICKNESS: f32 = 20.0;

/// Voxels that a shadow ray's steps are long.
const SHADOW_STRIDE: f32 = 2.5;

/// Places at which a ray's emission is taken: the camera's, and others.
const EMISSION_PLACES: [u32; 2] = [2, 1];

/// Part of the brightness that collisions are drawn by that is the same everywhere.
const EVEN_BRIGHTNESS: f32 = 0.2;

/// A scene of one thin grid.
pub(super) struct Thin<'a> {
    scene: &'a Scene,
    volume: &'a Volume,
    centre: DVec3,
    grid: FastGrid<'a>,
    mu_t: f32,
    phase: Phase<'a>,
    lattice: Lattice,
    /// μt around each place.
    mean_mu_t: Vec<f32>,
    /// About the light that arrives at each place, relative to its mean; none if nothing is known of it.
    brightness: Option<Vec<f32>>,
    /// The light that the medium sends out, if it does.
    glow: Option<Glow>,
    /// Number of draws of a light at a camera ray's vertices, and later.
    draws: [u32; 2],
    /// Where most of what surfaces get from the medium comes from.
    ball: Option<Ball>,
    /// Whether nothing but next-event estimation finds any of the lights.
    all_are_delta: bool,
}

impl<'a> Thin<'a> {
    /// The scene as this; `None` if it is another kind of scene. The light cache is that of the scene.
    pub fn new(scene: &'a Scene, centre: DVec3, rough: &Rough, cache: Option<&LightCache>) -> Option<Self> {
        let [volume] = scene.volumes.as_slice() else { return None };
        let Density::Grid(grid) = &volume.density else { return None };
        let medium = &volume.medium;
        let is_oriented = matches!(medium.phase_function, PhaseFunction::Sggx(_));
        let catches = scene.surfaces.shapes.iter().any(|shape| shape.is_shadow_catcher);
        if is_oriented || catches || !scene.boundaries.is_empty() || scene.lights.is_empty() {
            return None;
        }
        let voxels_per_length = volume.world_to_local.matrix3.determinant().abs().cbrt();
        let mut greatest: f32 = 0.0;
        grid.visit_cells(|_, bounds| greatest = greatest.max(bounds.max));
        if medium.mu_t * f64::from(greatest) / voxels_per_length > GREATEST_STEP {
            return None;
        }
        let lattice = rough.lattice;
        if lattice.greatest_thickness(&rough.mu_t) > GREATEST_THICKNESS {
            return None;
        }
        let source = volume.glows().then(|| {
            let source = |position: Vec3| source_at(volume, position.as_dvec3() + centre, DVec3::Z);
            lattice.spread(&lattice.table(|position| source(position).element_sum() as f32))
        });
        let brightness = cache.and_then(|cache| brightness(scene, &lattice, cache, centre));
        let lit = |(mu_t, light): (&f32, &f32)| mu_t * light;
        let ball = match (&source, &brightness) {
            (Some(source), _) => Ball::new(&lattice, source),
            (None, Some(light)) => {
                Ball::new(&lattice, &rough.mu_t.iter().zip(light).map(lit).collect::<Vec<f32>>())
            }
            (None, None) => Ball::new(&lattice, &rough.mu_t),
        };
        let glows = scene.lights.iter().any(|light| matches!(light, Light::Volume(_) | Light::Area(_)));
        let first = if glows { 4 } else { scene.lights.len().min(4) as u32 };
        Some(Self {
            scene,
            volume,
            centre,
            grid: FastGrid::new(grid, volume.world_to_local, centre),
            mu_t: medium.mu_t as f32,
            phase: Phase::new(&medium.phase_function),
            lattice,
            mean_mu_t: lattice.spread(&rough.mu_t),
            brightness,
            ball,
            glow: source.and_then(|source| Glow::new(lattice, source)),
            draws: [first, 1],
            all_are_delta: scene
                .lights
                .iter()
                .all(|light| matches!(light, Light::Distant(_) | Light::Point(_) | Light::Spot(_))),
        })
    }
}

impl Tracer for Thin<'_> {
    type Memory = Profile;

    fn scene(&self) -> &Scene {
        self.scene
    }

    fn memory(&self) -> Profile {
        Profile::new()
    }

    #[inline(always)]
    fn trace(&self, ray: Ray, profile: &mut Profile, mut first: FirstDraws, random: &mut Random) -> Sample {
        let scene = self.scene;
        let mut layers = PathLayers::<Vec3>::default();
        let mut path = Path { ray, throughput: Vec3::ONE, refraction: 1.0, turned: None, draws: 1 };
        let (mut turns, mut scatterings) = (0, 0);
        loop {
            let may_turn = scene.max_depth.is_none_or(|depth| turns < depth);
            let way = Way::trace(scene, &path.ray, f64::INFINITY, &Presence::default(), random);
            let is_crossed = self.walk(&path.ray, way.end, profile);
            let through = match is_crossed {
                true => path.throughput * profile.transmittance(&self.grid, self.mu_t, profile.end(), random),
                false => path.throughput,
            };
            let found = match &way.hit {
                Some(hit) => found_light::lamp(scene, hit, path.ray.direction, path.turned),
                None => found_light::surroundings(scene, path.ray.direction, path.turned),
            };
            layers.add(scatterings, through * found.as_vec3());
            if is_crossed && self.glow.is_some() {
                layers.emission += path.throughput * self.emission(&path, first, turns, profile, random);
            }
            let surface =
                way.hit.map(|hit| SurfaceVertex::new(scene, &hit, path.ray.direction, &Channels::Rgb));
            if turns == 0 {
                layers.first = self.first_met(&path.ray, way.end, surface.as_ref(), random);
            }
            if !may_turn {
                break;
            }

            let goes_on = self.chance_of_collision(is_crossed, profile, surface.as_ref());
            let draws = self.draws[usize::from(turns > 0)];
            let collision = is_crossed.then(|| self.collide(&path, profile, first.distance(random), random));
            if let Some(collision) = &collision {
                let value = |toward: DVec3| {
                    let phase = f64::from(self.phase.value(collision.before, toward.as_vec3()));
                    (DVec3::splat(phase), phase * goes_on)
                };
                let leave = |direction| Ray { origin: collision.position, direction };
                let [light, glow] = self.direct(collision.position, value, leave, draws, random);
                let weight = path.throughput * collision.weight;
                layers.add(scatterings + 1, weight * light);
                layers.emission += weight * glow;
            }
            let cone = surface.as_ref().and_then(|vertex| self.cone(vertex));
            if let Some(vertex) = surface.as_ref().filter(|vertex| !vertex.is_delta()) {
                let chance = 1.0 - goes_on;
                let value =
                    |toward| (vertex.value(toward).truncate(), pdf_onward(vertex, cone, toward) * chance);
                let leave = |direction| vertex.leave(scene, direction, &Presence::default()).0;
                let [light, glow] = self.direct(vertex.position(), value, leave, draws, random);
                layers.add(scatterings, through * light);
                layers.emission += through * glow;
            }

            turns += 1;
            path.draws = draws;
            match (collision, surface) {
                (Some(collision), _) if random.f64() < goes_on => {
                    path.throughput *= collision.weight / goes_on as f32;
                    if !path.survives_roulette(turns, random) {
                        break;
                    }
                    scatterings += 1;
                    let onward = self.phase.sample(collision.before, first.direction(random));
                    let pdf = f64::from(self.phase.value(collision.before, onward));
                    path.turned = Some((collision.position, pdf * goes_on));
                    path.ray = Ray { origin: collision.position, direction: onward.as_dvec3().normalize() };
                }
                (_, Some(vertex)) => {
                    let Some(onward) = go_on(&vertex, cone, random) else { break };
                    let chance = 1.0 - goes_on;
                    path.throughput = through * onward.weight.truncate().as_vec3() / chance as f32;
                    path.refraction *= onward.radiance_scale;
                    if !path.survives_roulette(turns, random) {
                        break;
                    }
                    path.turned = onward.pdf.map(|pdf| (vertex.position(), pdf * chance));
                    path.ray = vertex.leave(scene, onward.direction, &Presence::default()).0;
                }
                _ => break,
            }
            first = FirstDraws::Independent;
        }
        layers.into_sample(|colour| colour.as_dvec3())
    }
}

impl Thin<'_> {
    /// Walks along the ray through the grid; whether it meets it.
    #[inline(always)]
    fn walk(&self, ray: &Ray, end: f64, profile: &mut Profile) -> bool {
        let (origin, direction) = ((ray.origin - self.centre).as_vec3(), ray.direction.as_vec3());
        let Some(local) = LocalRay::new(&self.grid, origin, direction, end as f32) else { return false };
        let surroundings = |t: f32| {
            let place = origin + direction * t;
            let light = self.brightness.as_ref().map_or(1.0, |table| self.lattice.nearest(table, place));
            [light, self.lattice.nearest(&self.mean_mu_t, place)]
        };
        let source = self.glow.as_ref();
        let source =
            source.map(|glow| move |t: f32| self.lattice.nearest(&glow.source, origin + direction * t));
        profile.march(&self.grid, self.mu_t, local, surroundings, source);
        true
    }

    /// The medium as a surface sees it, if it draws its directions evenly enough to be helped.
    #[inline(always)]
    fn cone(&self, vertex: &SurfaceVertex) -> Option<Cone> {
        let ball = self.ball.as_ref().filter(|_| vertex.is_matte())?;
        ball.seen_from((vertex.position() - self.centre).as_vec3())
    }

    /// Light that the medium sends out along the path's ray.
    #[inline(always)]
    fn emission(
        &self,
        path: &Path,
        first: FirstDraws,
        turns: u32,
        profile: &Profile,
        random: &mut Random,
    ) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let places = EMISSION_PLACES[usize::from(turns > 0)];
        let shift = first.emission(random);
        for place in 0..places {
            let u = (place as f32 + shift) / places as f32;
            let Place { t, over_pdf } = profile.emission(u);
            let position = path.ray.at(f64::from(t));
            let source = source_at(self.volume, position, path.ray.direction);
            if source == DVec3::ZERO {
                continue;
            }
            let weight =
                path.turned.map_or(1.0, |(from, pdf)| self.path_weight(from, position, pdf, path.draws));
            let transmittance = profile.transmittance(&self.grid, self.mu_t, t, random);
            sum += (source * weight).as_vec3() * (transmittance * over_pdf / places as f32);
        }
        sum
    }

    /// A forced collision of the path.
    #[inline(always)]
    fn collide(&self, path: &Path, profile: &Profile, u: f32, random: &mut Random) -> Collision {
        let Place { t, over_pdf } = profile.collision(u);
        let position = path.ray.at(f64::from(t));
        let density = self.volume.density_at(self.volume.world_to_local.transform_point3(position)) as f32;
        let albedo = self.volume.albedo_at(position).as_vec3();
        let weight = match density > 0.0 {
            true => self.mu_t * density * over_pdf * profile.transmittance(&self.grid, self.mu_t, t, random),
            false => 0.0,
        };
        Collision { position, before: path.ray.direction.as_vec3(), weight: albedo * weight }
    }

    /// Probability with which the path goes on from a collision and not from the surface: about its part of the light.
    #[inline(always)]
    fn chance_of_collision(
        &self,
        is_crossed: bool,
        profile: &Profile,
        surface: Option<&SurfaceVertex>,
    ) -> f64 {
        let Some(surface) = surface else { return 1.0 };
        if !is_crossed {
            return 0.0;
        }
        let albedo = self.volume.medium.albedo.max_element();
        let scattered = f64::from(1.0 - profile.rough_transmittance()) * albedo;
        let reflectance = surface.albedo().truncate().max_element().max(0.05);
        let reflected = f64::from(profile.rough_transmittance()) * reflectance;
        (scattered / (scattered + reflected)).clamp(0.05, 0.95)
    }

    /// Next-event estimation at a vertex, by so many draws of a light: what media scatter or surfaces reflect of other
    /// lights, and of glowing media.
    #[inline(always)]
    fn direct(
        &self,
        from: DVec3,
        value: impl Fn(DVec3) -> (DVec3, f64),
        leave: impl Fn(DVec3) -> Ray,
        draws: u32,
        random: &mut Random,
    ) -> [Vec3; 2] {
        let mut sums = [Vec3::ZERO; 2];
        for draw in 0..draws {
            let choice = (f64::from(draw) + random.f64()) / f64::from(draws);
            let Some(chosen) = self.choose_light(from, choice, draw, draws) else { continue };
            let direct = match &self.scene.lights[chosen.0] {
                Light::Volume(_) => self.draw_glow(chosen, from, &value, draws, random),
                _ => light_of(self.scene, chosen, from, &value, FirstDraws::Independent, random),
            };
            let Some(Direct { unshadowed, is_glow, toward, distance, .. }) = direct else { continue };
            if unshadowed == Vec3::ZERO {
                continue;
            }
            let ray = leave(toward);
            let way = Way::connect(self.scene, &ray, distance, &Presence::default(), random);
            if way.is_none() {
                continue;
            }
            let (origin, direction) = ((ray.origin - self.centre).as_vec3(), toward.as_vec3());
            let through = match LocalRay::new(&self.grid, origin, direction, distance as f32) {
                Some(local) => local.transmittance(&self.grid, self.mu_t, SHADOW_STRIDE, random),
                None => 1.0,
            };
            sums[usize::from(is_glow)] += unshadowed * (through / draws as f32);
        }
        sums
    }

    /// The light for a draw and its probability. Where nothing but draws finds lights, and there are as many draws, each has
    /// its own.
    #[inline(always)]
    fn choose_light(&self, from: DVec3, choice: f64, draw: u32, draws: u32) -> Option<(usize, f64)> {
        if self.all_are_delta && self.scene.lights.len() == draws as usize {
            return Some((draw as usize, 1.0 / f64::from(draws)));
        }
        self.scene.choose_light(from, choice)
    }

    /// A place of the medium as a light.
    #[inline(always)]
    fn draw_glow(
        &self,
        (light, probability): (usize, f64),
        from: DVec3,
        value: impl Fn(DVec3) -> (DVec3, f64),
        draws: u32,
        random: &mut Random,
    ) -> Option<Direct> {
        let glow = self.glow.as_ref()?;
        let (place, density) = glow.draw(random);
        let position = place.as_dvec3() + self.centre;
        let offset = position - from;
        let distance = offset.length();
        let toward = offset / distance;
        if density <= 0.0 || !toward.is_finite() {
            return None;
        }
        let (value, path_pdf) = value(toward);
        let weight = 1.0 - glow.path_weight(path_pdf, probability * f64::from(draws), from, position);
        let source = source_at(self.volume, position, toward);
        let arriving = source / (density * distance * distance * probability);
        let unshadowed = (value * arriving * weight).as_vec3();
        Some(Direct { light, unshadowed, arriving: arriving.as_vec3(), is_glow: true, toward, distance })
    }

    /// Weight of what the medium sends out, found by a path that turned at `from`.
    #[inline(always)]
    fn path_weight(&self, from: DVec3, position: DVec3, path_pdf: f64, draws: u32) -> f64 {
        let (Some(light), Some(glow)) = (self.scene.light_of_volume(0), &self.glow) else { return 1.0 };
        let probability = self.scene.light_probability(light, from) * f64::from(draws);
        glow.path_weight(path_pdf, probability, from, position)
    }

    /// What a camera ray meets first, by delta tracking.
    fn first_met(
        &self,
        ray: &Ray,
        end: f64,
        surface: Option<&SurfaceVertex>,
        random: &mut Random,
    ) -> Option<FirstMet> {
        if let Some(distance) = self.first_collision(ray, end, random) {
            let albedo = self.volume.albedo_at(ray.at(distance));
            return Some(FirstMet { distance, albedo, ..FirstMet::default() });
        }
        surface.map(|vertex| vertex.first_met(self.scene, vertex.albedo().truncate()))
    }

    fn first_collision(&self, ray: &Ray, end: f64, random: &mut Random) -> Option<f64> {
        use std::ops::ControlFlow::{Break, Continue};
        let Density::Grid(grid) = &self.volume.density else { return None };
        let local = self.volume.local_ray(ray);
        let mu_t = self.volume.medium.mu_t;
        let mut tau = random.exponential_f64();
        let flight = grid.segments(local.origin, local.direction, (0.0, end), |segment| {
            let majorant = mu_t * f64::from(segment.bounds.max.max(0.0));
            let mut t = segment.start;
            while tau < majorant * (segment.end - t) {
                t += tau / majorant;
                tau = random.exponential_f64();
                if random.f64() * majorant < mu_t * grid.value(local.at(t)) {
                    return Break(t);
                }
            }
            tau -= majorant * (segment.end - t);
            Continue(())
        });
        match flight {
            Break(t) => Some(t),
            Continue(()) => None,
        }
    }
}

/// Density with which paths go on from a surface towards a direction, 1/sr.
#[inline(always)]
fn pdf_onward(vertex: &SurfaceVertex, cone: Option<Cone>, toward: DVec3) -> f64 {
    let pdf = vertex.pdf(toward);
    cone.map_or(pdf, |cone| 0.5 * (pdf + cone.pdf(toward)))
}

/// How a path goes on from a surface.
#[inline(always)]
fn go_on(vertex: &SurfaceVertex, cone: Option<Cone>, random: &mut Random) -> Option<SurfaceTurn> {
    let Some(cone) = cone else { return vertex.sample(random) };
    let direction = if random.f64() < 0.5 { cone.draw(random) } else { vertex.sample(random)?.direction };
    let pdf = pdf_onward(vertex, Some(cone), direction);
    let value = vertex.value(direction);
    (pdf > 0.0 && value != DVec4::ZERO).then(|| SurfaceTurn {
        direction,
        weight: value / pdf,
        pdf: Some(pdf),
        radiance_scale: 1.0,
    })
}

/// A collision that a ray was made to have.
struct Collision {
    position: DVec3,
    /// The direction of the ray.
    before: Vec3,
    /// T μt albedo over its density.
    weight: Vec3,
}

/// A path under way.
struct Path {
    ray: Ray,
    throughput: Vec3,
    /// The part of the throughput that is due to refraction, which roulette leaves out.
    refraction: f64,
    turned: Turned,
    /// How often a light was drawn there.
    draws: u32,
}

impl Path {
    /// Ends a weak path with a probability that its survivors' weight makes up for.
    #[inline(always)]
    fn survives_roulette(&mut self, turns: u32, random: &mut Random) -> bool {
        let strength = f64::from(self.throughput.abs().max_element()) / self.refraction;
        let probability = survival(strength, ROULETTE_THROUGHPUT, turns);
        if probability < 1.0 && random.f64() >= probability {
            return false;
        }
        self.throughput /= probability as f32;
        true
    }
}

/// About the light that arrives at each place, relative to its mean, with something even added to it.
fn brightness(scene: &Scene, lattice: &Lattice, cache: &LightCache, centre: DVec3) -> Option<Vec<f32>> {
    let even: f64 =
        scene.lights.iter().filter(|light| light.is_infinite() && !matches!(light, Light::Sun(_))).count()
            as f64;
    let table = lattice.table(|position| {
        let from = position.as_dvec3() + centre;
        let light = |(number, light): (usize, &Light)| {
            let sample = light.sample(from, [0.5, 0.5]);
            let through = cache.transmittance(number, position, sample.toward.as_vec3());
            through.map_or(0.0, |through| through * sample.radiance_over_pdf.max_element() as f32)
        };
        scene.lights.iter().enumerate().map(light).sum()
    });
    let mean = table.iter().sum::<f32>() / table.len() as f32;
    let share = (EVEN_BRIGHTNESS + even as f32).min(1.0);
    (mean > 0.0 && mean.is_finite())
        .then(|| table.into_iter().map(|light| share + (1.0 - share) * (light / mean).min(20.0)).collect())
}
