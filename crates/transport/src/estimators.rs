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
use crate::way::Way;

/// A choice of estimators; what is best as a rule where there is none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Estimators {
    /// For distances. With [`DistanceSampler::Equiangular`] paths go on by default sampling, and lights at a
    /// place are sampled at equiangular places as well.
    pub distance: Option<DistanceSampler>,
    /// For shadow rays.
    pub transmittance: Option<TransmittanceEstimator>,
}

/// A stretch of a path: see [`Flight`].
pub(crate) struct SceneFlight {
    /// Distance, and number of the volume.
    pub collision: Option<(f64, usize)>,
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

    /// The next collision along `ray` on its way, and what escapes.
    pub(crate) fn fly(&self, scene: &Scene, ray: &Ray, way: &Way, random: &mut Random) -> SceneFlight {
        let Some(sampler) = self.distance.filter(|sampler| *sampler != DistanceSampler::Equiangular) else {
            return first_of_all(scene, ray, way, random);
        };
        let Some(along) = AlongRay::through_spans(&scene.volumes, &way.spans, ray) else {
            return SceneFlight { collision: None, weight: 0.0, escape: 1.0 };
        };
        let Flight { t, weight, escape } = sampler.sample(&along, random, &mut Lookups::default());
        let at = |t| {
            // One volume needs no draw, so that a choice of the default gives the default's bits.
            let u = if scene.volumes.len() == 1 { 0.0 } else { random.f64() };
            (t, along.volume_at(t, u))
        };
        SceneFlight { collision: t.map(at), weight, escape }
    }

    /// A collision that happens with the true probability, which those of weighted flights do not.
    pub(crate) fn analog_collision(
        &self,
        scene: &Scene,
        ray: &Ray,
        way: &Way,
        flight: &SceneFlight,
        random: &mut Random,
    ) -> Option<(f64, usize)> {
        let is_weighted = self.distance.is_some_and(|sampler| !sampler.is_analog());
        let is_equiangular = self.distance == Some(DistanceSampler::Equiangular);
        if is_weighted && !is_equiangular {
            first_of_all(scene, ray, way, random).collision
        } else {
            flight.collision
        }
    }

    /// The ray as a place to sample point lights from, if that is wanted.
    pub(crate) fn lit_segment<'a>(&self, scene: &'a Scene, ray: &Ray, way: &Way) -> Option<LitSegment<'a>> {
        let is_wanted = self.distance == Some(DistanceSampler::Equiangular);
        is_wanted.then(|| LitSegment::new(scene, ray, way))?
    }

    /// An estimate of the transmittance of all volumes along the way of `ray`.
    pub(crate) fn transmittance(&self, scene: &Scene, ray: &Ray, way: &Way, random: &mut Random) -> f64 {
        if let Some(estimator) = self.transmittance {
            return AlongRay::through_spans(&scene.volumes, &way.spans, ray)
                .map_or(1.0, |along| estimator.estimate(&along, random, &mut Lookups::default()));
        }
        let mut transmittance = 1.0;
        for span in &way.spans {
            let volume = &scene.volumes[span.volume];
            transmittance *= estimate_transmittance(volume, ray, (span.start, span.end), random);
            if transmittance == 0.0 {
                return 0.0;
            }
        }
        transmittance
    }
}

/// The nearest of the first collisions with each of the volumes.
fn first_of_all(scene: &Scene, ray: &Ray, way: &Way, random: &mut Random) -> SceneFlight {
    let mut collision = None;
    let mut end = way.end;
    for span in &way.spans {
        let volume = &scene.volumes[span.volume];
        if let Some(distance) = sample_distance(volume, ray, (span.start, span.end.min(end)), random) {
            end = distance;
            collision = Some((distance, span.volume));
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
                let is_sampled =
                    |(light, probability): (&Light, &f64)| LitSegment::samples(light) && *probability > 0.0;
                if !scene.lights.iter().zip(&scene.light_probabilities).any(is_sampled) {
                    return Err(Reason(format!(
                        "{name}: the scene has no point light, spot light or lamp to sample; add one, or take another sampler"
                    )));
                }
            }
            Need::ExactThickness | Need::Control => {}
        }
    }
    Ok(())
}
