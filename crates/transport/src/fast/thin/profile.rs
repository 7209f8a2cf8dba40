//! The extinction along a ray, by steps of a voxel or two.
//!
//! A profile μ̄ is rough, the nearest voxel standing for a step, but known everywhere, so it is a density to draw places from
//! and a control variate of the transmittance:
//!
//!   T(t) = exp(−∫ μ̄) · exp(−Δ),   Δ = ∫₀ᵗ (μt − μ̄),   exp(−Δ) = 1 − Δ₁ + Δ₁Δ₂/2! − …
//!
//! where the Δₖ are independent unbiased estimates of Δ, by stratified taps, and the series is ended by roulette (the power
//! series of Georgiev et al. 2019; the control by a marched estimate is the idea of Kettunen et al. 2021). Unbiased; negative
//! where a Δ₁ happens to be above 1, which takes a profile that is far off. Lookups: one a step, and one for
//! [`STEPS_PER_TAP`] steps.

use glam::Vec3;
use tyndall_lanes::Random;

use super::super::volume::FastGrid;

/// Steps of the longest profile.
pub(super) const STEPS: usize = 256;

/// Voxels that a step is long, unless the ray is too long for that.
const VOXELS_PER_STEP: f32 = 1.5;

/// Steps for each random tap that corrects the profile.
const STEPS_PER_TAP: usize = 5;

/// Probability with which the series goes on after its first term.
const SERIES_SURVIVAL: f32 = 0.2;

/// Part of the places that is drawn evenly over the ray, so that none is left out.
const EVEN_SHARE: f32 = 0.03;

/// A ray in the local voxel coordinates of a grid; distances along it are those of the world.
#[derive(Clone, Copy)]
pub(in super::super) struct LocalRay {
    pub origin: Vec3,
    pub direction: Vec3,
    pub enter: f32,
    pub leave: f32,
}

impl LocalRay {
    /// The part of the ray inside the grid's domain and before `end`; positions are relative to the scene's centre.
    #[inline(always)]
    pub fn new(grid: &FastGrid<'_>, origin: Vec3, direction: Vec3, end: f32) -> Option<LocalRay> {
        let origin = grid.to_local.transform_point3(origin);
        let direction = super::super::keep_from_zero(grid.to_local.transform_vector3(direction));
        let inverse = direction.recip();
        let (a, b) = ((grid.min - origin) * inverse, (grid.max - origin) * inverse);
        let enter = a.min(b).max_element().max(0.0);
        let leave = a.max(b).min_element().min(end);
        (enter < leave).then_some(LocalRay { origin, direction, enter, leave })
    }

    #[inline(always)]
    fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// Number of steps, and their length.
    #[inline(always)]
    fn steps(&self, stride: f32) -> (usize, f32) {
        let length = self.leave - self.enter;
        let voxels = length * self.direction.length();
        let count = ((voxels / stride) as usize + 1).min(STEPS);
        (count, length / count as f32)
    }

    /// An unbiased estimate of ∫ (μt − μ̄) from where the ray enters to `end`, where `steps` of the length `step` have the
    /// extinction of their middle's nearest voxel.
    #[inline(always)]
    fn difference(&self, grid: &FastGrid<'_>, mu_t: f32, end: f32, step: f32, random: &mut Random) -> f32 {
        let length = end - self.enter;
        let taps = (length / step) as usize / STEPS_PER_TAP + 2;
        let stride = length / taps as f32;
        let mut sum = 0.0;
        for tap in 0..taps {
            let [jitter, _] = random.f32x2();
            let along = (tap as f32 + jitter) * stride;
            let middle = ((along / step).floor() + 0.5) * step;
            let truth = grid.tap(self.at(self.enter + along), random.f32x3());
            sum += truth - grid.nearest(self.at(self.enter + middle));
        }
        mu_t * sum * stride
    }

    /// An unbiased estimate of exp(−Δ).
    #[inline(always)]
    fn correction(&self, grid: &FastGrid<'_>, mu_t: f32, end: f32, step: f32, random: &mut Random) -> f32 {
        let mut term = -self.difference(grid, mu_t, end, step, random);
        let mut sum = 1.0 + term;
        let mut order = 2.0;
        while random.f32() < SERIES_SURVIVAL {
            term *= -self.difference(grid, mu_t, end, step, random) / (order * SERIES_SURVIVAL);
            sum += term;
            order += 1.0;
        }
        sum
    }

    /// An unbiased estimate of the transmittance over the whole ray, with steps that are `stride` voxels long.
    #[inline(always)]
    pub fn transmittance(&self, grid: &FastGrid<'_>, mu_t: f32, stride: f32, random: &mut Random) -> f32 {
        let (count, step) = self.steps(stride);
        let mut sum = 0.0;
        for i in 0..count {
            sum += grid.nearest(self.at(self.enter + (i as f32 + 0.5) * step));
        }
        tyndall_lanes::exp(-mu_t * sum * step) * self.correction(grid, mu_t, self.leave, step, random)
    }
}

