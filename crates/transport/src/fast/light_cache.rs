//! What gets through the media to the lights, roughly: tables of the optical thickness from places amid the volumes to
//! each light that is a point or a direction.
//!
//! A table is a control variate of the transmittance T̂ of a shadow ray. With the table's T_c and a probability q that
//! is the smaller the surer T_c is,
//!
//!   T ≈ T_c + [u < q] (T̂ − T_c)/q
//!
//! has the mean of T̂ whatever the table holds (Owen 2013, "Monte Carlo theory, methods and examples", section 8.9), so most
//! shadow rays need not be traced at all. The table depends on the scene alone, so any
//! part of a render has the same one.

use glam::{DVec3, Vec3};
use tyndall_scene::{Density, Light, Ray, Scene, Volume};

use super::coarse::Lattice;
use super::volume::FastGrid;
use crate::way::is_plain;

/// Optical thickness of a surface. Not too much, as it is mixed with that of places beside it that light comes to.
const HIDDEN: f32 = 20.0;

/// Lights that get a table; others are traced as if there were none.
const GREATEST_LIGHTS: usize = 8;

/// Tables of the optical thickness to lights.
pub(crate) struct LightCache {
    lattice: Lattice,
    /// Mean optical thickness of rays that meet anything.
    thickness: f32,
    /// One table a light that has one.
    tables: Vec<Option<Vec<f32>>>,
}

/// Where a light is.
enum Toward {
    Direction(Vec3),
    Position(Vec3),
}

impl Toward {
    /// Direction and distance of the light from a place.
    fn seen_from(&self, from: Vec3) -> (Vec3, f32) {
        match self {
            Toward::Direction(direction) => (*direction, f32::INFINITY),
            Toward::Position(position) => ((*position - from).normalize_or_zero(), position.distance(from)),
        }
    }
}

impl LightCache {
    /// The tables of a scene, if any light of it can have one, its volumes are grids, no shape bounds them, and nothing passes
    /// through its surfaces.
    pub fn new(scene: &Scene, centre: DVec3) -> Option<LightCache> {
        let toward: Vec<Option<Toward>> = scene.lights.iter().map(|light| toward(light, centre)).collect();
        if !(1..=GREATEST_LIGHTS).contains(&toward.iter().flatten().count()) {
            return None;
        }
        if !is_plain(scene) {
            return None;
        }
        let grids: Option<Vec<(FastGrid<'_>, f32)>> =
            scene.volumes.iter().map(|volume| grid(volume, centre)).collect();
        let (grids, lattice) = (grids?, Lattice::new(scene, centre)?);
        let mu_t = lattice.table(|position| {
            lattice.mean_around(position, |position| {
                grids.iter().map(|(grid, mu_t)| mu_t * grid.nearest_or_nothing(position)).sum()
            })
        });
        let table = |toward: &Toward| {
            lattice.table(|from| match is_hidden(scene, centre, from, toward) {
                true => HIDDEN,
                false => optical_thickness(&lattice, &mu_t, from, toward),
            })
        };
        let tables = toward.iter().map(|toward| toward.as_ref().map(table)).collect();
        let thickness = lattice.mean_thickness(&mu_t);
        Some(LightCache { lattice, thickness, tables })
    }

    /// Numbers of the lights that have a table.
    #[inline]
    pub fn lights(&self) -> impl Iterator<Item = usize> {
        self.tables.iter().enumerate().filter(|(_, table)| table.is_some()).map(|(number, _)| number)
    }

    /// Mean optical thickness of rays that are parallel to an axis and meet anything.
    pub fn mean_thickness(&self) -> f32 {
        self.thickness
    }

    /// The transmittance to the light of this number from a place amid the volumes, relative to the scene's centre; none if
    /// the light has no table.
    #[inline(always)]
    pub fn transmittance(&self, light: usize, position: Vec3) -> Option<f32> {
        let table = self.tables[light].as_ref()?;
        Some(tyndall_lanes::exp(-self.lattice.lookup(table, position)))
    }
}

/// Whether a surface stands between a place and a light.
fn is_hidden(scene: &Scene, centre: DVec3, from: Vec3, toward: &Toward) -> bool {
    let (direction, distance) = toward.seen_from(from);
    let ray = Ray { origin: from.as_dvec3() + centre, direction: direction.as_dvec3() };
    direction != Vec3::ZERO && scene.surfaces.stand_in(&ray, f64::from(distance))
}

/// Optical thickness from a place to a light, by steps as long as places are apart.
fn optical_thickness(lattice: &Lattice, mu_t: &[f32], from: Vec3, toward: &Toward) -> f32 {
    let (direction, length) = toward.seen_from(from);
    let exit = ((lattice.min - from) / direction).max((lattice.max - from) / direction).min_element();
    let length = length.min(exit);
    if length <= 0.0 || !length.is_finite() {
        return 0.0;
    }
    let steps = (length * lattice.per_length).ceil().max(1.0);
    let step = length / steps;
    let place = |i: usize| from + direction * ((i as f32 + 0.5) * step);
    (0..steps as usize).map(|i| lattice.nearest(mu_t, place(i))).sum::<f32>() * step
}

/// Where a light is, if it is a point or a direction.
fn toward(light: &Light, centre: DVec3) -> Option<Toward> {
    match light {
        Light::Distant(light) => Some(Toward::Direction(light.toward().as_vec3())),
        Light::Sun(light) => Some(Toward::Direction(light.toward().as_vec3())),
        Light::Point(light) => Some(Toward::Position((light.position() - centre).as_vec3())),
        Light::Spot(light) => Some(Toward::Position((light.position() - centre).as_vec3())),
        _ => None,
    }
}

/// A volume's grid, if it is one, and its μt at density 1.
fn grid(volume: &Volume, centre: DVec3) -> Option<(FastGrid<'_>, f32)> {
    let Density::Grid(grid) = &volume.density else { return None };
    Some((FastGrid::new(grid, volume.world_to_local, centre), volume.medium.mu_t as f32))
}
