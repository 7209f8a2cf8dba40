//! The extinction along one stretch of a ray: all that a distance sampler or a transmittance estimator sees.
//!
//! μt(t) is the sum over the media that the ray crosses. It can be looked up at a place ([`AlongRay::mu_t`], counted);
//! it has bounds over pieces of the ray ([`AlongRay::pieces`]), from which null-collision methods take majorant,
//! minorant and control; and its integral τ and the inverse of that are known to rounding
//! ([`AlongRay::thickness`], [`AlongRay::distance_at`]), by formula or voxel by voxel; so is the mean of a function of the
//! collision distance ([`AlongRay::collision_mean`]), by quadrature.
//!
//! Media are cut where no light gets any farther in double precision (τ = 800), and thinning ones where what is left of
//! them is below 10⁻¹⁸; so every stretch is finite.

mod bounding;
mod collision_mean;
mod extinction;
mod merge;
mod profile;
mod tentative;
mod voxels;

use std::ops::ControlFlow;

use tyndall_lanes::Random;
use tyndall_scene::{Light, Ray, Scene, Volume};

use crate::way::{Span, Way};

pub use bounding::{Bounding, Control, Extent, Piece};
pub use profile::Profile;
pub(crate) use tentative::{further, tentative_collisions};

use bounding::Cell;
use extinction::Stretch;

/// How often an estimator has asked for the extinction at a place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Lookups(
    /// Their number so far.
    pub u64,
);

/// Where a point light is, seen from the ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightBeside {
    /// Parameter of the ray's point nearest the light.
    pub nearest: f64,
    /// Distance of the light from there.
    pub distance: f64,
}

impl LightBeside {
    /// The light at `position` beside `ray`, whose direction is of unit length.
    pub fn new(ray: &Ray, position: glam::DVec3) -> Self {
        let nearest = (position - ray.origin).dot(ray.direction);
        Self { nearest, distance: (position - ray.at(nearest)).length() }
    }
}

/// The extinction along a ray from [`start`](Self::start) to [`end`](Self::end).
#[derive(Debug, Clone)]
pub struct AlongRay<'a> {
    first: Stretch<'a>,
    others: Vec<Stretch<'a>>,
    bounding: Bounding,
    light: Option<LightBeside>,
}

impl<'a> AlongRay<'a> {
    /// What `ray`, of unit direction, meets of `volumes` before the distance `end`; `None` if it meets nothing.
    pub fn through(volumes: &'a [Volume], ray: &Ray, end: f64) -> Option<Self> {
        Self::through_spans(volumes, &Span::everywhere(volumes.len(), end), ray)
    }

    /// What `ray`, of unit direction, meets of the media of `scene` before the distance `end` and before the first surface
    /// that stops it; `None` if it meets nothing. A surface that lets a part of the light pass is drawn once, always alike.
    pub fn through_scene(scene: &'a Scene, ray: &Ray, end: f64) -> Option<Self> {
        if scene.surfaces.is_empty() {
            return Self::through(&scene.volumes, ray, end);
        }
        let presence = scene.boundaries.presence_at(ray.origin, &scene.surfaces);
        let way = Way::trace(scene, ray, end, &presence, &mut Random::new(0, 0, 0));
        Self::through_spans(&scene.volumes, &way.spans, ray)
    }

    /// What `ray` meets of the volumes where they are present.
    pub(crate) fn through_spans(volumes: &'a [Volume], spans: &[Span], ray: &Ray) -> Option<Self> {
        let mut stretches = spans.iter().filter_map(|span| {
            let stretch = Stretch::through(&volumes[span.volume], ray, (span.start, span.end));
            stretch.map(|stretch| stretch.of(span.volume))
        });
        let first = stretches.next()?;
        Some(Self { first, others: stretches.collect(), bounding: Bounding::default(), light: None })
    }

    /// What `ray` meets of one volume between the two distances of `range`.
    pub(crate) fn through_one(volume: &'a Volume, ray: &Ray, range: (f64, f64)) -> Option<Self> {
        Some(Self::of(Stretch::through(volume, ray, range)?))
    }

