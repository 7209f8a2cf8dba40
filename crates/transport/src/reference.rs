//! The reference integrator: a path tracer of the volume rendering equation, one path at a time, in f64.
//!
//!   L(x,ω) = ∫₀^z T(x,y) [ μa(y) Le(y) + μs(y) Ls(y,ω) ] dy + T(x,z) Lo(ω),   Ls(y,ω) = ∫ f_p(ω,ω′) L(y,ω′) dω′
//!
//! It is plain to read and is the oracle for every faster way. Term by term:
//! - y is drawn with density μt·T by distance sampling, so T μt cancels and a collision leaves
//!   (1 − albedo)·Le + albedo·Ls, while a ray that leaves without one has met T·Lo;
//! - light that is given per length is gathered on the way to that collision (see [`emission_along`]);
//! - Ls is split between next-event estimation (a light is drawn, the transmittance towards it estimated) and
//!   the continued path (a direction is drawn from the phase function), joined by multiple importance sampling with
//!   the balance heuristic (Veach 1997, chapter 9);
//! - a path ends when it leaves, at `max_depth` scattering events, or by Russian roulette on its throughput.
//!
//! Any pair of a distance sampler and a transmittance estimator fits in ([`Estimators`]). One whose flights have weights
//! multiplies the throughput by them; a flight may have both a collision and an escape. Negative weights count in roulette
//! by their size.

use glam::DVec3;
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_scene::{Light, Ray, Scene, Volume};

use crate::emission::emission_along;
use crate::equiangular_light::LitSegment;
use crate::estimators::Estimators;

/// Throughput below which roulette is played.
const ROULETTE_THROUGHPUT: f64 = 0.25;

/// One estimate of the radiance that arrives along `ray`, sorted into the film's layers.
pub fn trace(scene: &Scene, ray: Ray, random: &mut Random) -> Sample {
    trace_with(scene, Estimators::default(), ray, random)
}

/// The same with chosen estimators, which must be [valid](Estimators::validate) for the scene.
pub fn trace_with(scene: &Scene, estimators: Estimators, mut ray: Ray, random: &mut Random) -> Sample {
    let mut layers = Layers::default();
    let mut throughput = DVec3::ONE;
    // Density with which the ray's direction was drawn from a phase function; none for the camera's own ray.
    let mut phase_pdf = None;
    let mut scatterings = 0;
    let shines = scene.volumes.iter().any(|volume| volume.medium.emission_per_length != DVec3::ZERO);

    loop {
        let flight = estimators.fly(scene, &ray, random);
        if scatterings == 0 || shines {
            let collision = estimators.analog_collision(scene, &ray, &flight, random);
            if scatterings == 0 {
                let albedo =
                    |(distance, volume): (f64, &Volume)| (distance, volume.albedo_at(ray.at(distance)));
                layers.first_collision = collision.map(albedo);
            }
            let end = collision.map_or(f64::INFINITY, |(distance, _)| distance);
            for volume in scene.volumes.iter().filter(|_| shines) {
                layers.emission += throughput * emission_along(volume, &ray, end, random);
            }
        }
        if flight.escape != 0.0 {
            let escaped = throughput * flight.escape * escaped_radiance(scene, ray.direction, phase_pdf);
            layers.add_in_scattered(scatterings, escaped);
        }
        let may_scatter = scene.max_depth.is_none_or(|depth| scatterings < depth);
        let lit_segment = estimators.lit_segment(scene, &ray).filter(|_| may_scatter);
        if let Some(segment) = &lit_segment {
            let lit = segment.in_scattered(scene, estimators, random);
            layers.add_in_scattered(scatterings + 1, throughput * lit);
        }
        let Some((distance, volume)) = flight.collision else { break };
        throughput *= flight.weight;
        let position = ray.at(distance);
        let medium = &volume.medium;
        let albedo = volume.albedo_at(position);

        layers.emission += throughput * (DVec3::ONE - albedo) * volume.emission_at(position);

        if !may_scatter {
            break;
        }
        throughput *= albedo;
        if !survives_roulette(&mut throughput, random) {
            break;
        }
        scatterings += 1;

        let shadow = Shadow { scene, estimators, segment: lit_segment.map(|segment| (segment, distance)) };
        let direct = shadow.next_event(position, ray.direction, volume, random);
        layers.add_in_scattered(scatterings, throughput * direct);

        let onward = medium.phase_function.sample(ray.direction, [random.f64(), random.f64()]);
        phase_pdf = Some(medium.phase_function.value(ray.direction, onward));
        ray = Ray { origin: position, direction: onward };
    }
    layers.into_sample()
}

