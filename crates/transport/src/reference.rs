//! The reference integrator: a path tracer of the volume rendering equation, one path at a time, in f64.
//!
//!   L(x,ω) = ∫₀^z T(x,y) [ μa(y) Le(y) + μs(y) Ls(y,ω) ] dy + T(x,z) Lo(z,ω),   Ls(y,ω) = ∫ f_p(ω,ω′) L(y,ω′) dω′
//!
//! where Lo is what surfaces send out and reflect, Lo(z,ω) = Le(z,ω) + ∫ f(ω,ω′) |cos θ′| L(z,ω′) dω′, or, where there is no
//! surface, the light of the surroundings. It is plain to read and is the oracle for every faster way. Term by term:
//! - a ray's [way](Way) is the volumes that it crosses and the surface z at which it ends;
//! - y is drawn with density μt·T by distance sampling, so T μt cancels and a collision leaves
//!   (1 − albedo)·Le + albedo·Ls, while a ray that goes through without one has met T·Lo;
//! - light that is given per length is gathered on the way to that collision (see [`emission`](crate::emission));
//! - Ls, and the integral in Lo, are split between next-event estimation (a light is drawn, the transmittance towards it
//!   estimated) and the continued path (a direction is drawn from the phase function or from f), joined by multiple
//!   importance sampling with the balance heuristic (Veach 1997, chapter 9);
//! - a path ends when it leaves, at `max_depth` turns, or by Russian roulette on its throughput.
//!
//! Any pair of a distance sampler and a transmittance estimator fits in ([`Estimators`]). One whose flights have weights
//! multiplies the throughput by them; where a flight has both a collision and a part that escapes to a surface, the path
//! goes on to one of them. Negative weights count in roulette by their size.

use glam::DVec3;
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_scene::surface::Presence;
use tyndall_scene::{Channels, Hit, Light, Ray, Scene};

use crate::emission::{
    Glow, draw_glow, extinction_at, light_weight, path_weight, source_at, weighted_emission_along,
};
use crate::equiangular_light::{Found, LitSegment};
use crate::estimators::{Estimators, SceneFlight};
use crate::found_light::{self, Turned};
use crate::path_layers::{DirectLight, FirstMet, PathLayers};
use crate::roulette::survival;
use crate::shadow_catcher;
use crate::surface_vertex::SurfaceVertex;
use crate::way::Way;

/// Throughput below which roulette is played.
const ROULETTE_THROUGHPUT: f64 = 0.25;

/// One estimate of the radiance that arrives along `ray`, sorted into the film's layers.
pub fn trace(scene: &Scene, ray: Ray, random: &mut Random) -> Sample {
    trace_with(scene, Estimators::default(), ray, random)
}

