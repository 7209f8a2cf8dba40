//! A scene ready to trace.

use glam::DVec3;
use tyndall_optics::Spectrum;

use crate::light::{AreaLight, Light, LightTree};
use crate::surface::{Boundaries, Hit, Presence, Surfaces};
use crate::{Camera, Observer, Volume};

/// Everything that transport needs, in world space.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    /// Columns and rows of the picture.
    pub resolution: [u32; 2],
    /// Media; where they overlap their coefficients add.
    pub volumes: Vec<Volume>,
    /// Lights.
    pub lights: Vec<Light>,
    /// For each light its spectrum at luminance 1, if that is not the one of its red, green and blue: at a wavelength the
    /// light is the spectrum times the luminance of what it shines in RGB. Lights beyond its end have none.
    pub light_spectra: Vec<Option<Spectrum>>,
    /// Probability that next-event estimation draws each light. It is 0 for lights that continued paths find as
    /// well by themselves, and sums to 1 unless it is 0 for all. Of lights in the tree only their sum matters. Change them by
    /// [`Scene::set_light_probabilities`].
    pub light_probabilities: Vec<f64>,
    /// Chooses by place among lights that are somewhere, if these are many. Lights at infinity have their share whatever
    /// the place: the light that enters the scene from there, compared to the power of those inside.
    pub light_tree: Option<LightTree>,
    /// Surfaces.
    pub surfaces: Surfaces,
    /// Which volumes the surfaces bound.
    pub boundaries: Boundaries,
    /// The volumes that are present where all rays of the camera begin; to be found for each ray if absent.
    pub camera_presence: Option<Presence>,
    /// Greatest number of scattering events on a path; unlimited if absent.
    pub max_depth: Option<u32>,
    /// What the channels of the picture are.
    pub observer: Observer,
}

impl Scene {
    /// Whether the extinction or the phase function of some medium depends on colour.
    pub fn is_chromatic(&self) -> bool {
        self.volumes.iter().any(|volume| volume.medium.chromatic.is_some())
    }

    /// Whether only the spectral integrator can render the scene: it is chromatic, or light of all wavelengths is wanted.
    pub fn is_spectral(&self) -> bool {
        self.is_chromatic() || self.observer != Observer::Rgb
    }

    /// Number of the light for next-event estimation at `from` for `u` in [0, 1), and the probability with which it was
    /// drawn.
    pub fn choose_light(&self, from: DVec3, u: f64) -> Option<(usize, f64)> {
        let Some(tree) = &self.light_tree else {
            return self.choose_among(0..self.light_probabilities.len(), u);
        };
        let beside = 1.0 - tree.share();
        if u < beside {
            return self.choose_among(tree.others().iter().copied(), u);
        }
        let (number, probability) = tree.choose(from, (u - beside) / tree.share());
        Some((number, tree.share() * probability))
    }

    fn choose_among(&self, numbers: impl Iterator<Item = usize>, u: f64) -> Option<(usize, f64)> {
        let mut rest = u;
        let mut last = None;
        for number in numbers {
            let probability = self.light_probabilities[number];
            if probability <= 0.0 {
                continue;
            }
            last = Some((number, probability));
            if rest < probability {
                break;
            }
            rest -= probability;
        }
        last
    }

    /// The volumes that are present where a ray of the camera begins.
    pub fn presence_at_camera(&self, origin: DVec3) -> Presence {
        match &self.camera_presence {
            Some(presence) => presence.clone(),
            None => self.boundaries.presence_at(origin, &self.surfaces),
        }
    }

    /// The lamp that the surface at `hit` is, and its number among the lights.
    pub fn lamp(&self, hit: &Hit) -> Option<(usize, &AreaLight)> {
        let number = self.surfaces.shape(hit).light?;
        match &self.lights[number] {
            Light::Area(lamp) => Some((number, lamp)),
            _ => None,
        }
    }

    /// Number of the light that the volume of this number is, if it is one.
    pub fn light_of_volume(&self, volume: usize) -> Option<usize> {
        self.lights.iter().position(|light| matches!(light, Light::Volume(light) if light.volume() == volume))
    }

    /// Probability with which [`choose_light`](Self::choose_light) draws the light of this number at `from`.
    pub fn light_probability(&self, number: usize, from: DVec3) -> f64 {
        match &self.light_tree {
            Some(tree) if tree.contains(number) => tree.share() * tree.probability(number, from),
            _ => self.light_probabilities[number],
        }
    }

