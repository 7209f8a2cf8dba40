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
use tyndall_scene::Ray;

use super::stretch::Stretch;

/// Optical thickness below which the second half is uniform.
const THIN: f64 = 0.05;
/// Optical thickness behind which no equiangular distances lie, however far the medium goes on.
const DEEP: f64 = 40.0;

/// Where a lamp is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub center: DVec3,
    /// s².
    pub softening: f64,
}

/// The mixture.
pub(super) struct Distances {
    stretch: Stretch,
    equiangular: Option<Equiangular>,
    /// 1 − T of the whole stretch; none where the second half is uniform.
    opacity: Option<f64>,
}

/// As `distance::equiangular`, by the tangent of the first angle and the difference of both.
struct Equiangular {
    nearest: f64,
    distance: f64,
    first: f64,
    angle: f64,
    end: f64,
}

impl Distances {
    #[inline(always)]
    pub fn new(place: Option<&Place>, ray: &Ray, stretch: &Stretch) -> Self {
        let is_thin = stretch.mu_t * (stretch.end - stretch.start) < THIN;
        let opacity = (!is_thin).then(|| 1.0 - f64::from(stretch.through()));
        let equiangular = place.and_then(|place| Equiangular::new(place, ray, stretch));
        Self { stretch: *stretch, equiangular, opacity }
    }

    /// The distance number `k` of `count`, an even number, by numbers for either half in [0, 1).
    #[inline(always)]
    pub fn draw(&self, k: usize, count: usize, u: [f32; 2]) -> f64 {
        let halves = self.equiangular.as_ref().map(|equiangular| (equiangular, k % 2 == 0));
        match halves {
            Some((equiangular, true)) => {
                equiangular.draw((k / 2) as f64 + f64::from(u[0]), (count / 2) as f64, &self.stretch)
            }
            Some(_) => self.by_transmittance(((k / 2) as f32 + u[1]) / (count / 2) as f32),
            None => self.by_transmittance((k as f32 + u[1]) / count as f32),
        }
    }

    #[inline(always)]
    fn by_transmittance(&self, u: f32) -> f64 {
        let Stretch { start, end, mu_t, .. } = self.stretch;
        let t = match self.opacity {
            None => start + f64::from(u) * (end - start),
            Some(opacity) => start - f64::from(tyndall_lanes::ln(1.0 - u * opacity as f32)) / mu_t,
        };
        t.clamp(start, end)
    }

    /// Density of distances, per length.
    #[inline(always)]
    pub fn pdf(&self, t: f64) -> f64 {
        let Stretch { start, end, mu_t, .. } = self.stretch;
        let by_transmittance = match self.opacity {
            None => 1.0 / (end - start),
            Some(opacity) => mu_t * f64::from(self.stretch.transmittance(t)) / opacity,
        };
        match &self.equiangular {
            Some(equiangular) => 0.5 * (equiangular.pdf(t) + by_transmittance),
            None => by_transmittance,
        }
    }
}

impl Equiangular {
    #[inline(always)]
    fn new(place: &Place, ray: &Ray, stretch: &Stretch) -> Option<Self> {
        let offset = place.center - ray.origin;
        let nearest = offset.dot(ray.direction);
        let beside = (offset - ray.direction * nearest).length_squared();
        let distance = (beside + place.softening).sqrt();
        let end = stretch.end.min(stretch.start + DEEP / stretch.mu_t);
        let (first, last) = ((stretch.start - nearest) / distance, (end - nearest) / distance);
        let angle = (last - first).atan2(1.0 + first * last);
        // Nearer the ray, angles do not tell places on it.
        let is_usable = distance > 1e-9 * (end - stretch.start) && angle > 0.0;
        is_usable.then_some(Self { nearest, distance, first, angle, end })
    }

    #[inline(always)]
    fn draw(&self, stratum: f64, strata: f64, stretch: &Stretch) -> f64 {
        let (sin, cos) = (self.angle * (stratum / strata)).sin_cos();
        // The tangent of the sum of two angles.
        let tangent = (self.first * cos + sin) / (cos - self.first * sin);
        (self.nearest + self.distance * tangent).clamp(stretch.start, self.end)
    }

    #[inline(always)]
    fn pdf(&self, t: f64) -> f64 {
        let along = t - self.nearest;
        let squared = self.distance * self.distance + along * along;
        if t <= self.end { self.distance / (self.angle * squared) } else { 0.0 }
    }
}
