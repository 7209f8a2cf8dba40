//! A horizontal layer under light from above: what it reflects, transmits and absorbs, and its radiance in given
//! directions.
//!
//! Photon packets enter through the upper face and are followed until they leave or are absorbed:
//!
//!   R = E[w at the upper face],   T = E[w at the lower face, each time it is crossed downwards],   A = E[w absorbed]
//!
//! where the weight w is a fraction of the incident light. Radiance in a direction ω that leaves by a face is found by
//! a local estimate at every scattering,
//!
//!   L(ω) = μ₀/|μ| · E[ Σ w f_p(ω′,ω) T(to the face) ]      μ, μ₀: cosines of ω and of the beam with the vertical
//!
//! per irradiance on a surface that faces the beam, without the unscattered light. Source: Marchuk, Mikhailov,
//! Nazaraliev et al. 1980, "The Monte Carlo methods in atmospheric optics", chapter 3. Unbiased, but with steep phase
//! functions the local estimate has rare large contributions.
//!
//! The faces may be smooth boundaries to air; below the layer there may be a ground that reflects as Lambert's law says.

use std::f64::consts::PI;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::Volume;

use super::flight::{Flight, Space, Tile};
use super::fresnel::{reflectance, refracted};
use super::half_space::DepthLimit;
use super::photon::{Photon, diffuse_direction};
use super::run::{Walk, fraction_error};
use super::tally::{Estimate, Scores, Tallies};

/// Light that falls on a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Incidence {
    /// Parallel light that travels along this unit vector, downwards.
    Beam(DVec3),
    /// The same radiance from the whole upper hemisphere.
    Diffuse,
}

/// A layer and how it is lit and looked at.
#[derive(Debug, Clone)]
pub struct Layer<'a> {
    /// The media, which are grey, and of which only what is between the faces counts.
    pub volumes: &'a [Volume],
    /// y of the lower face, which may be −∞, and of the upper one.
    pub faces: [f64; 2],
    /// The tile that repeats; without, the media must be the same everywhere in x and z.
    pub tile: Option<Tile>,
    /// The light.
    pub incidence: Incidence,
    /// Refractive index between the faces; 1 if nothing is reflected there.
    pub refractive_index: f64,
    /// Fraction of the light that the ground below the layer reflects.
    pub ground_albedo: f64,
    /// Columns of the tile along x and z for which results are given as well.
    pub columns: Option<[usize; 2]>,
    /// Unit vectors along which radiance is asked for, as the light travels; not horizontal. Only for a layer of
    /// refractive index 1.
    pub views: Vec<DVec3>,
    /// For half-spaces that absorb next to nothing.
    pub depth_limit: Option<DepthLimit>,
}

/// What a layer does, as fractions of the incident light; with columns, those of the columns' shares follow.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerFluxes {
    /// What leaves by the upper face, with what is reflected there on the way in.
    pub reflectance: Estimate,
    /// What arrives below the lower face, the unscattered light included; reflected by the ground, it may count again.
    pub transmittance: Estimate,
    /// What arrives below the lower face unscattered.
    pub unscattered: Estimate,
    /// What the media absorb.
    pub absorptance: Estimate,
    /// Radiance in each of the views, in 1/sr, per irradiance on a surface that faces the beam (diffuse light: per
    /// irradiance on the layer).
    pub radiance: Vec<Estimate>,
    /// The same for each column, if they were asked for.
    pub columns: Option<ColumnFluxes>,
    /// Number of photons.
    pub samples: u64,
}

/// Results by column, x changing fastest: fractions of the light that falls on one column.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnFluxes {
    /// Columns along x and z.
    pub shape: [usize; 2],
    /// What leaves by the column's upper end.
    pub reflectance: Vec<Estimate>,
    /// What arrives at its lower end.
    pub transmittance: Vec<Estimate>,
    /// What the media in it absorb.
    pub absorptance: Vec<Estimate>,
    /// Radiance out of it, for each view.
    pub radiance: Vec<Vec<Estimate>>,
}

