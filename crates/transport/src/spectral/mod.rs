//! The spectral integrator: a path tracer for media whose extinction or phase function depends on colour, one path at a
//! time, in f64.
//!
//! It solves the equation of [`reference`](crate::trace) in every channel λ (a colour or a wavelength) at once. A place
//! that is likely to be a collision for one channel may be unlikely for another, so each path is drawn for one channel,
//! the *hero*, chosen uniformly out of n, and weighted by the balance heuristic over all that could have been the hero:
//!
//!   weight of λ = f_λ(x) / p(x),   p(x) = (1/n) Σ_c p_c(x).
//!
//! f_λ is the integrand over paths x whose vertices are real and null collisions (the null-scattering path integral), and
//! p_c the density with which hero c draws x. With the hero's tentative collisions of rate μ̄_c = μt_c·D̄, where D ≤ D̄ is
//! the density and its bound, and ρ = D/D̄,
//!
//!   p_c(x) = Π exp(−μt_c ∫D̄) · Π_null μt_c D̄ (1 − ρ) · Π_real μt_c D̄ ρ · Π_turns f_c(ω,ω′),
//!   f_λ(x) = p_λ(x) Π_real albedo_λ · L_λ,
//!
//! because free flights and directions are drawn as the integrand of the hero's own channel wants it. Hence
//!
//!   weight of λ = A_λ p_λ / p,   A_λ = Π albedo_λ,
//!
//! which is never above n: channels of whatever difference make no outliers. A path carries A and the densities p_c
//! divided by their mean p, so that nothing over- or underflows and hero and weights need not be told apart. A hero whose
//! μt is 0 flies on; others find the collisions then. Overlapping volumes have collisions of their own each, of which the
//! first counts, so that their densities multiply. Volumes with a closed form have D̄ = D and thus no null collisions.
//!
//! Infinite lights are found in two ways, which join the heuristic's sum. Next-event estimation draws the light's
//! direction with the density p_l, keeps the hero's tentative collisions on the way and takes all for null:
//!
//!   q_c(x) = p_c(prefix) p_l(ω) Π exp(−μt_c ∫D̄) Π_null μt_c D̄,    weight of λ = f_λ / (mean p_c + mean q_c),
//!
//! where volumes with a closed form have no vertices to draw and leave q alone. The path that goes on and leaves carries
//! q/p_l from its last turn on for the same sum. Delta lights have next-event estimation only.
//!
//! Source: Miller, Georgiev & Jarosz 2019, "A null-scattering path integral formulation of light transport" (spectral
//! MIS, section 5); hero channels after Wilkie et al. 2014, "Hero wavelength spectral sampling". Unbiased. With grey
//! media all densities are equal, and it is the reference integrator but for the weights of next-event estimation.

mod densities;
mod flight;
mod layers;
mod shadow;

use glam::{DVec3, DVec4};
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_optics::Spectrum;
use tyndall_scene::{ChannelMedium, Channels, Ray, Scene};

use self::densities::PathDensities;
use self::flight::Flight;
use self::layers::Layers;
use self::shadow::ShadowRay;

/// Weight below which roulette is played.
const ROULETTE_WEIGHT: f64 = 0.25;

/// A scene in the channels of a path.
pub struct SpectralScene<'a> {
    scene: &'a Scene,
    channels: Channels,
    /// The media of the scene's volumes, in their order.
    media: Vec<ChannelMedium<'a>>,
}

impl<'a> SpectralScene<'a> {
    /// The scene in `channels`.
    pub fn new(scene: &'a Scene, channels: Channels) -> Self {
        let media = scene.volumes.iter().map(|volume| volume.medium.in_channels(&channels)).collect();
        Self { scene, channels, media }
    }

