//! What a ray meets: where which volumes are present, and the surface at which it ends.
//!
//! Boundaries that only hold volumes, and surfaces that let this ray pass, are gone through here: an integrator sees a
//! stretch of volumes and then a surface, or nothing. Which volumes are present follows from the boundaries that were
//! crossed (see [`Boundaries`]); those that no shape bounds are present all the way.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::surface::{Boundaries, Presence};
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
    /// Where volumes are present, in the order of volumes.
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
        let surfaces = &scene.surfaces;
        let mut way = Way { spans: Vec::new(), hit: None, end, start: presence.clone(), crossed: Vec::new() };
        let mut rest = *ray;
        while !surfaces.is_empty() {
            let passed = (rest.origin - ray.origin).dot(ray.direction);
            let Some(mut hit) = surfaces.intersect(&rest, end - passed) else { break };
            hit.t += passed;
            if !passes(scene, &hit, random) {
                way.end = hit.t;
                way.hit = Some(hit);
                break;
            }
            rest.origin = hit.leave(ray.direction);
            way.crossed.push(hit);
        }
        way.find_spans(scene, ray.direction);
        way
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
        let mut presence = self.start.clone();
        let mut begins: Vec<Option<f64>> = (0..scene.volumes.len())
            .map(|volume| boundaries.is_present(volume, &presence).then_some(0.0))
            .collect();
        for hit in self.crossed.iter().filter(|_| !boundaries.is_empty()) {
            boundaries.cross(&mut presence, &scene.surfaces, hit, direction);
            for (volume, begin) in begins.iter_mut().enumerate() {
                match (*begin, boundaries.is_present(volume, &presence)) {
                    (Some(start), false) => {
                        self.spans.push(Span { volume, start, end: hit.t });
                        *begin = None;
                    }
                    (None, true) => *begin = Some(hit.t),
                    _ => {}
                }
            }
        }
        let open = begins.iter().enumerate().filter_map(|(volume, begin)| begin.map(|start| (volume, start)));
        self.spans.extend(open.map(|(volume, start)| Span { volume, start, end: self.end }));
    }
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
