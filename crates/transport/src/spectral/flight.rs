//! A free flight of the hero: tentative collisions in all volumes up to the first real one, and the densities with which
//! every channel would have drawn them.
//!
//! In a volume of density D ≤ D̄ hero c has tentative collisions of rate μt_c·D̄, which are real with probability ρ = D/D̄
//! whichever the channel. Up to the end t of the flight, with N null collisions, hero c draws it with the density
//!
//!   μt_c^N exp(−μt_c ∫₀^t D̄) Π(1 − ρ) · μt_c at a real collision,
//!
//! times what all channels have in common. Where volumes overlap these multiply; what a volume was found to hold beyond
//! the first real collision of all is not part of the flight.

use std::ops::ControlFlow;

use glam::DVec4;
use tyndall_lanes::Random;
use tyndall_scene::{ChannelMedium, Density, Ray, Volume};
use tyndall_volumes::BrickGrid;

use crate::along_ray::further;
use crate::way::Way;

/// One free flight.
#[derive(Debug, Clone)]
pub(super) struct Flight {
    /// Distance of the first real collision and the number of its volume; none if the ray leaves the scene.
    pub collision: Option<(f64, usize)>,
    /// ln p_c of the flight, up to a constant; −∞ for channels that could not have drawn it.
    pub log_density: DVec4,
    /// The same for a shadow ray along it, which takes all collisions for null.
    pub log_next_event: DVec4,
    /// Π(1 − ρ) over the null collisions, by which the flight is less dense than the shadow ray.
    pub null_fraction: f64,
    /// Volume, distance and 1 − ρ of the null collisions.
    nulls: Vec<(usize, f64, f64)>,
}

impl Flight {
    /// Draws a flight on the way of `ray` for the channel `hero`; `media` are those of the volumes.
    pub(super) fn draw(
        volumes: &[Volume],
        media: &[ChannelMedium],
        ray: &Ray,
        way: &Way,
        hero: usize,
        random: &mut Random,
    ) -> Flight {
        let mu_t: Vec<DVec4> = media.iter().map(|medium| medium.mu_t_along(ray.direction)).collect();
        let mut collision = None;
        let mut end = way.end;
        let mut nulls: Vec<(usize, f64, f64)> = Vec::new();
        for span in &way.spans {
            let (volume, number) = (&volumes[span.volume], span.volume);
            let local = volume.local_ray(ray);
            let note_null = |t, fraction| nulls.push((number, t, fraction));
            let range = (span.start, span.end.min(end));
            let real = first_real_collision(volume, &local, range, mu_t[number][hero], random, note_null);
            if let Some(distance) = real {
                end = distance;
                collision = Some((distance, number));
            }
        }
        let mut flight = Flight { collision, nulls, ..Flight::start() };
        flight.weigh(volumes, &mu_t, ray, way, end);
        flight
    }

    /// The part of the flight before the distance `t`, which is less than that of its collision.
    pub(super) fn up_to(
        &self,
        volumes: &[Volume],
        media: &[ChannelMedium],
        ray: &Ray,
        way: &Way,
        t: f64,
    ) -> Flight {
        let mu_t: Vec<DVec4> = media.iter().map(|medium| medium.mu_t_along(ray.direction)).collect();
        let mut part = Flight { nulls: self.nulls.clone(), ..Flight::start() };
        part.weigh(volumes, &mu_t, ray, way, t);
        part
    }

    /// A flight that has not begun.
    fn start() -> Flight {
        Flight {
            collision: None,
            log_density: DVec4::ZERO,
            log_next_event: DVec4::ZERO,
            null_fraction: 1.0,
            nulls: Vec::new(),
        }
    }

    /// Fills in the densities of the flight that ends at `end`.
    fn weigh(&mut self, volumes: &[Volume], mu_t: &[DVec4], ray: &Ray, way: &Way, end: f64) {
        for span in way.spans.iter().filter(|span| span.start < end) {
            let volume = &volumes[span.volume];
            let integral = bound_integral(volume, &volume.local_ray(ray), (span.start, span.end.min(end)));
            let thickness = optical_thickness(mu_t[span.volume], integral);
            self.log_density -= thickness;
            if matches!(volume.density, Density::Grid(_)) {
                self.log_next_event -= thickness;
            }
        }
        for &(number, _, fraction) in self.nulls.iter().filter(|(_, t, _)| *t < end) {
            let log_mu_t = ln(mu_t[number]);
            self.log_density += log_mu_t;
            self.log_next_event += log_mu_t;
            self.null_fraction *= fraction;
        }
        if let Some((_, number)) = self.collision {
            self.log_density += ln(mu_t[number]);
        }
    }
}

/// The distance of the first real collision in a volume between the distances of `range`; null ones are told to `note_null` with their
/// distance and 1 − ρ.
fn first_real_collision(
    volume: &Volume,
    local: &Ray,
    range: (f64, f64),
    mu_t: f64,
    random: &mut Random,
    mut note_null: impl FnMut(f64, f64),
) -> Option<f64> {
    if mu_t <= 0.0 {
        return None;
    }
    let Density::Grid(grid) = &volume.density else {
        let (enter, leave) = volume.interval(local, range)?;
        let distance = volume.distance_of_integral(local, enter, random.exponential_f64() / mu_t);
        return (distance < leave).then_some(distance);
    };
    tentative_collisions(grid, local, range, mu_t, random, |t, rho, random| {
        if random.f64() < rho {
            return ControlFlow::Break(t);
        }
        note_null(t, 1.0 - rho);
        ControlFlow::Continue(())
    })
    .break_value()
}

/// Calls `visit` with the distance and ρ = D/D̄ of each tentative collision along the ray between the distances of
/// `range`, in order, until it breaks. `mu_t` is positive.
pub(super) fn tentative_collisions<B>(
    grid: &BrickGrid,
    local: &Ray,
    range: (f64, f64),
    mu_t: f64,
    random: &mut Random,
    mut visit: impl FnMut(f64, f64, &mut Random) -> ControlFlow<B>,
) -> ControlFlow<B> {
    grid.segments(local.origin, local.direction, range, |segment| {
        let bound = f64::from(segment.bounds.max);
        if bound <= 0.0 {
            return ControlFlow::Continue(());
        }
        let mut t = segment.start;
        loop {
            t = further(t, random.exponential_f64() / (mu_t * bound));
            if t >= segment.end {
                return ControlFlow::Continue(());
            }
            visit(t, (grid.value(local.at(t)) / bound).clamp(0.0, 1.0), random)?;
        }
    })
}

/// ∫ D̄ along the ray between the distances of `range`: of the bounds of a grid, of the density itself where it has a closed form.
pub(super) fn bound_integral(volume: &Volume, local: &Ray, range: (f64, f64)) -> f64 {
    let Density::Grid(grid) = &volume.density else {
        let within = volume.interval(local, range);
        return within.and_then(|within| volume.density_integral(local, within)).unwrap_or(0.0);
    };
    let mut integral = 0.0;
    let _: ControlFlow<()> = grid.segments(local.origin, local.direction, range, |segment| {
        integral += f64::from(segment.bounds.max) * (segment.end - segment.start);
        ControlFlow::Continue(())
    });
    integral
}

/// μt times a length, which may be infinite: nothing where μt is 0.
pub(super) fn optical_thickness(mu_t: DVec4, length: f64) -> DVec4 {
    DVec4::select(mu_t.cmpgt(DVec4::ZERO), mu_t * length, DVec4::ZERO)
}

pub(super) fn ln(values: DVec4) -> DVec4 {
    DVec4::from_array(values.to_array().map(libm::log))
}
