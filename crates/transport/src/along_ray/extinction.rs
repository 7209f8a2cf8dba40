//! The extinction of one medium along a ray: a formula, or a grid.

use std::ops::ControlFlow;

use tyndall_scene::{Density, Exponential, Ray, Volume};
use tyndall_volumes::{BrickGrid, Filter};

use super::bounding::Cell;
use super::voxels::voxel_intervals;
use super::{Lookups, Profile};

/// Optical thickness past which exp(−τ) is 0 in double precision, and no exponential variate comes near.
const OPAQUE: f64 = 800.0;

/// Optical thickness that cannot be told from 0 when it is added to anything that counts.
const NEGLIGIBLE: f64 = 1e-18;

/// One medium between two distances.
#[derive(Debug, Clone)]
pub(super) struct Stretch<'a> {
    pub start: f64,
    pub end: f64,
    /// Number of the volume in the scene.
    pub source: usize,
    pub extinction: Extinction<'a>,
    /// Number of pieces of equal length over which a formula is bounded.
    pieces: u32,
}

#[derive(Debug, Clone)]
pub(super) enum Extinction<'a> {
    /// A function of the distance.
    Formula(Profile),
    /// mu_t times the filtered values of a grid, along the ray `local` in the coordinates of its filter.
    Grid {
        grid: &'a BrickGrid,
        mu_t: f64,
        local: Ray,
        /// Distances between which the ray is looked at.
        limits: (f64, f64),
    },
}

impl<'a> Stretch<'a> {
    pub fn through(volume: &'a Volume, ray: &Ray, limits: (f64, f64)) -> Option<Self> {
        let local = volume.local_ray(ray);
        let range = volume.interval(&local, limits)?;
        let mu_t = volume.medium.mu_t_along(ray.direction);
        if mu_t <= 0.0 {
            return None;
        }
        match &volume.density {
            Density::Grid(grid) => Some(Self {
                start: range.0,
                end: range.1,
                source: 0,
                extinction: Extinction::Grid { grid, mu_t, local, limits },
                pieces: 1,
            }),
            Density::Everywhere | Density::Box { .. } | Density::Sphere | Density::Slab { .. } => {
                Self::opaque_at_the_end(Profile::Constant(mu_t), range)
            }
            Density::Atmosphere { bottom, scale_height, .. } => {
                let mut extinction = Exponential::of_atmosphere(&local, *bottom, *scale_height);
                extinction.logarithm += libm::log(mu_t);
                Self::opaque_at_the_end(Profile::Exponential(extinction), range)
            }
        }
    }

    /// A formula, cut where nothing of the light or of the medium is left.
    fn opaque_at_the_end(profile: Profile, (start, end): (f64, f64)) -> Option<Self> {
        let mut end = profile.distance_at(start, OPAQUE).map_or(end, |t| end.min(t));
        let mut pieces = 1;
        if let Profile::Exponential(Exponential { logarithm, rate }) = profile {
            if rate > 0.0 {
                end = end.min((logarithm - libm::log(rate * NEGLIGIBLE)) / rate);
            }
            // Within a piece the extinction at most doubles.
            pieces = (rate.abs() * (end - start) / std::f64::consts::LN_2).ceil().clamp(1.0, 1e4) as u32;
        }
        (start < end).then(|| Self::with_profile(profile, (start, end), pieces))
    }

    pub fn with_profile(profile: Profile, (start, end): (f64, f64), pieces: u32) -> Self {
        Self { start, end, source: 0, extinction: Extinction::Formula(profile), pieces: pieces.max(1) }
    }

    pub fn of(self, source: usize) -> Self {
        Self { source, ..self }
    }

    pub fn covers(&self, t: f64) -> bool {
        self.start <= t && t < self.end
    }

    /// The cells with their bounds, in order.
    pub fn cells<B>(&self, mut visit: impl FnMut(Cell) -> ControlFlow<B>) -> ControlFlow<B> {
        match &self.extinction {
            Extinction::Formula(profile) => {
                let at = |i: u32| {
                    if i == self.pieces {
                        return self.end;
                    }
                    self.start + (self.end - self.start) * (f64::from(i) / f64::from(self.pieces))
                };
                (0..self.pieces).try_for_each(|i| {
                    let (start, end) = (at(i), at(i + 1));
                    let (min, max) = profile.bounds(start, end);
                    visit(Cell { start, end, min, max })
                })
            }
            Extinction::Grid { grid, mu_t, local, limits } => {
                grid.segments(local.origin, local.direction, *limits, |segment| {
                    let (min, max) = (f64::from(segment.bounds.min), f64::from(segment.bounds.max));
                    visit(Cell {
                        start: segment.start,
                        end: segment.end,
                        min: mu_t * min.max(0.0),
                        max: mu_t * max,
                    })
                })
            }
        }
    }

    /// The intervals within which [`Extinction::smooth_thickness`] is exact, without those where there is nothing.
    pub fn smooth_intervals<B>(&self, mut visit: impl FnMut(f64, f64) -> ControlFlow<B>) -> ControlFlow<B> {
        self.cells(|cell| match &self.extinction {
            _ if cell.max <= 0.0 => ControlFlow::Continue(()),
            Extinction::Formula(_) => visit(cell.start, cell.end),
            Extinction::Grid { local, .. } => voxel_intervals(local, (cell.start, cell.end), &mut visit),
        })
    }
}

impl Extinction<'_> {
    pub fn mu_t(&self, t: f64) -> f64 {
        match self {
            Self::Formula(profile) => profile.mu_t(t),
            Self::Grid { grid, mu_t, local, .. } => mu_t * grid.value(local.at(t)),
        }
    }

    pub fn has_closed_form(&self) -> bool {
        match self {
            Self::Formula(_) => true,
            Self::Grid { grid, .. } => grid.filter() == Filter::Nearest,
        }
    }

    /// ∫ μt from `a` to `b` within a smooth interval. Between planes of voxel centres the trilinear field along a ray
    /// is a cubic polynomial, for which the Gauss-Legendre rule of two points is exact; unfiltered it is constant.
    pub fn smooth_thickness(&self, a: f64, b: f64, lookups: &mut Lookups) -> f64 {
        match self {
            Self::Formula(profile) => profile.thickness(a, b),
            Self::Grid { grid, .. } if grid.filter() == Filter::Nearest => {
                lookups.0 += 1;
                (b - a) * self.mu_t(0.5 * (a + b))
            }
            Self::Grid { .. } => {
                lookups.0 += 2;
                let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
                let offset = half / 3.0_f64.sqrt();
                half * (self.mu_t(middle - offset) + self.mu_t(middle + offset))
            }
        }
    }

    /// The place with the optical thickness `tau` between it and `a`, where there is a formula.
    pub fn distance_at(&self, a: f64, tau: f64) -> Option<f64> {
        match self {
            Self::Formula(profile) => profile.distance_at(a, tau),
            Self::Grid { .. } => None,
        }
    }
}
