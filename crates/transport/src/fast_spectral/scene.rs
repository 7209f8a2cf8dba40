//! The scene as the lanes see it: one even medium, f32, about a centre of its own.

use std::ops::Range;

use glam::{DAffine3, DVec3, Vec3};
use tyndall_optics::PhaseFunction;
use tyndall_scene::{ChannelPhases, Channels, Density, Light, Observer, Scene, Volume};

use crate::spectral::SpectralScene;

/// Channels of a path: red, green and blue, or three bands.
pub(super) const CHANNELS: usize = 3;

/// Lights beyond which choosing one in every lane would cost more than the rest of the vertex.
const MOST_LIGHTS: usize = 8;

/// Numbers whose squares f32 holds with room to spare.
const HELD: Range<f64> = 1e-15..1e15;

/// A scene of one even medium under lights with closed forms.
pub(crate) struct FastSpectralScene<'a> {
    pub(super) scene: &'a Scene,
    pub(super) volume: &'a Volume,
    /// The origin of the lanes' coordinates in the world.
    pub(super) centre: DVec3,
    /// Centred world space to the volume's local space: columns of its linear part, and where the centre goes.
    pub(super) columns: [[f32; 3]; 3],
    pub(super) local_centre: [f32; 3],
    pub(super) boundary: Boundary,
    /// Extinction coefficients, 1/scene unit.
    pub(super) mu_t: [f32; CHANNELS],
    pub(super) albedo: [f32; CHANNELS],
    pub(super) phases: Phases,
    /// Lights that only next-event estimation finds.
    pub(super) lights: Vec<DeltaLight>,
    /// What shines from every direction.
    pub(super) even: [f32; CHANNELS],
    /// Channels among which one is drawn to stand for the camera's ray in the layers of depth and coverage; those beyond the
    /// last are the last, as among the four wavelengths of three bands.
    pub(super) witnesses: f64,
    /// Scatterings after which a path ends.
    pub(super) max_depth: u32,
}

/// Where the medium is, in its local space.
pub(super) enum Boundary {
    /// The unit sphere.
    Sphere,
    /// A box, of which any side may be infinitely far away.
    Box { min: [f32; 3], max: [f32; 3] },
}

/// Mean cosines of the Henyey-Greenstein phase functions.
#[derive(Clone, Copy)]
pub(super) enum Phases {
    Same(f32),
    Each([f32; CHANNELS]),
}

/// A point, or parallel light.
#[derive(Clone, Copy)]
pub(super) struct DeltaLight {
    /// The point in centred world space, or the unit vector to where the light comes from.
    pub toward: [f32; 3],
    /// 1 for a point, 0 for parallel light.
    pub is_point: f32,
    /// Intensity of a point or irradiance of parallel light, over the probability that the light is drawn.
    pub brightness: [f32; CHANNELS],
    /// Lights up to this one are drawn with this probability.
    pub cumulative: f32,
}