/// Lo: radiance of the infinite lights in `direction`, each weighted against next-event estimation having drawn it.
fn escaped_radiance(scene: &Scene, direction: DVec3, phase_pdf: Option<f64>) -> DVec3 {
    scene
        .lights
        .iter()
        .zip(&scene.light_probabilities)
        .map(|(light, probability)| {
            let weight = match phase_pdf {
                Some(phase_pdf) => phase_pdf / (phase_pdf + probability * light.pdf(direction)),
                None => 1.0,
            };
            light.radiance(direction) * weight
        })
        .sum()
}

/// What next-event estimation at a collision has to know.
struct Shadow<'a> {
    scene: &'a Scene,
    estimators: Estimators,
    /// The stretch of the path up to the collision, and its distance, if point lights are sampled along it as well.
    segment: Option<(LitSegment<'a>, f64)>,
}

impl Shadow<'_> {
    /// Next-event estimation of ∫ f_p L dω over the light that arrives unscattered at `position`.
    fn next_event(&self, position: DVec3, before: DVec3, volume: &Volume, random: &mut Random) -> DVec3 {
        let Some((number, probability)) = self.scene.choose_light(position, random.f64()) else {
            return DVec3::ZERO;
        };
        let light = &self.scene.lights[number];
        let sample = light.sample(position, [random.f64(), random.f64()]);
        let phase = volume.medium.phase_function.value(before, sample.toward);
        let light_pdf = probability * sample.pdf;
        let weight = match (light, &self.segment) {
            (Light::Point(light), Some((segment, distance))) => segment.collision_weight(light, *distance),
            _ if sample.is_delta => 1.0,
            _ => light_pdf / (light_pdf + phase),
        };
        let unshadowed = sample.radiance_over_pdf * (phase * weight / probability);
        if unshadowed == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let shadow_ray = Ray { origin: position, direction: sample.toward };
        unshadowed * self.estimators.transmittance(self.scene, &shadow_ray, sample.distance, random)
    }
}

/// Ends a weak path with a probability that its survivors' weight makes up for.
fn survives_roulette(throughput: &mut DVec3, random: &mut Random) -> bool {
    let strength = throughput.abs().max_element();
    if strength >= ROULETTE_THROUGHPUT {
        return true;
    }
    let probability = strength / (2.0 * ROULETTE_THROUGHPUT);
    if random.f64() >= probability {
        return false;
    }
    *throughput /= probability;
    true
}

/// The path's contributions by what made them.
#[derive(Default)]
struct Layers {
    background: DVec3,
    emission: DVec3,
    single: DVec3,
    multiple: DVec3,
    /// Distance and albedo of the camera ray's first collision.
    first_collision: Option<(f64, DVec3)>,
}

impl Layers {
    fn add_in_scattered(&mut self, scatterings: u32, radiance: DVec3) {
        match scatterings {
            0 => self.background += radiance,
            1 => self.single += radiance,
            _ => self.multiple += radiance,
        }
    }

    fn into_sample(self) -> Sample {
        let radiance = self.background + self.emission + self.single + self.multiple;
        let (depth, albedo) = self.first_collision.unwrap_or_default();
        Sample {
            radiance: radiance.as_vec3().to_array(),
            hit: self.first_collision.is_some(),
            depth: depth as f32,
            albedo: albedo.as_vec3().to_array(),
            emission: self.emission.as_vec3().to_array(),
            single: self.single.as_vec3().to_array(),
            multiple: self.multiple.as_vec3().to_array(),
            ..Sample::default()
        }
    }
}
