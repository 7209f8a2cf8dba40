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
mod shadow;

use glam::{DMat3, DVec3, DVec4};
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_optics::{cie, uplift};
use tyndall_scene::surface::Presence;
use tyndall_scene::{ChannelMedium, Channels, Hit, Light, Observer, Ray, Scene};

use crate::emission::{
    Glow, draw_glow, emission_factor_along, emitting_stretch, extinction_at, light_weight, path_weight,
};
use crate::path_layers::{DirectLight, FirstMet, PathLayers};
use crate::roulette::survival;
use crate::shadow_catcher;
use crate::surface_vertex::SurfaceVertex;
use crate::way::Way;

use self::densities::PathDensities;
use self::flight::Flight;
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
    pub fn trace(&self, ray: Ray, random: &mut Random) -> Sample {
        let scene = self.scene;
        let mut layers = PathLayers::<DVec4>::default();
        let count = self.channels.count();
        let hero = ((random.f64() * count as f64) as usize).min(count - 1);
        let presence = scene.presence_at_camera(ray.origin);
        let ones = self.channels.ones();
        let densities = PathDensities::new(&self.channels);
        let mut path = Path { ray, presence, hero, weight: ones, refraction: 1.0, densities, turn: None };
        let mut turns = 0;
        let mut scatterings = 0;

        loop {
            let way = Way::trace(scene, &path.ray, f64::INFINITY, &path.presence, random);
            let flight = Flight::draw(&scene.volumes, &self.media, &path.ray, &way, hero, random);
            layers.emission += path.weight * self.emission_along(&path, &way, &flight, random);
            path.densities.fly(&flight);
            let may_turn = scene.max_depth.is_none_or(|depth| turns < depth);

            if let Some((distance, number)) = flight.collision {
                let position = path.ray.at(distance);
                let medium = &self.media[number];
                if turns == 0 {
                    let albedo = self.albedo_of(number, position);
                    layers.first = Some(FirstMet { distance, albedo, ..FirstMet::default() });
                }
                let (albedo, emission) = scene.volumes[number].colours_at(position, medium, &self.channels);
                if emission != DVec4::ZERO {
                    let emitted =
                        (DVec4::ONE - albedo) * emission * path.glow_weight(scene, number, position);
                    layers.emission += path.weight * path.densities.relative() * emitted;
                }

                if !may_turn {
                    break;
                }
                path.weight *= albedo;
                if !path.survives_roulette(turns, random) {
                    break;
                }
                turns += 1;
                scatterings += 1;
                path.presence = way.presence_at(scene, path.ray.direction, distance);

                let before = path.ray.direction;
                let vertex = Vertex {
                    position,
                    value: |toward| {
                        let phases = medium.phases.values(before, toward);
                        (phases, phases)
                    },
                    leave: |direction| (Ray { origin: position, direction }, path.presence.clone()),
                };
                layers.add_direct(scatterings, path.weight, self.next_event(&vertex, &path, random));

                let onward = medium.phases.of(hero).sample(before, [random.f64(), random.f64()]);
                let phases = medium.phases.values(before, onward);
                path.turn_into(&self.channels, position, phases);
                path.ray = Ray { origin: position, direction: onward };
                continue;
            }

            let arriving = match &way.hit {
                None => self.escaped_radiance(&path),
                Some(hit) => self.lamp_radiance(&path, hit),
            };
            layers.add(scatterings, path.weight * path.densities.relative() * arriving);
            let Some(hit) = way.hit else { break };

            let surface = SurfaceVertex::new(scene, &hit, path.ray.direction, &self.channels);
            path.presence = way.presence_at(scene, path.ray.direction, hit.t);
            if turns == 0 {
                let mut first = surface.first_met(scene, self.surface_albedo(&hit, &path.ray));
                if surface.is_shadow_catcher(scene) {
                    first.caught = Some(shadow_catcher::reflected(scene, &surface, &path.presence, random));
                }
                layers.first = Some(first);
                if first.caught.is_some() {
                    break;
                }
            }
            if !may_turn {
                break;
            }
            turns += 1;
            if !surface.is_delta() {
                let vertex = Vertex {
                    position: surface.position(),
                    value: |toward| (surface.value(toward), DVec4::splat(surface.pdf(toward))),
                    leave: |direction| surface.leave(scene, direction, &path.presence),
                };
                layers.add_direct(scatterings, path.weight, self.next_event(&vertex, &path, random));
            }
            let Some(onward) = surface.sample(random) else { break };
            path.weight *= onward.weight;
            path.refraction *= onward.radiance_scale;
            if !path.survives_roulette(turns, random) {
                break;
            }
            match onward.pdf {
                Some(pdf) => path.turn_into(&self.channels, surface.position(), DVec4::splat(pdf)),
                None => path.mirror(),
            }
            (path.ray, path.presence) = surface.leave(scene, onward.direction, &path.presence);
        }
        let film_of_channels = &self.film_of_channels;
        layers.into_sample(|channels| {
            let parts = film_of_channels.iter().zip(channels.to_array());
            parts.map(|(film, channel)| *film * channel).sum::<DVec3>()
        })
    }

    /// The albedo of a surface for the film.
    fn surface_albedo(&self, hit: &Hit, ray: &Ray) -> DVec3 {
        let channels = match self.scene.observer {
            Observer::Bands(_) => &self.channels,
            _ => &Channels::Rgb,
        };
        SurfaceVertex::new(self.scene, hit, ray.direction, channels).albedo().truncate()
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
    fn emission_along(&self, path: &Path, way: &Way, flight: &Flight, random: &mut Random) -> DVec4 {
        let end = flight.collision.map_or(way.end, |(distance, _)| distance);
        let mut sum = DVec4::ZERO;
        for span in way.spans.iter().filter(|span| span.start < end) {
            let (volume, medium) = (&self.scene.volumes[span.volume], &self.media[span.volume]);
            if medium.emission_per_length == DVec4::ZERO {
                continue;
            }
            let range = (span.start, span.end.min(end));
            let Some((enter, leave)) = emitting_stretch(volume, &path.ray, range) else { continue };
            let t = enter + random.f64() * (leave - enter);
            let factor = emission_factor_along(volume, &path.ray, t);
            if factor > 0.0 {
                let mut here = path.densities;
                here.fly(&flight.up_to(&self.scene.volumes, &self.media, &path.ray, way, t));
                let weight = path.glow_weight(self.scene, span.volume, path.ray.at(t));
                sum += here.relative() * medium.emission_per_length * (factor * (leave - enter) * weight);
            }
        }
        sum
    }

    /// Lo of the surroundings: radiance of the infinite lights, each weighted against next-event estimation having drawn it.
    fn escaped_radiance(&self, path: &Path) -> DVec4 {
        let direction = path.ray.direction;
        let lights = self.scene.lights.iter().enumerate();
        lights
            .map(|(number, light)| {
                let radiance = light.radiance(direction);
                if radiance == DVec3::ZERO {
                    return DVec4::ZERO;
                }
                let weight = path.weight_against(self.scene, number, |_| light.pdf(direction));
                self.light(number, radiance) * weight
            })
            .sum()
    }

    /// Le of a surface that is a lamp, weighted likewise.
    fn lamp_radiance(&self, path: &Path, hit: &Hit) -> DVec4 {
        let Some((number, lamp)) = self.scene.lamp(hit) else { return DVec4::ZERO };
        let direction = path.ray.direction;
        let weight = path.weight_against(self.scene, number, |from| {
            lamp.pdf_of_hit(from, direction, hit.position, hit.normal)
        });
        self.light(number, lamp.radiance_from(hit.normal, direction)) * weight
    }

    /// Next-event estimation of ∫ f L dω over the light that arrives unscattered at the vertex, times the path's
    /// densities over their mean.
    fn next_event<V, L>(&self, vertex: &Vertex<V, L>, path: &Path, random: &mut Random) -> DirectLight<DVec4>
    where
        V: Fn(DVec3) -> (DVec4, DVec4),
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let Some((number, probability)) = self.scene.choose_light(vertex.position, random.f64()) else {
            return DirectLight::default();
        };
        let is_glow = matches!(self.scene.lights[number], Light::Volume(_));
        let radiance = if is_glow {
            self.glow(vertex, path, number, probability, random)
        } else {
            self.lamp_or_surroundings(vertex, path, number, probability, random)
        };
        DirectLight { radiance, is_glow }
    }

    /// That of a light that is no volume.
    fn lamp_or_surroundings<V, L>(
        &self,
        vertex: &Vertex<V, L>,
        path: &Path,
        number: usize,
        probability: f64,
        random: &mut Random,
    ) -> DVec4
    where
        V: Fn(DVec3) -> (DVec4, DVec4),
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let light = &self.scene.lights[number];
        let sample = light.sample(vertex.position, [random.f64(), random.f64()]);
        let radiance = self.light(number, sample.radiance_over_pdf) / probability;
        let (value, pdf) = (vertex.value)(sample.toward);
        if path.densities.relative() * value * radiance == DVec4::ZERO {
            return DVec4::ZERO;
        }
        let Some(shadow) = self.shadow(vertex, sample.toward, sample.distance, path.hero, random) else {
            return DVec4::ZERO;
        };
        let light_pdf = (!sample.is_delta).then_some(probability * sample.pdf);
        radiance * path.densities.connect(value, pdf, &shadow, light_pdf)
    }

    /// The same for a volume that glows: ∫ f T j/d² dV over its source j. Its weight against paths that find the glow is the
    /// same for all channels, and so is left out of the sum over heroes.
    fn glow<V, L>(
        &self,
        vertex: &Vertex<V, L>,
        path: &Path,
        number: usize,
        probability: f64,
        random: &mut Random,
    ) -> DVec4
    where
        V: Fn(DVec3) -> (DVec4, DVec4),
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let Light::Volume(light) = &self.scene.lights[number] else { return DVec4::ZERO };
        let u = [random.f64(), random.f64(), random.f64()];
        let Some(glow) = draw_glow(light, vertex.position, u) else { return DVec4::ZERO };
        let Glow { position, toward, distance, density } = glow;
        let (value, pdf) = (vertex.value)(toward);
        let source = self.source_at(light.volume(), position, toward);
        if path.densities.relative() * value * source == DVec4::ZERO {
            return DVec4::ZERO;
        }
        let mean_pdf = mean(&self.channels, pdf);
        let volume = &self.scene.volumes[light.volume()];
        let mu_t = extinction_at(volume, position, toward);
        let weight = light_weight(volume, &glow, mu_t, probability, mean_pdf);
        let Some(shadow) = self.shadow(vertex, toward, distance, path.hero, random) else {
            return DVec4::ZERO;
        };
        source * path.densities.connect(value, pdf, &shadow, None) * (weight / (density * probability))
    }

    /// The source term of a volume at a place, μa·Le and what is given per length.
    fn source_at(&self, number: usize, position: DVec3, toward: DVec3) -> DVec4 {
        let (volume, medium) = (&self.scene.volumes[number], &self.media[number]);
        let density = volume.density_anywhere(volume.world_to_local.transform_point3(position));
        let (albedo, emission) = volume.colours_at(position, medium, &self.channels);
        let by_collisions = medium.mu_t_along(toward) * density * (DVec4::ONE - albedo) * emission;
        by_collisions + medium.emission_per_length * volume.emission_per_length_factor(position)
    }

    /// The shadow ray from a vertex; none if nothing gets through.
    fn shadow<V, L>(
        &self,
        vertex: &Vertex<V, L>,
        toward: DVec3,
        distance: f64,
        hero: usize,
        random: &mut Random,
    ) -> Option<ShadowRay>
    where
        L: Fn(DVec3) -> (Ray, Presence),
    {
        let (ray, presence) = (vertex.leave)(toward);
        let way = Way::connect(self.scene, &ray, distance, &presence, random)?;
        ShadowRay::track(&self.scene.volumes, &self.media, &ray, &way, hero, random)
    }

    /// Light of a colour in the channels, from the light of this number. Lights that have no spectrum, such as images and the
    /// sky, are known in red, green and blue alone: they are the white of [`cie::white`] times a mixture of the basis of
    /// [`uplift`], which has that colour.
    pub(crate) fn light(&self, number: usize, colour: DVec3) -> DVec4 {
        match (self.channels, self.scene.light_spectra.get(number).and_then(Option::as_ref)) {
            (Channels::Wavelengths(wavelengths_nm), Some(spectrum)) => {
                let luminance = cie::luminance(colour);
                DVec4::from_array(wavelengths_nm.map(|nm| spectrum.at(nm) * luminance))
            }
            _ => DVec4::from_array(self.rgb_light.map(|of_rgb| of_rgb.dot(colour))),
        }
    }
}