/// The profile of a ray.
pub(in super::super) struct Profile {
    ray: LocalRay,
    count: usize,
    step: f32,
    /// Optical thickness up to each step's beginning, and all of it.
    tau: [f32; STEPS + 1],
    /// Probability of a collision before each step's beginning, by its weights, not normalised.
    collides: [f32; STEPS + 1],
    /// The same of the light that the medium sends out.
    shines: [f32; STEPS + 1],
}

/// A place along a ray, and 1 over its density per length.
pub(in super::super) struct Place {
    pub t: f32,
    pub over_pdf: f32,
}

impl Profile {
    pub fn new() -> Profile {
        let ray = LocalRay { origin: Vec3::ZERO, direction: Vec3::ONE, enter: 0.0, leave: 1.0 };
        let zero = [0.0; STEPS + 1];
        Profile { ray, count: 1, step: 1.0, tau: zero, collides: zero, shines: zero }
    }

    /// Becomes that of `ray`. `surroundings` is the brightness at a distance, by which collisions are weighted, and the mean
    /// μt around it, which has half a say in where they are, since the nearest voxel may be 0 where others beside it are
    /// not; light is sent out in proportion to `source`.
    #[inline(always)]
    pub fn march(
        &mut self,
        grid: &FastGrid<'_>,
        mu_t: f32,
        ray: LocalRay,
        surroundings: impl Fn(f32) -> [f32; 2],
        source: Option<impl Fn(f32) -> f32>,
    ) {
        self.ray = ray;
        (self.count, self.step) = ray.steps(VOXELS_PER_STEP);
        let middle = |i: usize| ray.enter + (i as f32 + 0.5) * self.step;
        let mut tau = 0.0;
        for i in 0..self.count {
            tau += mu_t * self.step * grid.nearest(ray.at(middle(i)));
            self.tau[i + 1] = tau;
        }
        let (mut before, mut collides, mut shines) = (1.0, 0.0, 0.0);
        for i in 0..self.count {
            let after = tyndall_lanes::exp(-self.tau[i + 1]);
            let [brightness, mean_mu_t] = surroundings(middle(i));
            collides += brightness * ((before - after) + before * mean_mu_t * self.step);
            self.collides[i + 1] = collides;
            if let Some(source) = &source {
                shines += 0.5 * (before + after) * source(middle(i));
                self.shines[i + 1] = shines;
            }
            before = after;
        }
    }

    /// Roughly the transmittance of the whole ray.
    pub fn rough_transmittance(&self) -> f32 {
        tyndall_lanes::exp(-self.tau[self.count])
    }

    /// An unbiased estimate of the transmittance up to `t`.
    #[inline(always)]
    pub fn transmittance(&self, grid: &FastGrid<'_>, mu_t: f32, t: f32, random: &mut Random) -> f32 {
        let along = (t - self.ray.enter) / self.step;
        let i = (along as usize).min(self.count - 1);
        let tau = self.tau[i] + (self.tau[i + 1] - self.tau[i]) * (along - i as f32);
        tyndall_lanes::exp(-tau) * self.ray.correction(grid, mu_t, t, self.step, random)
    }

    /// Where the ray leaves the grid.
    pub fn end(&self) -> f32 {
        self.ray.leave
    }

    /// A place to collide at.
    #[inline(always)]
    pub fn collision(&self, u: f32) -> Place {
        self.place(&self.collides, u)
    }

    /// A place to take the emitted light from.
    #[inline(always)]
    pub fn emission(&self, u: f32) -> Place {
        self.place(&self.shines, u)
    }

    #[inline(always)]
    fn place(&self, sums: &[f32; STEPS + 1], u: f32) -> Place {
        let total = sums[self.count];
        let length = self.ray.leave - self.ray.enter;
        let even_share = if total > 0.0 { EVEN_SHARE } else { 1.0 };
        let (along, i) = if u < even_share {
            let along = u / even_share * self.count as f32;
            (along, (along as usize).min(self.count - 1))
        } else {
            let sum = (u - even_share) / (1.0 - even_share) * total;
            let i = sums[1..=self.count].partition_point(|&end| end <= sum).min(self.count - 1);
            let share = sums[i + 1] - sums[i];
            let within = if share > 0.0 { ((sum - sums[i]) / share).clamp(0.0, 1.0) } else { 0.5 };
            (i as f32 + within, i)
        };
        let by_weight = if total > 0.0 { (sums[i + 1] - sums[i]) / (total * self.step) } else { 0.0 };
        let pdf = even_share / length + (1.0 - even_share) * by_weight;
        Place { t: (self.ray.enter + along * self.step).min(self.ray.leave), over_pdf: 1.0 / pdf }
    }
}