    /// One estimate of the radiance that arrives along `ray` in every channel, sorted into the film's layers.
    pub fn trace(&self, mut ray: Ray, random: &mut Random) -> Sample {
        let scene = self.scene;
        let mut layers = Layers::default();
        let count = self.channels.count();
        let hero = ((random.f64() * count as f64) as usize).min(count - 1);
        // Product of the albedos at the collisions and of what roulette makes up for.
        let mut albedo = self.channels.ones();
        let mut densities = PathDensities::new(&self.channels);
        let mut scatterings = 0;

        loop {
            let flight = Flight::draw(&scene.volumes, &self.media, &ray, hero, random);
            densities.fly(&flight);
            let Some((distance, number)) = flight.collision else {
                layers.add_in_scattered(
                    scatterings,
                    albedo * densities.relative() * self.escaped_radiance(ray.direction, &densities),
                );
                break;
            };
            let position = ray.at(distance);
            let medium = &self.media[number];
            if scatterings == 0 {
                layers.first_collision(distance, medium.albedo);
            }

            layers.emission += albedo * densities.relative() * (DVec4::ONE - medium.albedo) * medium.emission;

            if scene.max_depth.is_some_and(|depth| scatterings >= depth) {
                break;
            }
            albedo *= medium.albedo;
            if !survives_roulette(&mut albedo, densities.relative(), random) {
                break;
            }
            scatterings += 1;

            let direct = self.next_event(position, ray.direction, medium, hero, &densities, random);
            layers.add_in_scattered(scatterings, albedo * direct);

            let onward = medium.phases.of(hero).sample(ray.direction, [random.f64(), random.f64()]);
            densities.turn(medium.phases.values(ray.direction, onward));
            ray = Ray { origin: position, direction: onward };
        }
        layers.into_sample(DVec4::truncate)
    }

    /// Lo: radiance of the infinite lights in `direction`, each weighted against next-event estimation having drawn it.
    fn escaped_radiance(&self, direction: DVec3, densities: &PathDensities) -> DVec4 {
        let Scene { lights, light_probabilities, .. } = self.scene;
        lights
            .iter()
            .zip(light_probabilities)
            .map(|(light, probability)| {
                let weight = densities.weight_against(probability * light.pdf(direction));
                self.light(light.radiance(direction)) * weight
            })
            .sum()
    }

    /// Next-event estimation of ∫ f_p L dω over the light that arrives unscattered at `position`, times the path's
    /// densities over their mean.
    fn next_event(
        &self,
        position: DVec3,
        before: DVec3,
        medium: &ChannelMedium,
        hero: usize,
        densities: &PathDensities,
        random: &mut Random,
    ) -> DVec4 {
        let Some((light, probability)) = self.scene.choose_light(random.f64()) else {
            return DVec4::ZERO;
        };
        let sample = light.sample(position, [random.f64(), random.f64()]);
        let radiance = self.light(sample.radiance_over_pdf) / probability;
        let phase = medium.phases.values(before, sample.toward);
        if densities.relative() * phase * radiance == DVec4::ZERO {
            return DVec4::ZERO;
        }
        let ray = Ray { origin: position, direction: sample.toward };
        let shadow = ShadowRay::track(&self.scene.volumes, &self.media, &ray, sample.distance, hero, random);
        let Some(shadow) = shadow else { return DVec4::ZERO };
        let light_pdf = (!sample.is_delta).then_some(probability * sample.pdf);
        radiance * densities.connect(phase, &shadow, light_pdf)
    }

    /// A light's colour in the channels.
    fn light(&self, colour: DVec3) -> DVec4 {
        match self.channels {
            Channels::Rgb => colour.extend(0.0),
            Channels::Wavelengths(wavelengths_nm) => {
                let spectrum = Spectrum::RgbLight(colour);
                DVec4::from_array(wavelengths_nm.map(|nm| spectrum.at(nm)))
            }
        }
    }
}

/// Ends a weak path with a probability that its survivors' weight makes up for. The weight is the same whichever channel
/// was the hero, and so roulette changes no ratio of densities.
fn survives_roulette(albedo: &mut DVec4, relative_density: DVec4, random: &mut Random) -> bool {
    let strength = (*albedo * relative_density).max_element();
    if strength >= ROULETTE_WEIGHT {
        return true;
    }
    let probability = strength / (2.0 * ROULETTE_WEIGHT);
    if random.f64() >= probability {
        return false;
    }
    *albedo /= probability;
    true
}
