//! What a ray meets: where which volumes are present, and the surface at which it ends.
//!
//! Boundaries that only hold volumes, and surfaces that let this ray pass, are gone through here: an integrator sees a
//! stretch of volumes and then a surface, or nothing. Which volumes are present follows from the boundaries that were
//! crossed (see [`Boundaries`]); those that no shape bounds are present all the way.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::surface::{Boundaries, Material, Presence};
use tyndall_scene::{Hit, Ray, Scene};

/// A volume present between two distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Number of the volume.
    pub volume: usize,
    /// Where it begins.
    pub start: f64,
    /// Where it ends; may be infinite.
    pub end: f64,
}

impl Span {
    /// As many volumes, all of them present up to the distance `end`.
    pub(crate) fn everywhere(volumes: usize, end: f64) -> Vec<Span> {
        (0..volumes).map(|volume| Span { volume, start: 0.0, end }).collect()
    }
}

/// What a ray meets.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    /// Where volumes are present.
    pub spans: Vec<Span>,
    /// The surface at which the way ends, with its distance along the whole ray.
    pub hit: Option<Hit>,
    /// Where it ends; infinite if there is no surface and the ray was to go on for ever.
    pub end: f64,
    /// What is present at its beginning.
    start: Presence,
    /// The boundaries that were crossed, in order.
    crossed: Vec<Hit>,
}

impl Way {
    /// The way of `ray`, of unit direction, from a place where `presence` is present, up to the distance `end`.
    pub fn trace(scene: &Scene, ray: &Ray, end: f64, presence: &Presence, random: &mut Random) -> Self {
        let mut way = Self::nothing();
        way.follow(scene, ray, end, presence, random);
        way
    }

    /// Becomes that way; takes no memory that it has not got already.
    pub fn follow(&mut self, scene: &Scene, ray: &Ray, end: f64, presence: &Presence, random: &mut Random) {
        self.spans.clear();
        self.crossed.clear();
        self.start.clone_from(presence);
        (self.hit, self.end) = (None, end);
        let mut rest = *ray;
        while !scene.surfaces.is_empty() {
            let passed = (rest.origin - ray.origin).dot(ray.direction);
            let Some(mut hit) = scene.surfaces.intersect(&rest, end - passed) else { break };
            hit.t += passed;
            if !passes(scene, &hit, random) {
                (self.hit, self.end) = (Some(hit), hit.t);
                break;
            }
            rest.origin = hit.leave(ray.direction);
            self.crossed.push(hit);
        }
        self.find_spans(scene, ray.direction);
    }

    /// Becomes the way of `ray` among [plain](is_plain) surfaces, up to the first of them; spans are left out, as every
    /// volume is present all the way.
    #[inline(always)]
    pub fn follow_plainly(&mut self, scene: &Scene, ray: &Ray) {
        self.hit = scene.surfaces.intersect(ray, f64::INFINITY);
        self.end = self.hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
    }

    /// A way through nothing.
    pub fn nothing() -> Self {
        Way {
            spans: Vec::new(),
            hit: None,
            end: f64::INFINITY,
            start: Presence::default(),
            crossed: Vec::new(),
        }
    }

    /// The way from one place to another that sees it; `None` if a surface stands between.
    pub fn connect(
        scene: &Scene,
        ray: &Ray,
        end: f64,
        presence: &Presence,
        random: &mut Random,
    ) -> Option<Self> {
        let way = Self::trace(scene, ray, end, presence, random);
        way.hit.is_none().then_some(way)
    }

    /// What is present at the distance `t`, in the `direction` of the ray.
    pub fn presence_at(&self, scene: &Scene, direction: DVec3, t: f64) -> Presence {
        let mut presence = self.start.clone();
        for hit in self.crossed.iter().take_while(|hit| hit.t <= t) {
            scene.boundaries.cross(&mut presence, &scene.surfaces, hit, direction);
        }
        presence
    }

    fn find_spans(&mut self, scene: &Scene, direction: DVec3) {
        let boundaries: &Boundaries = &scene.boundaries;
        let volumes = 0..scene.volumes.len();
        let present = volumes.clone().filter(|&volume| boundaries.is_present(volume, &self.start));
        self.spans.extend(present.map(|volume| Span { volume, start: 0.0, end: self.end }));
        if boundaries.is_empty() || self.crossed.is_empty() {
            return;
        }
        let mut presence = self.start.clone();
        // Of the spans of a volume only the last may go on.
        let mut open: Vec<Option<usize>> = vec![None; volumes.len()];
        for (place, span) in self.spans.iter().enumerate() {
            open[span.volume] = Some(place);
        }
        for hit in &self.crossed {
            boundaries.cross(&mut presence, &scene.surfaces, hit, direction);
            for (volume, open) in open.iter_mut().enumerate() {
                match (*open, boundaries.is_present(volume, &presence)) {
                    (Some(place), false) => {
                        self.spans[place].end = hit.t;
                        *open = None;
                    }
                    (None, true) => {
                        *open = Some(self.spans.len());
                        self.spans.push(Span { volume, start: hit.t, end: self.end });
                    }
                    _ => {}
                }
            }
        }
    }
}

/// Whether the scene's surfaces stop every ray and bound no volume.
pub(crate) fn is_plain(scene: &Scene) -> bool {
    let pass = scene.surfaces.materials.iter().any(Material::may_pass);
    scene.boundaries.is_empty() && !pass
}

/// Whether the ray goes through the surface as if it were not there.
fn passes(scene: &Scene, hit: &Hit, random: &mut Random) -> bool {
    let material = scene.surfaces.material(hit);
    if !material.may_pass() {
        return false;
    }
    let probability = material.pass_probability(hit);
    probability >= 1.0 || random.f64() < probability
}
