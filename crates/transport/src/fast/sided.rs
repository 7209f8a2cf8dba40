//! The part of a path that surfaces need: its rays in f64, what they meet, and which volumes are present.
//!
//! Surfaces are met rarely beside the steps through grids, and thin walls want all digits; so this part is the reference
//! integrator's own, and only the tracking between surfaces runs in the pool.

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;
use tyndall_scene::surface::Presence;
use tyndall_scene::{Channels, Hit, Light, Ray, Scene};

use super::split::SidedFork;
use super::volume::FastScene;
use crate::emission::{Glow, draw_glow, light_weight};
use crate::first_draws::FirstDraws;
use crate::surface_vertex::SurfaceVertex;
use crate::way::{Span, Way, is_plain};

/// What a path knows beside its place in the pool, in scenes with surfaces.
#[derive(Debug, Clone)]
pub(super) struct Sided {
    /// The path's own ray.
    pub ray: Ray,
    /// The volumes that are present where it begins; not kept up amid plain surfaces, where all are.
    pub presence: Presence,
    /// What it meets.
    pub way: Way,
    /// What the shadow ray meets.
    pub shadow: Way,
    /// The part of the throughput that is due to refraction, which roulette leaves out.
    pub refraction: f64,
    /// Lights that are still to be looked at from the surface: what each may bring, its direction and distance.
    pub waiting: Vec<(Vec3, Vec3, f32)>,
    /// Where the path has split.
    pub fork: Option<Box<SidedFork>>,
    /// Whether the scene's surfaces are [plain](crate::way::is_plain).
    is_plain: bool,
}

/// Lights that are all looked at from the first surface, if there are no more, and no others.
const FEW: usize = 4;

/// The lights of which every one is looked at from the first surface: points and parallel light, if that is all there is, and
/// no surface is passed through. Paths do not find these, so that no weight has to know of it.
pub(super) fn lights_seen_at_once(scene: &Scene) -> Vec<usize> {
    let lights = 0..scene.lights.len();
    let drawn: Vec<usize> = lights.filter(|&light| scene.light_probabilities[light] > 0.0).collect();
    let is_delta =
        |&light: &usize| matches!(scene.lights[light], Light::Point(_) | Light::Spot(_) | Light::Distant(_));
    let all = drawn.len() <= FEW && drawn.iter().all(is_delta) && is_plain(scene);
    if all { drawn } else { Vec::new() }
}

/// What the next event at a vertex may bring.
pub(super) struct Direct {
    /// Number of the light.
    pub light: usize,
    /// Radiance times what the vertex makes of it, over the densities; without what is in the way.
    pub unshadowed: Vec3,
    /// The light alone, with its weight and over its density: what an even vertex would bring.
    pub arriving: Vec3,
    /// Whether a medium sent it out.
    pub is_glow: bool,
    pub toward: DVec3,
    pub distance: f64,
}