    /// Draws lights with these probabilities from now on, whatever the place.
    pub fn set_light_probabilities(&mut self, probabilities: Vec<f64>) {
        self.light_probabilities = probabilities;
        self.light_tree = None;
    }
}

/// Probabilities for next-event estimation, in proportion to the light that enters a scene of radius
/// `scene_radius`, times its unevenness over directions.
///
/// Light that comes evenly from everywhere is found best by directions drawn from the phase function; a shadow ray
/// would only repeat that work.
pub(crate) fn light_probabilities(lights: &[Light], scene_radius: f64) -> Vec<f64> {
    let weights: Vec<f64> =
        lights.iter().map(|light| light.selection_weight(scene_radius) * unevenness(light)).collect();
    let total: f64 = weights.iter().sum();
    let share = |weight: f64| if total > 0.0 && total.is_finite() { weight / total } else { 0.0 };
    weights.into_iter().map(share).collect()
}

/// 1 − (mean L)²/mean(L²) over all directions: 0 for constant light, near 1 for a bright spot.
fn unevenness(light: &Light) -> f64 {
    match light {
        Light::Constant(_) => return 0.0,
        Light::Point(_) | Light::Spot(_) | Light::Area(_) | Light::Volume(_) => return 1.0,
        Light::Image(_) | Light::Sun(_) | Light::Distant(_) => {}
    }
    let luminance = |radiance: DVec3| radiance.element_sum();
    let (mut first, mut second) = (0.0, 0.0);
    let n = 32;
    for i in 0..n * n {
        let u = [f64::from(i % n), f64::from(i / n)].map(|k| (k + 0.5) / f64::from(n));
        let sample = light.sample(DVec3::ZERO, u);
        if sample.is_delta {
            return 1.0;
        }
        let over_pdf = luminance(sample.radiance_over_pdf);
        first += over_pdf;
        second += over_pdf * luminance(light.radiance(sample.toward));
    }
    let count = f64::from(n * n);
    let (mean, mean_square) = (first / count, second / count);
    let sphere = 4.0 * std::f64::consts::PI;
    if mean_square > 0.0 { (1.0 - mean * mean / (sphere * mean_square)).max(0.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{ConstantLight, DistantLight, SunLight};

    fn constant() -> Light {
        Light::Constant(ConstantLight::new(DVec3::ONE))
    }

    #[test]
    fn even_light_is_left_to_the_phase_function() {
        let distant = Light::Distant(DistantLight::new(DVec3::NEG_Y, DVec3::ONE));
        assert_eq!(light_probabilities(&[constant(), distant], 1.0), [0.0, 1.0]);
        assert_eq!(light_probabilities(&[constant()], 1.0), [0.0]);
        let sun = Light::Sun(SunLight::new(DVec3::Y, DVec3::ONE, 0.5));
        assert!(unevenness(&sun) > 0.99);
    }

    #[test]
    fn lights_are_drawn_with_their_probabilities() {
        let light = |strength: f64| Light::Distant(DistantLight::new(DVec3::NEG_Y, DVec3::splat(strength)));
        let lights = vec![light(1.0), constant(), light(3.0)];
        let light_probabilities = light_probabilities(&lights, 2.0);
        assert_eq!(light_probabilities, [0.25, 0.0, 0.75]);
        let camera = "camera = { position = [0, 0, 1], target = [0, 0, 0] }";
        let description = crate::SceneDocument::parse("test", camera).unwrap().description().unwrap();
        let camera = Camera::new(&description.camera, [1, 1], None);
        let scene = Scene {
            camera,
            resolution: [1, 1],
            volumes: vec![],
            light_spectra: vec![None; lights.len()],
            lights,
            light_probabilities,
            light_tree: None,
            surfaces: Surfaces::default(),
            boundaries: Boundaries::default(),
            camera_presence: None,
            max_depth: None,
            observer: Observer::Rgb,
        };
        assert_eq!(scene.choose_light(DVec3::ZERO, 0.2).map(|(_, p)| p), Some(0.25));
        assert_eq!(scene.choose_light(DVec3::ZERO, 0.26).map(|(_, p)| p), Some(0.75));
        assert_eq!(scene.choose_light(DVec3::ZERO, 1.0 - 1e-16).map(|(_, p)| p), Some(0.75));
    }
}
