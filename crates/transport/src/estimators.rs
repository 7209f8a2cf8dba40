//! Which distance sampler and which transmittance estimator a picture is made with, and whether they can be.
//!
//! Left open, each volume is treated by itself in the way that is best for it as a rule, and the first of the volumes'
//! first collisions is taken, which follows the sum of their extinctions. A chosen estimator sees all volumes at once, as
//! one extinction along the ray, since weighted flights have no "first".

use tyndall_lanes::Random;
use tyndall_scene::{Density, Light, Ray, Scene, Volume};
use tyndall_volumes::Filter;

use crate::along_ray::{AlongRay, Lookups};
use crate::distance::{DistanceSampler, Flight, sample_distance};
use crate::equiangular_light::LitSegment;
use crate::properties::{Need, Properties, Reason};
use crate::transmittance::{TransmittanceEstimator, estimate_transmittance};

/// A choice of estimators; what is best as a rule where there is none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Estimators {
    /// For distances. With [`DistanceSampler::Equiangular`] paths go on by default sampling, and point lights are sampled at
    /// equiangular places as well.
    pub distance: Option<DistanceSampler>,
    /// For shadow rays.
    pub transmittance: Option<TransmittanceEstimator>,
}

/// A stretch of a path: see [`Flight`].
pub(crate) struct SceneFlight<'a> {
    pub collision: Option<(f64, &'a Volume)>,
    pub weight: f64,
    pub escape: f64,
}

impl Estimators {
    /// Whether these estimators can make a picture of `scene`.
    ///
    /// # Errors
    /// The reason why not, and what to take instead.
    pub fn validate(&self, scene: &Scene) -> Result<(), Reason> {
        if *self != Self::default() && scene.is_spectral() {
            let why =
                "the scene is for the spectral integrator, which has estimators of its own; leave them to it";
            return Err(Reason(why.into()));
        }
        self.properties().try_for_each(|properties| validate(properties, scene))
    }

    /// What should be known of a picture made with these, a line each.
    pub fn notes(&self) -> Vec<String> {
        let biased = self.properties().filter(|properties| !properties.unbiased);
        biased
            .map(|p| {
                format!(
                    "{} is biased: the picture does not tend to the true one, however many samples",
                    p.name
                )
            })
            .collect()
    }

    fn properties(&self) -> impl Iterator<Item = &'static Properties> {
        let distance = self.distance.map(DistanceSampler::properties);
        distance.into_iter().chain(self.transmittance.map(TransmittanceEstimator::properties))
    }

    /// The next collision along `ray`, and what escapes.
    pub(crate) fn fly<'a>(&self, scene: &'a Scene, ray: &Ray, random: &mut Random) -> SceneFlight<'a> {
        let Some(sampler) = self.distance.filter(|sampler| *sampler != DistanceSampler::Equiangular) else {
            return first_of_all(scene, ray, random);
        };
        let Some(along) = AlongRay::through(&scene.volumes, ray, f64::INFINITY) else {
            return SceneFlight { collision: None, weight: 0.0, escape: 1.0 };
        };
        let Flight { t, weight, escape } = sampler.sample(&along, random, &mut Lookups::default());
        let at = |t| {
            // One volume needs no draw, so that a choice of the default gives the default's bits.
            let u = if scene.volumes.len() == 1 { 0.0 } else { random.f64() };
            (t, &scene.volumes[along.volume_at(t, u)])
        };
        SceneFlight { collision: t.map(at), weight, escape }
    }

    /// A collision that happens with the true probability, which those of weighted flights do not.
    pub(crate) fn analog_collision<'a>(
        &self,
        scene: &'a Scene,
        ray: &Ray,
        flight: &SceneFlight<'a>,
        random: &mut Random,
    ) -> Option<(f64, &'a Volume)> {
        let is_weighted = self.distance.is_some_and(|sampler| !sampler.is_analog());
        let is_equiangular = self.distance == Some(DistanceSampler::Equiangular);
        if is_weighted && !is_equiangular {
            first_of_all(scene, ray, random).collision
        } else {
            flight.collision
        }
    }

    /// The ray as a place to sample point lights from, if that is wanted.
    pub(crate) fn lit_segment<'a>(&self, scene: &'a Scene, ray: &Ray) -> Option<LitSegment<'a>> {
        let is_wanted = self.distance == Some(DistanceSampler::Equiangular);
        is_wanted.then(|| LitSegment::new(scene, ray))?
    }

    /// An estimate of the transmittance of all volumes along `ray` up to `end`.
    pub(crate) fn transmittance(&self, scene: &Scene, ray: &Ray, end: f64, random: &mut Random) -> f64 {
        if let Some(estimator) = self.transmittance {
            return AlongRay::through(&scene.volumes, ray, end)
                .map_or(1.0, |along| estimator.estimate(&along, random, &mut Lookups::default()));
        }
        let mut transmittance = 1.0;
        for volume in &scene.volumes {
            transmittance *= estimate_transmittance(volume, ray, end, random);
            if transmittance == 0.0 {
                return 0.0;
            }
        }
        transmittance
    }
}

/// The nearest of the first collisions with each of the volumes.
fn first_of_all<'a>(scene: &'a Scene, ray: &Ray, random: &mut Random) -> SceneFlight<'a> {
    let mut collision = None;
    let mut end = f64::INFINITY;
    for volume in &scene.volumes {
        if let Some(distance) = sample_distance(volume, ray, end, random) {
            end = distance;
            collision = Some((distance, volume));
        }
    }
    let weight = if collision.is_some() { 1.0 } else { 0.0 };
    SceneFlight { collision, weight, escape: 1.0 - weight }
}

fn validate(properties: &Properties, scene: &Scene) -> Result<(), Reason> {
    let name = properties.name;
    for need in properties.needs {
        match need {
            Need::ClosedForm => {
                let interpolated = |volume: &&Volume| matches!(&volume.density, Density::Grid(grid) if grid.filter() == Filter::Trilinear);
                if let Some(volume) = scene.volumes.iter().find(interpolated) {
                    return Err(Reason(format!(
                        "{name}: there is no closed form for the interpolated grid of the volume `{}`; take regular-tracking, which \
                         is as exact",
                        volume.name
                    )));
                }
            }
            Need::PointLight => {
                let is_sampled = |(light, probability): (&Light, &f64)| {
                    matches!(light, Light::Point(_)) && *probability > 0.0
                };
                if !scene.lights.iter().zip(&scene.light_probabilities).any(is_sampled) {
                    return Err(Reason(format!(
                        "{name}: the scene has no point light to sample; add one, or take another sampler"
                    )));
                }
            }
            Need::ExactThickness | Need::Control => {}
        }
    }
    Ok(())
}