impl<'a> FastSpectralScene<'a> {
    /// The scene, if it is of the kind that this engine renders.
    pub fn new(scene: &'a Scene) -> Option<Self> {
        let channels = match scene.observer {
            Observer::Rgb => Channels::Rgb,
            Observer::Bands([first, second, third]) => Channels::Wavelengths([first, second, third, third]),
            Observer::SpectralRgb | Observer::SpectralXyz => return None,
        };
        let [volume] = scene.volumes.as_slice() else { return None };
        if !scene.surfaces.is_empty() || volume.fields.is_some() || scene.light_tree.is_some() {
            return None;
        }
        let infinite = [f32::INFINITY; 3];
        let boundary = match &volume.density {
            Density::Everywhere => Boundary::Box { min: infinite.map(|x| -x), max: infinite },
            Density::Box { min, max } => {
                Boundary::Box { min: min.as_vec3().to_array(), max: max.as_vec3().to_array() }
            }
            Density::Slab { bottom, top } => Boundary::Box {
                min: [f32::NEG_INFINITY, *bottom as f32, f32::NEG_INFINITY],
                max: [f32::INFINITY, *top as f32, f32::INFINITY],
            },
            Density::Sphere => Boundary::Sphere,
            Density::Atmosphere { .. } | Density::Grid(_) => return None,
        };
        let spectral = SpectralScene::new(scene, channels);
        let medium = volume.medium.in_channels(&channels);
        let glows = medium.emission.max_element() > 0.0 || medium.emission_per_length.max_element() > 0.0;
        if glows {
            return None;
        }
        let first_three = |values: glam::DVec4| values.truncate().as_vec3().to_array();
        let phases = match &medium.phases {
            ChannelPhases::Same(phase) => Phases::Same(mean_cosine(phase)?),
            ChannelPhases::Each([a, b, c, _]) => {
                Phases::Each([mean_cosine(a)?, mean_cosine(b)?, mean_cosine(c)?])
            }
        };
        let anywhere = scene.camera.ray([0, 0], [0.5; 2], [0.5; 2]).origin;
        let centre = volume.world_box().map_or(anywhere, |[min, max]| (min + max) * 0.5);
        let to_local = volume.world_to_local * DAffine3::from_translation(centre);

        let mut even = DVec3::ZERO;
        let mut lights = Vec::new();
        let found: f64 = delta_lights(scene).map(|(_, probability)| probability).sum();
        let mut cumulative = 0.0;
        for (number, light) in scene.lights.iter().enumerate() {
            let share = scene.light_probabilities[number] / found;
            let light = match light {
                Light::Constant(_) => {
                    even += spectral.light(number, light.radiance(DVec3::Y)).truncate();
                    continue;
                }
                Light::Point(_) | Light::Distant(_) if scene.light_probabilities[number] <= 0.0 => continue,
                Light::Point(point) => {
                    // What arrives at distance 1 is the intensity.
                    let intensity = light.sample(point.position() - DVec3::Y, [0.0; 2]).radiance_over_pdf;
                    (point.position() - centre, 1.0, intensity)
                }
                Light::Distant(_) => {
                    let sample = light.sample(centre, [0.0; 2]);
                    (sample.toward, 0.0, sample.radiance_over_pdf)
                }
                _ => return None,
            };
            let (toward, is_point, brightness) = light;
            cumulative += share;
            lights.push(DeltaLight {
                toward: toward.as_vec3().to_array(),
                is_point,
                brightness: first_three(spectral.light(number, brightness) / share),
                cumulative: cumulative as f32,
            });
        }
        let columns = [to_local.matrix3.x_axis, to_local.matrix3.y_axis, to_local.matrix3.z_axis];
        let places = lights.iter().map(|light| Vec3::from_array(light.toward).as_dvec3());
        let fits = medium.mu_t.to_array().into_iter().all(|mu_t| mu_t == 0.0 || HELD.contains(&mu_t))
            && columns.into_iter().all(|column| HELD.contains(&column.length()))
            && places.chain([to_local.translation]).all(|place| place.length() < HELD.end);
        if lights.len() > MOST_LIGHTS || !fits {
            return None;
        }
        Some(Self {
            scene,
            volume,
            centre,
            columns: to_local.matrix3.to_cols_array_2d().map(|column| column.map(|x| x as f32)),
            local_centre: to_local.translation.as_vec3().to_array(),
            boundary,
            mu_t: first_three(medium.mu_t),
            albedo: first_three(medium.albedo),
            phases,
            lights,
            even: even.as_vec3().to_array(),
            witnesses: channels.count() as f64,
            max_depth: scene.max_depth.unwrap_or(u32::MAX),
        })
    }

    /// The mean cosine of the phase function of a channel.
    pub(super) fn g(&self, channel: usize) -> f32 {
        match self.phases {
            Phases::Same(g) => g,
            Phases::Each(g) => g[channel],
        }
    }
}

/// Numbers and probabilities of the lights that only next-event estimation finds.
fn delta_lights(scene: &Scene) -> impl Iterator<Item = (usize, f64)> {
    let is_delta = |light: &Light| matches!(light, Light::Point(_) | Light::Distant(_));
    let lights = scene.lights.iter().enumerate().filter(move |(_, light)| is_delta(light));
    lights.map(|(number, _)| (number, scene.light_probabilities[number]))
}

/// g, if the phase function is Henyey and Greenstein's or isotropic. Below |g| = 1e-3 the inverse loses its digits in
/// f32, and the phase function is isotropic to within 0.3 %.
fn mean_cosine(phase: &PhaseFunction) -> Option<f32> {
    match *phase {
        PhaseFunction::Isotropic => Some(0.0),
        PhaseFunction::HenyeyGreenstein { g } => Some(if g.abs() > 1e-3 { g as f32 } else { 0.0 }),
        _ => None,
    }
}