/// The same with chosen estimators, which must be [valid](Estimators::validate) for the scene.
pub fn trace_with(scene: &Scene, estimators: Estimators, ray: Ray, random: &mut Random) -> Sample {
    let presence = scene.presence_at_camera(ray.origin);
    let mut layers = PathLayers::<DVec3>::default();
    let mut path = Path { ray, presence, throughput: DVec3::ONE, refraction: 1.0, turn: None };
    let mut turns = 0;
    let mut scatterings = 0;
    let shines = scene.volumes.iter().any(|volume| volume.medium.emission_per_length != DVec3::ZERO);

    loop {
        let may_turn = scene.max_depth.is_none_or(|depth| turns < depth);
        let way = Way::trace(scene, &path.ray, f64::INFINITY, &path.presence, random);
        let flight = estimators.fly(scene, &path.ray, &way, random);
        if turns == 0 || shines {
            let collision = estimators.analog_collision(scene, &path.ray, &way, &flight, random);
            if turns == 0 {
                layers.first = first_met(scene, &path.ray, &way, collision, random);
            }
            if shines {
                let end = collision.map_or(way.end, |(distance, _)| distance);
                layers.emission += path.throughput * path.emission_along(scene, &way, end, random);
            }
        }
        if flight.escape != 0.0 {
            let arriving = match &way.hit {
                None => found_light::surroundings(scene, path.ray.direction, path.turned()),
                Some(hit) => path.lamp_radiance(scene, hit),
            };
            layers.add(scatterings, path.throughput * flight.escape * arriving);
        }
        let lit_segment = estimators.lit_segment(scene, &path.ray, &way).filter(|_| may_turn);
        if let Some(segment) = &lit_segment {
            let lit = segment.in_scattered(scene, estimators, random);
            layers.add(scatterings + 1, path.throughput * lit);
        }

        match Next::choose(&flight, &way, random) {
            Next::Nothing => break,
            Next::Collision { distance, volume: number, weight } => {
                path.throughput *= weight;
                let volume = &scene.volumes[number];
                let position = path.ray.at(distance);
                let albedo = volume.albedo_at(position);

                let emitted = (DVec3::ONE - albedo) * volume.emission_at(position);
                if emitted != DVec3::ZERO {
                    layers.emission += path.throughput * emitted * path.glow_weight(scene, number, position);
                }

                if !may_turn {
                    break;
                }
                path.throughput *= albedo;
                if !path.survives_roulette(turns, random) {
                    break;
                }
                turns += 1;
                scatterings += 1;
                path.presence = way.presence_at(scene, path.ray.direction, distance);

                let lit = lit_segment.map(|segment| (segment, distance));
                let shadow = Shadow { scene, estimators, segment: lit };
                let phase_function = &volume.medium.phase_function;
                let before = path.ray.direction;
                let vertex = Vertex {
                    position,
                    value: |toward| {
                        let phase = phase_function.value(before, toward);
                        (DVec3::splat(phase), phase)
                    },
                    leave: |direction| (Ray { origin: position, direction }, path.presence.clone()),
                };
                layers.add_direct(scatterings, path.throughput, shadow.next_event(&vertex, random));

                let onward = phase_function.sample(before, [random.f64(), random.f64()]);
                let pdf = phase_function.value(before, onward);
                path.turn = Some(Turn { from: position, pdf, segment: shadow.segment });
                path.ray = Ray { origin: position, direction: onward };
            }
            Next::Surface { hit, weight } => {
                path.throughput *= weight;
                let surface = SurfaceVertex::new(scene, &hit, path.ray.direction, &Channels::Rgb);
                path.presence = way.presence_at(scene, path.ray.direction, hit.t);
                let is_caught = turns == 0 && surface.is_shadow_catcher(scene);
                if is_caught || !may_turn {
                    break;
                }
                turns += 1;

                if !surface.is_delta() {
                    let shadow = Shadow { scene, estimators, segment: None };
                    let vertex = Vertex {
                        position: surface.position(),
                        value: |toward| (surface.value(toward).truncate(), surface.pdf(toward)),
                        leave: |direction| surface.leave(scene, direction, &path.presence),
                    };
                    layers.add_direct(scatterings, path.throughput, shadow.next_event(&vertex, random));
                }

                let Some(onward) = surface.sample(random) else { break };
                path.throughput *= onward.weight.truncate();
                path.refraction *= onward.radiance_scale;
                if !path.survives_roulette(turns, random) {
                    break;
                }
                path.turn = onward.pdf.map(|pdf| Turn { from: surface.position(), pdf, segment: None });
                (path.ray, path.presence) = surface.leave(scene, onward.direction, &path.presence);
            }
        }
    }
    layers.into_sample(|colour| colour)
}

/// What a camera ray meets first.
fn first_met(
    scene: &Scene,
    ray: &Ray,
    way: &Way,
    collision: Option<(f64, usize)>,
    random: &mut Random,
) -> Option<FirstMet> {
    if let Some((distance, volume)) = collision {
        let albedo = scene.volumes[volume].albedo_at(ray.at(distance));
        return Some(FirstMet { distance, albedo, ..FirstMet::default() });
    }
    let hit = way.hit?;
    let surface = SurfaceVertex::new(scene, &hit, ray.direction, &Channels::Rgb);
    let mut first = surface.first_met(scene, surface.albedo().truncate());
    if surface.is_shadow_catcher(scene) {
        let presence = way.presence_at(scene, ray.direction, hit.t);
        first.caught = Some(shadow_catcher::reflected(scene, &surface, &presence, random));
    }
    Some(first)
}

/// Where a path last turned, and the density with which it did so into its direction.
struct Turn<'a> {
    from: DVec3,
    pdf: f64,
    /// The stretch of the path up to there, and its distance, if lights are sampled along it as well.
    segment: Option<(LitSegment<'a>, f64)>,
}

