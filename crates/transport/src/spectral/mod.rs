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
mod hero_wavelengths;
mod layers;
mod shadow;

use glam::{DMat3, DVec3, DVec4};
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_optics::{cie, uplift};
use tyndall_scene::{ChannelMedium, Channels, Observer, Ray, Scene};

use crate::emission::{emission_factor_along, emitting_stretch};

use self::densities::PathDensities;
use self::flight::Flight;
use self::layers::Layers;
use self::shadow::ShadowRay;

/// Weight below which roulette is played.
const ROULETTE_WEIGHT: f64 = 0.25;

/// The spectral integrator for what a scene's picture is to be.
pub enum SpectralIntegrator<'a> {
    /// Every path has the same channels.
    Fixed(SpectralScene<'a>),
    /// Every path has wavelengths of its own.
    HeroWavelengths {
        /// The scene.
        scene: &'a Scene,
        /// The film's channels of XYZ.
        film_of_xyz: DMat3,
    },
}

impl<'a> SpectralIntegrator<'a> {
    /// The integrator for `scene`.
    pub fn new(scene: &'a Scene) -> Self {
        match scene.observer {
            Observer::Rgb => Self::Fixed(SpectralScene::new(scene, Channels::Rgb)),
            Observer::Bands([first, second, third]) => {
                Self::Fixed(SpectralScene::new(scene, Channels::Wavelengths([first, second, third, third])))
            }
            Observer::SpectralRgb => {
                let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(cie::xyz_to_rgb);
                let [x, y, z] = columns;
                Self::HeroWavelengths { scene, film_of_xyz: DMat3::from_cols(x, y, z) }
            }
            Observer::SpectralXyz => Self::HeroWavelengths { scene, film_of_xyz: DMat3::IDENTITY },
        }
    }

    /// One estimate of the radiance that arrives along `ray`, sorted into the film's layers.
    pub fn trace(&self, ray: Ray, random: &mut Random) -> Sample {
        match self {
            Self::Fixed(scene) => scene.trace(ray, random),
            Self::HeroWavelengths { scene, film_of_xyz } => {
                let (wavelengths_nm, xyz) = hero_wavelengths::four(random.f64());
                let mut spectral = SpectralScene::new(scene, Channels::Wavelengths(wavelengths_nm));
                spectral.film_of_channels = xyz.map(|xyz| *film_of_xyz * xyz);
                spectral.trace(ray, random)
            }
        }
    }
}

/// A scene in the channels of a path.
pub struct SpectralScene<'a> {
    scene: &'a Scene,
    channels: Channels,
    /// The media of the scene's volumes, in their order.
    media: Vec<ChannelMedium<'a>>,
    /// How much of red, green and blue light there is in each channel.
    rgb_light: [DVec3; 4],
    /// The film's channels of radiance 1 in each channel.
    film_of_channels: [DVec3; 4],
}

impl<'a> SpectralScene<'a> {
    /// The scene in `channels`, of which the film takes the first three as they are.
    pub fn new(scene: &'a Scene, channels: Channels) -> Self {
        let media = scene.volumes.iter().map(|volume| volume.medium.in_channels(&channels)).collect();
        let first_three = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO];
        let rgb_light = match channels {
            Channels::Rgb => first_three,
            Channels::Wavelengths(wavelengths_nm) => {
                wavelengths_nm.map(|nm| cie::white(nm) * uplift::basis(nm))
            }
        };
        Self { scene, channels, media, rgb_light, film_of_channels: first_three }
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
            layers.emission += albedo * self.emission_along(&ray, &flight, &densities, random);
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
                layers.first_collision(distance, self.albedo_of(number, position));
            }
            let (albedo_here, emission) = scene.volumes[number].colours_at(position, medium, &self.channels);

            layers.emission += albedo * densities.relative() * (DVec4::ONE - albedo_here) * emission;

            if scene.max_depth.is_some_and(|depth| scatterings >= depth) {
                break;
            }
            albedo *= albedo_here;
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
        layers.into_sample(&self.film_of_channels)
    }

    /// The albedo of a volume for the film, where it has to lie between 0 and 1: of a band at its wavelength, otherwise in
    /// RGB.
    fn albedo_of(&self, number: usize, position: DVec3) -> DVec3 {
        let volume = &self.scene.volumes[number];
        match self.scene.observer {
            Observer::Bands(_) => {
                volume.colours_at(position, &self.media[number], &self.channels).0.truncate()
            }
            _ => volume.albedo_at(position),
        }
    }

    /// Light that volumes send out per length, up to the end of the flight: at a uniform point of each volume's stretch,
    /// which every hero could have reached. Its mean over flights is ∫ ε T dt in every channel, as in [`crate::emission`].
    fn emission_along(
        &self,
        ray: &Ray,
        flight: &Flight,
        densities: &PathDensities,
        random: &mut Random,
    ) -> DVec4 {
        let end = flight.collision.map_or(f64::INFINITY, |(distance, _)| distance);
        let mut sum = DVec4::ZERO;
        for (volume, medium) in self.scene.volumes.iter().zip(&self.media) {
            if medium.emission_per_length == DVec4::ZERO {
                continue;
            }
            let Some((enter, leave)) = emitting_stretch(volume, ray, end) else { continue };
            let t = enter + random.f64() * (leave - enter);
            let factor = emission_factor_along(volume, ray, t);
            if factor > 0.0 {
                let mut here = *densities;
                here.fly(&flight.up_to(&self.scene.volumes, &self.media, ray, t));
                sum += here.relative() * medium.emission_per_length * (factor * (leave - enter));
            }
        }
        sum
    }

    /// Lo: radiance of the infinite lights in `direction`, each weighted against next-event estimation having drawn it.
    fn escaped_radiance(&self, direction: DVec3, densities: &PathDensities) -> DVec4 {
        let Scene { lights, light_probabilities, .. } = self.scene;
        lights
            .iter()
            .zip(light_probabilities)
            .enumerate()
            .map(|(number, (light, probability))| {
                let weight = densities.weight_against(probability * light.pdf(direction));
                self.light(number, light.radiance(direction)) * weight
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
        let Some((number, probability)) = self.scene.choose_light(position, random.f64()) else {
            return DVec4::ZERO;
        };
        let light = &self.scene.lights[number];
        let sample = light.sample(position, [random.f64(), random.f64()]);
        let radiance = self.light(number, sample.radiance_over_pdf) / probability;
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

    /// Light of a colour in the channels, from the light of this number. Lights that have no spectrum, such as images and the
    /// sky, are known in red, green and blue alone: they are the white of [`cie::white`] times a mixture of the basis of
    /// [`uplift`], which has that colour.
    fn light(&self, number: usize, colour: DVec3) -> DVec4 {
        match (self.channels, self.scene.light_spectra.get(number).and_then(Option::as_ref)) {
            (Channels::Wavelengths(wavelengths_nm), Some(spectrum)) => {
                let luminance = cie::luminance(colour);
                DVec4::from_array(wavelengths_nm.map(|nm| spectrum.at(nm) * luminance))
            }
            _ => DVec4::from_array(self.rgb_light.map(|of_rgb| of_rgb.dot(colour))),
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
