//! Distances on a stretch of the medium at which light of a lamp is looked for.
//!
//! Half are equiangular about the lamp (Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in
//! participating media"), softened by its size s:
//!
//!   p_e(t) ∝ 1/(D² + s² + (t − t₀)²)
//!
//! with t₀ nearest the lamp's middle at the distance D. Half follow the transmittance, p_c(t) ∝ T(t), or are uniform where T
//! hardly changes. The density is that of the mixture, (p_e + p_c)/2, whichever half has drawn one. Lights at infinity have no
//! place beside the ray: for them all follow p_c.

use glam::DVec3;
use tyndall_lanes::sin_cos_turns;
use tyndall_scene::Ray;

use super::stretch::Stretch;

/// Optical thickness below which the second half is uniform.
const THIN: f32 = 0.05;
/// Optical thickness behind which no equiangular distances lie, however far the medium goes on.
const DEEP: f32 = 40.0;

/// Where a lamp is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub center: DVec3,
    /// s².
    pub softening: f64,
}

/// The mixture.
pub(super) struct Distances {
    length: f32,
    mu_t: f32,
    equiangular: Option<Equiangular>,
    /// 1 − T of the whole stretch; none where the second half is uniform.
    opacity: Option<f32>,
}

/// As `distance::equiangular`, by cosine and sine of the first angle and the difference of both.
#[derive(Clone, Copy)]
struct Equiangular {
    nearest: f32,
    distance: f32,
    first: [f32; 2],
    /// In turns.
    angle: f32,
    end: f32,
}

impl Distances {
    #[inline(always)]
    pub fn new(place: Option<&Place>, stretch: &Stretch) -> Self {
        let Stretch { length, mu_t, .. } = *stretch;
        let is_thin = mu_t * length < THIN;
        let opacity = (!is_thin).then(|| 1.0 - stretch.through);
        let end = length.min(DEEP / mu_t);
        let equiangular = place.and_then(|place| Equiangular::new(place, &stretch.ray, end));
        Self { length, mu_t, equiangular, opacity }
    }

    /// `N` distances, an even number of them, by numbers for either half in [0, 1).
    #[inline(always)]
    pub fn draw<const N: usize>(&self, u: [f32; 2]) -> [f32; N] {
        let mut t = [0.0; N];
        let half = if self.equiangular.is_some() { N / 2 } else { 0 };
        if let Some(equiangular) = &self.equiangular {
            for k in 0..N / 2 {
                t[k] = equiangular.at((k as f32 + u[0]) * (1.0 / (N / 2) as f32));
            }
        }
        let scale = 1.0 / (N - half) as f32;
        for k in half..N {
            let u = ((k - half) as f32 + u[1]) * scale;
            t[k] = match self.opacity {
                None => u * self.length,
                Some(opacity) => -tyndall_lanes::ln(1.0 - u * opacity) / self.mu_t,
            };
        }
        for t in &mut t {
            *t = t.max(0.0).min(self.length);
        }
        t
    }

    /// Densities of distances, per length, where the transmittance is known.
    #[inline(always)]
    pub fn pdfs<const N: usize>(&self, t: &[f32; N], transmittance: &[f32; N]) -> [f32; N] {
        let mut pdf = [1.0 / self.length; N];
        if let Some(opacity) = self.opacity {
            let scale = self.mu_t / opacity;
            for k in 0..N {
                pdf[k] = scale * transmittance[k];
            }
        }
        if let Some(equiangular) = &self.equiangular {
            for k in 0..N {
                pdf[k] = 0.5 * (pdf[k] + equiangular.pdf(t[k]));
            }
        }
        pdf
    }
}

impl Equiangular {
    /// None where angles do not tell places on the ray from each other.
    #[inline(always)]
    fn new(place: &Place, ray: &Ray, end: f32) -> Option<Self> {
        let offset = place.center - ray.origin;
        let nearest = offset.dot(ray.direction);
        let beside = (offset - ray.direction * nearest).length_squared();
        let distance = (beside + place.softening).sqrt();
        let (a, b) = (-nearest, f64::from(end) - nearest);
        let angle = (distance * (b - a)).atan2(distance * distance + a * b);
        let scale = 1.0 / (distance * distance + a * a).sqrt();
        let is_usable = distance > 1e-6 * f64::from(end) && angle > 0.0;
        is_usable.then_some(Self {
            nearest: nearest as f32,
            distance: distance as f32,
            first: [(distance * scale) as f32, (a * scale) as f32],
            angle: (angle * (0.5 * std::f64::consts::FRAC_1_PI)) as f32,
            end,
        })
    }

    #[inline(always)]
    fn at(&self, u: f32) -> f32 {
        let (sin, cos) = sin_cos_turns(self.angle * u);
        let [first_cos, first_sin] = self.first;
        let tangent = (first_sin * cos + first_cos * sin) / (first_cos * cos - first_sin * sin);
        (self.nearest + self.distance * tangent).min(self.end)
    }

    #[inline(always)]
    fn pdf(&self, t: f32) -> f32 {
        let along = t - self.nearest;
        let squared = self.distance * self.distance + along * along;
        let angle = self.angle * std::f32::consts::TAU;
        if t <= self.end { self.distance / (angle * squared) } else { 0.0 }
    }
}