    /// A formula for the extinction from 0 to `length`, with bounds over `pieces` equal parts; for experiments.
    pub fn with_profile(profile: Profile, length: f64, pieces: u32) -> AlongRay<'static> {
        AlongRay::of(Stretch::with_profile(profile, (0.0, length), pieces))
    }

    fn of(first: Stretch<'a>) -> Self {
        Self { first, others: Vec::new(), bounding: Bounding::default(), light: None }
    }

    /// The same with other majorants, minorants and controls.
    #[must_use]
    pub fn with_bounding(self, bounding: Bounding) -> Self {
        Self { bounding, ..self }
    }

    /// The same with a point light, for equiangular sampling.
    #[must_use]
    pub fn with_light(self, light: LightBeside) -> Self {
        Self { light: Some(light), ..self }
    }

    /// The same with the first of the scene's point lights, unless the ray all but meets it.
    #[must_use]
    pub fn with_point_light_of(self, scene: &Scene, ray: &Ray) -> Self {
        let position = scene.lights.iter().find_map(|light| match light {
            Light::Point(point) => Some(point.position()),
            _ => None,
        });
        match position.map(|position| LightBeside::new(ray, position)) {
            Some(light) if light.distance > 1e-6 * (self.end() - self.start()) => self.with_light(light),
            _ => self,
        }
    }

    /// How the bounds are made.
    pub fn bounding(&self) -> Bounding {
        self.bounding
    }

    /// The point light, if one was given.
    pub fn light(&self) -> Option<LightBeside> {
        self.light
    }

    /// Distance at which the first medium begins.
    pub fn start(&self) -> f64 {
        self.stretches().fold(f64::INFINITY, |least, stretch| least.min(stretch.start))
    }

    /// Distance at which the last medium ends.
    pub fn end(&self) -> f64 {
        self.stretches().fold(f64::NEG_INFINITY, |greatest, stretch| greatest.max(stretch.end))
    }

    fn stretches(&self) -> impl Iterator<Item = &Stretch<'a>> {
        std::iter::once(&self.first).chain(&self.others)
    }

    /// Extinction coefficient at the distance `t`, between start and end, 1/length; one lookup.
    pub fn mu_t(&self, t: f64, lookups: &mut Lookups) -> f64 {
        lookups.0 += 1;
        if self.others.is_empty() {
            return self.first.extinction.mu_t(t);
        }
        self.stretches().filter(|stretch| stretch.covers(t)).map(|stretch| stretch.extinction.mu_t(t)).sum()
    }

    /// Which of the volumes a collision at `t` is with: each has its share of the extinction there; `u` is uniform in
    /// [0, 1).
    pub fn volume_at(&self, t: f64, u: f64) -> usize {
        if self.others.is_empty() {
            return self.first.source;
        }
        let mut rest = u * self.mu_t(t, &mut Lookups::default());
        let mut last = self.first.source;
        for stretch in self.stretches().filter(|stretch| stretch.covers(t)) {
            let mu_t = stretch.extinction.mu_t(t);
            if mu_t > 0.0 {
                last = stretch.source;
            }
            rest -= mu_t;
            if rest < 0.0 {
                break;
            }
        }
        last
    }

    /// Visits the pieces of the ray with their bounds, in order; what lies between them is empty.
    pub fn pieces<B>(&self, mut visit: impl FnMut(&Piece) -> ControlFlow<B>) -> ControlFlow<B> {
        match self.bounding.extent {
            Extent::Cells => self.cells(|cell| visit(&self.bounding.piece(cell))),
            Extent::WholeRay => {
                let cell = self.bounds();
                visit(&self.bounding.piece(cell))
            }
        }
    }

    /// Bounds over the whole ray.
    fn bounds(&self) -> Cell {
        let (start, end) = (self.start(), self.end());
        let (mut min, mut max, mut reached, mut gaps) = (f64::INFINITY, 0.0_f64, start, false);
        let _ = self.cells(|cell| {
            gaps |= cell.start > reached;
            (min, max, reached) = (min.min(cell.min), max.max(cell.max), cell.end);
            ControlFlow::<()>::Continue(())
        });
        gaps |= reached < end;
        Cell { start, end, min: if gaps { 0.0 } else { min }, max }
    }

    /// The same before the bounds are scaled or joined.
    fn cells<B>(&self, mut visit: impl FnMut(Cell) -> ControlFlow<B>) -> ControlFlow<B> {
        if self.others.is_empty() {
            return self.first.cells(visit);
        }
        merge::cells(self.stretches()).into_iter().try_for_each(&mut visit)
    }

    /// Whether the optical thickness is known by formula, or voxel by constant voxel.
    pub fn has_closed_form(&self) -> bool {
        self.stretches().all(|stretch| stretch.extinction.has_closed_form())
    }

    /// ∫ of the pieces' majorants over the ray.
    pub fn majorant_thickness(&self) -> f64 {
        let mut thickness = 0.0;
        let _ = self.pieces(|piece| {
            thickness += piece.majorant * (piece.end - piece.start);
            ControlFlow::<()>::Continue(())
        });
        thickness
    }

    /// Optical thickness τ from the start to the distance `to`, exact to rounding. Formulas cost no lookups; a voxel
    /// costs two if its values are interpolated and one if they are not.
    pub fn thickness(&self, to: f64, lookups: &mut Lookups) -> f64 {
        let mut tau = 0.0;
        let _ = self.smooth_intervals(|a, b| {
            if a >= to {
                return ControlFlow::Break(());
            }
            tau += self.smooth_thickness(a, b.min(to), lookups);
            ControlFlow::Continue(())
        });
        tau
    }

    /// The distance at which the optical thickness from the start is `tau`, if it gets so far; lookups as for
    /// [`thickness`](Self::thickness).
    pub fn distance_at(&self, tau: f64, lookups: &mut Lookups) -> Option<f64> {
        let mut rest = tau;
        let found = self.smooth_intervals(|a, b| {
            let inside = self.smooth_thickness(a, b, lookups);
            if rest >= inside {
                rest -= inside;
                return ControlFlow::Continue(());
            }
            ControlFlow::Break(self.invert((a, b), rest, inside, lookups))
        });
        found.break_value()
    }

    /// The intervals within which the integral of μt is known, in order; what lies between them is empty.
    fn smooth_intervals<B>(&self, mut visit: impl FnMut(f64, f64) -> ControlFlow<B>) -> ControlFlow<B> {
        if self.others.is_empty() {
            return self.first.smooth_intervals(visit);
        }
        merge::smooth_intervals(self.stretches()).windows(2).try_for_each(|pair| visit(pair[0], pair[1]))
    }

    fn smooth_thickness(&self, a: f64, b: f64, lookups: &mut Lookups) -> f64 {
        let middle = 0.5 * (a + b);
        let covering = self.stretches().filter(|stretch| stretch.covers(middle));
        covering.map(|stretch| stretch.extinction.smooth_thickness(a, b, lookups)).sum()
    }

    /// The place in a smooth interval with the optical thickness `tau` before it, of `whole` in all: by formula, or by
    /// Newton's method within a bracket.
    fn invert(&self, (a, b): (f64, f64), tau: f64, whole: f64, lookups: &mut Lookups) -> f64 {
        if self.others.is_empty()
            && let Some(t) = self.first.extinction.distance_at(a, tau)
        {
            return t.min(b);
        }
        let (mut low, mut high) = (a, b);
        let mut t = a + (b - a) * (tau / whole);
        for _ in 0..100 {
            let excess = self.smooth_thickness(a, t, lookups) - tau;
            if excess > 0.0 {
                high = t
            } else {
                low = t
            }
            let step = excess / self.mu_t(t, lookups);
            if step.abs() <= 1e-14 * b.abs() || high - low <= 1e-14 * b.abs() {
                break;
            }
            let newton = t - step;
            t = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        t
    }
}