// Numbers of the tallies; by column they come in the same order after those of the whole layer.
const REFLECTED: usize = 0;
const TRANSMITTED: usize = 1;
const ABSORBED: usize = 2;
const FIRST_VIEW: usize = 3;

impl Walk for Layer<'_> {
    fn tallies(&self) -> usize {
        // The unscattered light has no columns: it comes last.
        self.kinds() * (1 + self.column_count()) + 1
    }

    fn walk(&self, random: &mut Random, scores: &mut Scores) {
        let mut photon = self.enter(random, scores);
        loop {
            match self.space().fly(&mut photon.ray, random) {
                Flight::Collision(volume) => {
                    let mut absorbed = 0.0;
                    if let Some(limit) = &self.depth_limit {
                        let left = limit.lift(&mut photon.ray.origin, self.faces[1]);
                        absorbed += photon.absorb(left);
                    }
                    absorbed += photon.absorb(volume.albedo_at(photon.ray.origin).x);
                    self.score(ABSORBED, photon.ray.origin, absorbed, scores);
                    if !photon.survives_roulette(random) {
                        return;
                    }
                    let before = photon.ray.direction;
                    let phase = &volume.medium.phase_function;
                    self.look(&photon, |view| phase.value(before, view), random, scores);
                    photon.scatter(volume, random);
                }
                Flight::Face => {
                    if self.is_reflected_inside(&mut photon, random) {
                        continue;
                    }
                    if photon.ray.direction.y > 0.0 {
                        return self.score(REFLECTED, photon.ray.origin, photon.weight, scores);
                    }
                    if !self.returns_from_below(&mut photon, random, scores) {
                        return;
                    }
                }
            }
        }
    }

    fn relative_error(&self, tallies: &Tallies) -> f64 {
        let reflectance = fraction_error(tallies.fraction(REFLECTED), tallies);
        let transmittance =
            if self.is_bounded() { fraction_error(tallies.fraction(TRANSMITTED), tallies) } else { 0.0 };
        reflectance.max(transmittance)
    }
}