impl Sided {
    pub fn new(is_plain: bool) -> Self {
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };
        let presence = Presence::default();
        let [way, shadow] = [Way::nothing(), Way::nothing()];
        Self { ray, presence, way, shadow, refraction: 1.0, waiting: Vec::new(), fork: None, is_plain }
    }

    /// Where the volumes are that the current ray goes through; `None` if all are present all the way.
    pub fn spans(&self, is_shadow: bool) -> Option<&[Span]> {
        if self.is_plain {
            return None;
        }
        Some(if is_shadow { &self.shadow.spans } else { &self.way.spans })
    }

    /// Finds what the path's ray meets.
    #[inline(always)]
    pub fn look_ahead(&mut self, scene: &Scene, random: &mut Random) {
        if self.is_plain {
            self.way.follow_plainly(scene, &self.ray);
        } else {
            self.way.follow(scene, &self.ray, f64::INFINITY, &self.presence, random);
        }
    }

    /// Moves to the collision at the distance `t`; its place.
    pub fn collide(&mut self, scene: &Scene, t: f64) -> DVec3 {
        if !self.is_plain {
            self.presence = self.way.presence_at(scene, self.ray.direction, t);
        }
        self.ray.origin = self.ray.at(t);
        self.ray.origin
    }

    /// The surface at the end of the way.
    pub fn vertex(&mut self, scene: &Scene, hit: &Hit) -> SurfaceVertex {
        if !self.is_plain {
            self.presence = self.way.presence_at(scene, self.ray.direction, hit.t);
        }
        SurfaceVertex::new(scene, hit, self.ray.direction, &Channels::Rgb)
    }

    /// Goes on from a surface in `direction`.
    pub fn leave(&mut self, scene: &Scene, vertex: &SurfaceVertex, direction: DVec3) {
        if self.is_plain {
            self.ray = vertex.depart(direction);
        } else {
            (self.ray, self.presence) = vertex.leave(scene, direction, &self.presence);
        }
    }

    /// Whether the shadow ray from a collision gets past the surfaces.
    pub fn sees(&mut self, scene: &Scene, toward: DVec3, distance: f64, random: &mut Random) -> bool {
        let ray = Ray { origin: self.ray.origin, direction: toward };
        if self.is_plain {
            return !scene.surfaces.stand_in(&ray, distance);
        }
        self.shadow.follow(scene, &ray, distance, &self.presence, random);
        self.shadow.hit.is_none()
    }

    /// The same from a surface.
    pub fn sees_from(
        &mut self,
        scene: &Scene,
        vertex: &SurfaceVertex,
        toward: DVec3,
        distance: f64,
        random: &mut Random,
    ) -> bool {
        if self.is_plain {
            return !scene.surfaces.stand_in(&vertex.depart(toward), distance);
        }
        let (ray, presence) = vertex.leave(scene, toward, &self.presence);
        self.shadow.follow(scene, &ray, distance, &presence, random);
        self.shadow.hit.is_none()
    }
}

/// Draws a light for a vertex at `from`, of which `value` gives f or the phase function and the density of the path there.
#[inline(always)]
pub(super) fn draw_light(
    scene: &FastScene<'_>,
    from: DVec3,
    value: impl Fn(DVec3) -> (DVec3, f64),
    draws: FirstDraws,
    random: &mut Random,
) -> Option<Direct> {
    let (number, probability) = scene.scene.choose_light(from, draws.light(random))?;
    light_of(scene, (number, probability), from, value, draws, random)
}

/// The same of the light of this number, drawn with this probability.
#[inline(always)]
pub(super) fn light_of(
    fast_scene: &FastScene<'_>,
    (number, probability): (usize, f64),
    from: DVec3,
    value: impl Fn(DVec3) -> (DVec3, f64),
    draws: FirstDraws,
    random: &mut Random,
) -> Option<Direct> {
    let scene = fast_scene.scene;
    let light = &scene.lights[number];
    if let Light::Volume(light) = light {
        let u = draws.light_place_inside(random);
        let glow = draw_glow(light, from, u)?;
        let Glow { position, toward, distance, density } = glow;
        let (value, path_pdf) = value(toward);
        let (mu_t, source) = fast_scene.extinction_and_source(light.volume(), position, toward, random);
        let weight = light_weight(&scene.volumes[light.volume()], &glow, mu_t, probability, path_pdf);
        let arriving = source * (weight / (density * probability));
        let unshadowed = (value * arriving).as_vec3();
        let arriving = arriving.as_vec3();
        return Some(Direct { light: number, unshadowed, arriving, is_glow: true, toward, distance });
    }
    let sample = light.sample(from, draws.light_place(random));
    let (value, path_pdf) = value(sample.toward);
    let light_pdf = probability * sample.pdf;
    let weight = if sample.is_delta { 1.0 } else { light_pdf / (light_pdf + path_pdf) };
    let arriving = sample.radiance_over_pdf * (weight / probability);
    let unshadowed = (value * arriving).as_vec3();
    let (arriving, toward) = (arriving.as_vec3(), sample.toward);
    Some(Direct { light: number, unshadowed, arriving, is_glow: false, toward, distance: sample.distance })
}