/// A path under way.
struct Path {
    ray: Ray,
    /// The volumes that are present where the ray begins.
    presence: Presence,
    hero: usize,
    /// A: product of the albedos, of what surfaces left of the light, and of what roulette makes up for.
    weight: DVec4,
    /// The part of the weight that is due to refraction, which roulette leaves out.
    refraction: f64,
    densities: PathDensities,
    /// Where the path last turned, and the mean of the densities with which the channels would have done so into its
    /// direction; none for the camera's own ray and after a mirror.
    turn: Option<(DVec3, f64)>,
}

/// A place where a path turns, as next-event estimation sees it.
struct Vertex<V, L> {
    position: DVec3,
    /// Of a direction: the phase functions or f |cos θ|, and the densities with which paths go on there.
    value: V,
    /// The ray in a direction, and the volumes that are present where it begins.
    leave: L,
}

impl Path {
    fn turn_into(&mut self, channels: &Channels, position: DVec3, pdf: DVec4) {
        self.turn = Some((position, mean(channels, pdf)));
        self.densities.turn(pdf);
    }

    fn mirror(&mut self) {
        self.turn = None;
        self.densities.mirror();
    }

    /// Weight against next-event estimation, which draws the same direction from where the path turned with the density
    /// `pdf` if it draws the light of this number.
    fn weight_against(&self, scene: &Scene, light: usize, pdf: impl Fn(DVec3) -> f64) -> f64 {
        let Some((from, _)) = self.turn else { return 1.0 };
        self.densities.weight_against(scene.light_probability(light, from) * pdf(from))
    }

    /// Weight of the glow of a volume at `position`, found by this path, against next-event estimation.
    fn glow_weight(&self, scene: &Scene, volume: usize, position: DVec3) -> f64 {
        self.turn.map_or(1.0, |(from, pdf)| path_weight(scene, volume, from, position, pdf))
    }

    /// Ends a weak path with a probability that its survivors' weight makes up for. The weight is the same whichever channel
    /// was the hero, and so roulette changes no ratio of densities.
    fn survives_roulette(&mut self, turns: u32, random: &mut Random) -> bool {
        let strength = (self.weight * self.densities.relative()).max_element() / self.refraction;
        let probability = survival(strength, ROULETTE_WEIGHT, turns);
        if probability < 1.0 && random.f64() >= probability {
            return false;
        }
        self.weight /= probability;
        true
    }
}

/// Mean over the channels of a path.
fn mean(channels: &Channels, values: DVec4) -> f64 {
    (values * channels.ones()).element_sum() / channels.count() as f64
}