impl Layer<'_> {
    /// The results that tallies of this layer hold.
    pub fn fluxes(&self, tallies: &Tallies) -> LayerFluxes {
        let is_conservative = self.volumes.iter().all(|v| v.medium.albedo.x == 1.0 && v.fields.is_none());
        let possible = |is_possible: bool, tally: usize| {
            if is_possible { tallies.fraction(tally) } else { Estimate::exact(0.0) }
        };
        let is_bounded = self.is_bounded();
        LayerFluxes {
            reflectance: tallies.fraction(REFLECTED),
            transmittance: possible(is_bounded, TRANSMITTED),
            unscattered: possible(is_bounded, self.unscattered()),
            absorptance: possible(!is_conservative, ABSORBED),
            radiance: (FIRST_VIEW..self.kinds()).map(|kind| tallies.estimate(kind)).collect(),
            columns: self.columns.map(|shape| self.column_fluxes(shape, tallies)),
            samples: tallies.photons(),
        }
    }

    fn column_fluxes(&self, shape: [usize; 2], tallies: &Tallies) -> ColumnFluxes {
        let count = self.column_count();
        let share = |kind: usize| -> Vec<Estimate> {
            let first = self.kinds() + kind * count;
            // Each column receives 1/count of the light.
            (first..first + count).map(|tally| tallies.estimate(tally) * count as f64).collect()
        };
        ColumnFluxes {
            shape,
            reflectance: share(REFLECTED),
            transmittance: share(TRANSMITTED),
            absorptance: share(ABSORBED),
            radiance: (FIRST_VIEW..self.kinds()).map(share).collect(),
        }
    }

    /// The tallies of the radiances, which, unlike fractions of the light, single photons can make much of.
    pub fn radiance_tallies(&self) -> impl Iterator<Item = (usize, &'static str)> {
        (FIRST_VIEW..self.kinds()).map(|kind| (kind, "radiance"))
    }

    fn is_bounded(&self) -> bool {
        self.faces[0].is_finite()
    }

    fn kinds(&self) -> usize {
        FIRST_VIEW + self.views.len()
    }

    fn column_count(&self) -> usize {
        self.columns.map_or(0, |[x, z]| x * z)
    }

    fn unscattered(&self) -> usize {
        self.tallies() - 1
    }

    fn space(&self) -> Space<'_> {
        Space { volumes: self.volumes, faces: self.faces, tile: self.tile }
    }

    /// A packet just below the upper face; what the face reflects is scored.
    fn enter(&self, random: &mut Random, scores: &mut Scores) -> Photon {
        let direction = match self.incidence {
            Incidence::Beam(direction) => direction,
            Incidence::Diffuse => diffuse_direction(random),
        };
        let [x, z] = match &self.tile {
            Some(tile) => [0, 1].map(|i| tile.min[i] + (tile.max[i] - tile.min[i]) * random.f64()),
            None => [0.0, 0.0],
        };
        let mut photon = Photon::new(DVec3::new(x, self.faces[1], z), direction);
        if self.refractive_index != 1.0 {
            let (reflected, beyond) = reflectance(-direction.y, 1.0, self.refractive_index);
            self.score(REFLECTED, photon.ray.origin, reflected, scores);
            photon.weight -= reflected;
            photon.ray.direction = refracted(direction, 1.0 / self.refractive_index, beyond);
        }
        photon
    }

    /// Whether a face throws a packet that comes to it from inside back.
    fn is_reflected_inside(&self, photon: &mut Photon, random: &mut Random) -> bool {
        let direction = &mut photon.ray.direction;
        let is_reflected = self.refractive_index != 1.0
            && random.f64() < reflectance(direction.y.abs(), self.refractive_index, 1.0).0;
        if is_reflected {
            direction.y = -direction.y;
        }
        is_reflected
    }

    /// Scores a packet that has left downwards; whether the ground sends it back into the layer.
    fn returns_from_below(&self, photon: &mut Photon, random: &mut Random, scores: &mut Scores) -> bool {
        loop {
            self.score(TRANSMITTED, photon.ray.origin, photon.weight, scores);
            if photon.is_unscattered {
                scores.add(self.unscattered(), photon.weight);
            }
            photon.weight *= self.ground_albedo;
            if !photon.survives_roulette(random) {
                return false;
            }
            photon.is_unscattered = false;
            self.look(photon, |view| view.y.max(0.0) / PI, random, scores);
            let direction = -diffuse_direction(random);
            let (reflected, beyond) = match self.refractive_index {
                1.0 => (0.0, direction.y),
                index => reflectance(direction.y, 1.0, index),
            };
            if random.f64() >= reflected {
                photon.ray.direction = refracted(direction, 1.0 / self.refractive_index, beyond);
                return true;
            }
        }
    }

    /// Scores what the packet, where it is, sends into the views without further collision; `phase` is the density of
    /// the directions it takes.
    fn look(&self, photon: &Photon, phase: impl Fn(DVec3) -> f64, random: &mut Random, scores: &mut Scores) {
        let incident = match self.incidence {
            Incidence::Beam(direction) => -direction.y,
            Incidence::Diffuse => 1.0,
        };
        for (number, &view) in self.views.iter().enumerate() {
            let sent = photon.weight * phase(view) * incident / view.y.abs();
            if sent > 0.0 {
                let mut toward = photon.ray;
                toward.direction = view;
                let (transmittance, exit) = self.space().transmittance_to_face(toward, random);
                self.score(FIRST_VIEW + number, exit, sent * transmittance, scores);
            }
        }
    }

    /// Scores for the whole layer, and for the column of `place`.
    fn score(&self, kind: usize, place: DVec3, x: f64, scores: &mut Scores) {
        scores.add(kind, x);
        let (Some([columns_x, columns_z]), Some(tile)) = (self.columns, &self.tile) else { return };
        let along = |i: usize, at: f64, columns: usize| {
            let share = (at - tile.min[i]) / (tile.max[i] - tile.min[i]);
            ((share * columns as f64) as usize).min(columns - 1)
        };
        let column = along(1, place.z, columns_z) * columns_x + along(0, place.x, columns_x);
        scores.add(self.kinds() + kind * self.column_count() + column, x);
    }
}