/// A path under way.
struct Path<'a> {
    ray: Ray,
    /// The volumes that are present where the ray begins.
    presence: Presence,
    throughput: DVec3,
    /// The part of the throughput that is due to refraction, which roulette leaves out.
    refraction: f64,
    /// None for the camera's own ray and after a mirror: nothing else finds what it finds.
    turn: Option<Turn<'a>>,
}

impl Path<'_> {
    /// What found light is weighted by.
    fn turned(&self) -> Turned {
        self.turn.as_ref().map(|turn| (turn.from, turn.pdf))
    }

    /// Le of a surface that is a lamp. It competes with light sampled along the path's last stretch as well, if that is
    /// wanted.
    fn lamp_radiance(&self, scene: &Scene, hit: &Hit) -> DVec3 {
        let direction = self.ray.direction;
        let Some(Turn { from, pdf, segment: Some((segment, distance)) }) = &self.turn else {
            return found_light::lamp(scene, hit, direction, self.turned());
        };
        let Some((number, lamp)) = scene.lamp(hit) else { return DVec3::ZERO };
        let cos = direction.dot(hit.normal).abs();
        let light_pdf = hit.position.distance_squared(*from) / (cos * lamp.area());
        let found = Found { light: number, place: hit.position, place_pdf: light_pdf, path_pdf: *pdf };
        lamp.radiance_from(hit.normal, direction) * segment.path_weight(scene, &found, *distance)
    }

    /// Light that volumes send out per length, up to the distance `end`.
    fn emission_along(&self, scene: &Scene, way: &Way, end: f64, random: &mut Random) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for span in way.spans.iter().filter(|span| span.start < end) {
            let volume = &scene.volumes[span.volume];
            let weight = |t: f64| self.glow_weight(scene, span.volume, self.ray.at(t));
            let is_light = self.turn.is_some() && scene.light_of_volume(span.volume).is_some();
            let weight: Option<&dyn Fn(f64) -> f64> = if is_light { Some(&weight) } else { None };
            let range = (span.start, span.end.min(end));
            sum += weighted_emission_along(volume, &self.ray, range, weight, random);
        }
        sum
    }

    /// Weight of the glow of a volume at `position`, found by this path, against next-event estimation.
    fn glow_weight(&self, scene: &Scene, volume: usize, position: DVec3) -> f64 {
        match &self.turn {
            Some(turn) => path_weight(scene, volume, turn.from, position, turn.pdf),
            None => 1.0,
        }
    }

    /// Ends a weak path with a probability that its survivors' weight makes up for.
    fn survives_roulette(&mut self, turns: u32, random: &mut Random) -> bool {
        let strength = self.throughput.abs().max_element() / self.refraction;
        let probability = survival(strength, ROULETTE_THROUGHPUT, turns);
        if probability < 1.0 && random.f64() >= probability {
            return false;
        }
        self.throughput /= probability;
        true
    }
}

/// What a path does after a flight.
enum Next {
    Nothing,
    Collision { distance: f64, volume: usize, weight: f64 },
    Surface { hit: Hit, weight: f64 },
}

impl Next {
    fn choose(flight: &SceneFlight, way: &Way, random: &mut Random) -> Next {
        match (flight.collision, way.hit.filter(|_| flight.escape != 0.0)) {
            (None, None) => Next::Nothing,
            (Some((distance, volume)), None) => Next::Collision { distance, volume, weight: flight.weight },
            (None, Some(hit)) => Next::Surface { hit, weight: flight.escape },
            (Some((distance, volume)), Some(hit)) => {
                let [collides, escapes] = [flight.weight.abs(), flight.escape.abs()];
                let probability = collides / (collides + escapes);
                if random.f64() < probability {
                    Next::Collision { distance, volume, weight: flight.weight / probability }
                } else {
                    Next::Surface { hit, weight: flight.escape / (1.0 - probability) }
                }
            }
        }
    }
}

/// A place where a path turns, as next-event estimation sees it.
struct Vertex<V, L> {
    position: DVec3,
    /// Of a direction: the phase function or f |cos θ|, and the density with which the path goes on there.
    value: V,
    /// The ray in a direction, and the volumes that are present where it begins.
    leave: L,
}

