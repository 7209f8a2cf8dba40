//! Distances on a stretch of the medium at which light of a lamp is looked for.
//!
//! In a thin medium they are equiangular about the lamp (Kulla & Fajardo 2012, "Importance sampling techniques for path
//! tracing in participating media"), softened by its size s:
//!
//!   p_e(t) ∝ 1/(D² + s² + (t − t₀)²)
//!
//! with t₀ nearest the lamp's middle at the distance D. In a thick one, where the transmittance T changes as much, half of
//! them follow p_c(t) ∝ T(t) instead, and the density is that of the mixture, (p_e + p_c)/2, whichever half has drawn one.
//! Lights at infinity have no place beside the ray: for them all follow p_c, or are uniform where T hardly changes.

use glam::DVec3;
use tyndall_lanes::sin_cos_turns;
use tyndall_scene::Ray;

use super::stretch::Stretch;

/// Optical thickness from which on half of the distances follow the transmittance.
const THICK: f32 = 2.0;
/// Optical thickness below which T is as good as even.
const EVEN: f32 = 0.05;
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
    /// None of a light at infinity.
    equiangular: Option<Equiangular>,
    /// Share of the equiangular distances: all of them, half, or none.
    share: f32,
    /// 1 − T of the whole stretch; none where the others are uniform.
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
        let thickness = mu_t * length;
        let equiangular =
            place.and_then(|place| Equiangular::new(place, &stretch.ray, length.min(DEEP / mu_t)));
        let share = match &equiangular {
            None => 0.0,
            Some(_) if thickness < THICK => 1.0,
            Some(_) => 0.5,
        };
        let opacity = (thickness >= EVEN).then_some(1.0 - stretch.through);
        Self { length, mu_t, equiangular, share, opacity }
    }

    /// `N` distances, an even number of them, by a number in [0, 1) for either kind.
    #[inline(always)]
    pub fn draw<const N: usize>(&self, u: [f32; 2]) -> [f32; N] {
        let mut t = [0.0; N];
        let first = (self.share * N as f32) as usize;
        if let Some(equiangular) = &self.equiangular {
            let scale = 1.0 / first as f32;
            for (k, t) in t[..first].iter_mut().enumerate() {
                *t = equiangular.at((k as f32 + u[0]) * scale);
            }
        }
        let scale = 1.0 / (N - first) as f32;
        for (k, t) in t[first..].iter_mut().enumerate() {
            let u = (k as f32 + u[1]) * scale;
            *t = match self.opacity {
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
        let mut pdf = [0.0; N];
        if let Some(equiangular) = &self.equiangular {
            for k in 0..N {
                pdf[k] = self.share * equiangular.pdf(t[k]);
            }
        }
        if self.share < 1.0 {
            let rest = 1.0 - self.share;
            for k in 0..N {
                pdf[k] += match self.opacity {
                    None => rest / self.length,
                    Some(opacity) => rest * self.mu_t * transmittance[k] / opacity,
                };
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
        let angle = libm::atan2(distance * (b - a), distance * distance + a * b);
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

#[cfg(test)]
mod tests {
    use tyndall_lanes::Random;

    use super::*;

    /// Mean of f/p over drawn distances, and its standard error; p is the density with its equiangular part multiplied by
    /// `factor`.
    fn integral(distances: &Distances, f: impl Fn(f32) -> f32, factor: f32, samples: u32) -> [f64; 2] {
        let mut random = Random::new(3, 0, 0);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..samples {
            let t: [f32; 4] = distances.draw(random.f32x2());
            let pdf = distances.pdfs(&t, &t.map(|t| tyndall_lanes::exp(-distances.mu_t * t)));
            let mut mean = 0.0;
            for k in 0..4 {
                let part = distances.equiangular.as_ref().map_or(0.0, |part| part.pdf(t[k]));
                let pdf = pdf[k] + (factor - 1.0) * distances.share * part;
                mean += 0.25 * f64::from(f(t[k]) / pdf);
            }
            sum += mean;
            squares += mean * mean;
        }
        let n = f64::from(samples);
        [sum / n, ((squares / n - (sum / n).powi(2)) / n).sqrt()]
    }

    /// Within 5 standard errors: a false alarm in 1.7 million. An equiangular density that is wrong by 30 % is seen.
    #[test]
    fn distances_of_every_kind_integrate_airlight() {
        let ray = Ray { origin: DVec3::new(1.0, 2.0, 3.0), direction: DVec3::X };
        let kinds = [
            (0.01, 2.0, Some((0.5, 0.3, 0.0))),
            (0.5, 2.0, Some((1.9, 0.05, 0.01))),
            (3.0, 4.0, Some((1.0, 0.5, 0.0))),
            (1.0, f32::INFINITY, Some((-1.0, 0.5, 0.1))),
            (0.01, 2.0, None),
            (1.5, 2.0, None),
        ];
        for (mu_t, length, place) in kinds {
            let through = tyndall_lanes::exp(-mu_t * length);
            let stretch = Stretch { ray, start: 0.0, length, mu_t, through };
            let at = place.map(|(along, beside, softening)| Place {
                center: ray.origin + DVec3::new(along, 0.0, beside),
                softening,
            });
            let distances = Distances::new(at.as_ref(), &stretch);
            let (along, beside, _) = place.unwrap_or((0.7, 0.8, 0.0));
            let f = |t: f32| {
                let squared = (beside * beside) as f32 + (t - along as f32).powi(2);
                tyndall_lanes::exp(-mu_t * t) / squared
            };
            let end = f64::from(length.min(DEEP / mu_t));
            let steps = 400_000;
            let step = end / f64::from(steps);
            let truth: f64 =
                (0..steps).map(|k| step * f64::from(f(((f64::from(k) + 0.5) * step) as f32))).sum();
            let [mean, error] = integral(&distances, f, 1.0, 20_000);
            let z = (mean - truth) / (error + 1e-6 * truth);
            assert!(z.abs() < 5.0, "{mu_t} {length} {place:?}: {mean} {truth} {z}");
            if place.is_some() {
                let [mean, error] = integral(&distances, f, 1.3, 20_000);
                assert!(((mean - truth) / error).abs() > 10.0, "{mu_t} {length}: 30 % are not seen");
            }
        }
    }
}