/// What next-event estimation has to know.
struct Shadow<'a> {
    scene: &'a Scene,
    estimators: Estimators,
    /// The stretch of the path up to the collision, and its distance, if lights are sampled along it as well.
    segment: Option<(LitSegment<'a>, f64)>,
}

impl Shadow<'_> {
    /// Next-event estimation of ∫ f L dω over the light that arrives unscattered at the vertex.
    fn next_event<V, L>(&self, vertex: &Vertex<V, L>, random: &mut Random) -> DirectLight<DVec3>
    where
        V: Fn(DVec3) -> (DVec3, f64),
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let Some((number, probability)) = self.scene.choose_light(vertex.position, random.f64()) else {
            return DirectLight::default();
        };
        let is_glow = matches!(self.scene.lights[number], Light::Volume(_));
        let radiance = if is_glow {
            self.glow(vertex, number, probability, random)
        } else {
            self.lamp_or_surroundings(vertex, number, probability, random)
        };
        DirectLight { radiance, is_glow }
    }

    /// That of a light that is no volume.
    fn lamp_or_surroundings<V, L>(
        &self,
        vertex: &Vertex<V, L>,
        number: usize,
        probability: f64,
        random: &mut Random,
    ) -> DVec3
    where
        V: Fn(DVec3) -> (DVec3, f64),
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let light = &self.scene.lights[number];
        let u = [random.f64(), random.f64()];
        let segment = self.segment.as_ref().filter(|_| LitSegment::samples(light));
        let sample = match segment {
            Some(_) => LitSegment::sample(light, vertex.position, u),
            None => light.sample(vertex.position, u),
        };
        if sample.radiance_over_pdf == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let (value, path_pdf) = (vertex.value)(sample.toward);
        let weight = match segment {
            Some((segment, distance)) => {
                let place = vertex.position + sample.toward * sample.distance;
                let (place_pdf, path_pdf) = if sample.is_delta { (1.0, 0.0) } else { (sample.pdf, path_pdf) };
                let found = Found { light: number, place, place_pdf, path_pdf };
                segment.collision_weight(self.scene, &found, *distance)
            }
            None if sample.is_delta => 1.0,
            None => {
                let light_pdf = probability * sample.pdf;
                light_pdf / (light_pdf + path_pdf)
            }
        };
        let unshadowed = value * sample.radiance_over_pdf * (weight / probability);
        self.shadowed(vertex, unshadowed, sample.toward, sample.distance, random)
    }

    /// The same for a volume that glows: ∫ f T j/d² dV over its source j.
    fn glow<V, L>(&self, vertex: &Vertex<V, L>, number: usize, probability: f64, random: &mut Random) -> DVec3
    where
        V: Fn(DVec3) -> (DVec3, f64),
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let Light::Volume(light) = &self.scene.lights[number] else { return DVec3::ZERO };
        let u = [random.f64(), random.f64(), random.f64()];
        let Some(glow) = draw_glow(light, vertex.position, u) else { return DVec3::ZERO };
        let Glow { position, toward, distance, density } = glow;
        let volume = &self.scene.volumes[light.volume()];
        let (value, path_pdf) = (vertex.value)(toward);
        let mu_t = extinction_at(volume, position, toward);
        let weight = light_weight(volume, &glow, mu_t, probability, path_pdf);
        let source = source_at(volume, position, mu_t);
        let unshadowed = value * source * (weight / (density * probability));
        self.shadowed(vertex, unshadowed, toward, distance, random)
    }

    /// What of the light of a shadow ray gets through.
    fn shadowed<V, L>(
        &self,
        vertex: &Vertex<V, L>,
        unshadowed: DVec3,
        toward: DVec3,
        distance: f64,
        random: &mut Random,
    ) -> DVec3
    where
        L: Fn(DVec3) -> (Ray, Presence),
    {
        if unshadowed == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let (ray, presence) = (vertex.leave)(toward);
        let Some(way) = Way::connect(self.scene, &ray, distance, &presence, random) else {
            return DVec3::ZERO;
        };
        unshadowed * self.estimators.transmittance(self.scene, &ray, &way, random)
    }
}
