//! What gets through the media to the lights, roughly: tables of the optical thickness from places amid the volumes to
//! each light that is a point or a direction.
//!
//! A table is a control variate of the transmittance T̂ of a shadow ray. With the table's T_c and a probability q that
//! is the smaller the surer T_c is,
//!
//!   T ≈ T_c + [u < q] (T̂ − T_c)/q
//!
//! has the mean of T̂ whatever the table holds (Fong et al. 2017 call it a control variate, Szirmay-Kalos et al. 2017
//! apply it to free paths), so most shadow rays need not be traced at all. The table depends on the scene alone, so any
//! part of a render has the same one.

use glam::{DVec3, Vec3};
use tyndall_scene::{Light, Scene};

use super::coarse::{Lattice, Rough};

/// Lights that get a table; others are traced as if there were none.
const GREATEST_LIGHTS: usize = 8;

/// Tables of the optical thickness to lights.
pub(crate) struct LightCache {
    lattice: Lattice,
    /// One table a light that has one.
    tables: Vec<Option<Vec<f32>>>,
}

/// Where a light is.
enum Toward {
    Direction(Vec3),
    Position(Vec3),
}

impl LightCache {
    /// The tables of a scene, if any light of it can have one.
    pub fn new(scene: &Scene, centre: DVec3) -> Option<LightCache> {
        let toward: Vec<Option<Toward>> = scene.lights.iter().map(|light| toward(light, centre)).collect();
        if !(1..=GREATEST_LIGHTS).contains(&toward.iter().flatten().count()) {
            return None;
        }
        let Rough { lattice, mu_t } = Rough::new(scene, centre)?;
        let table = |toward: &Toward| lattice.table(|from| optical_thickness(&lattice, &mu_t, from, toward));
        let tables = toward.iter().map(|toward| toward.as_ref().map(table)).collect();
        Some(LightCache { lattice, tables })
    }

    /// The transmittance to the light of this number from a place relative to the scene's centre, towards `toward`;
    /// none if the light has no table.
    #[inline]
    pub fn transmittance(&self, light: usize, position: Vec3, toward: Vec3) -> Option<f32> {
        let table = self.tables[light].as_ref()?;
        let Some(position) = self.enter(position, toward) else { return Some(1.0) };
        Some(tyndall_lanes::exp(-self.lattice.lookup(table, position)))
    }

    /// The place, or where the ray from it enters the tables' box.
    #[inline]
    fn enter(&self, position: Vec3, toward: Vec3) -> Option<Vec3> {
        let Lattice { min, max, .. } = self.lattice;
        if position.cmpge(min).all() && position.cmple(max).all() {
            return Some(position);
        }
        let (a, b) = ((min - position) / toward, (max - position) / toward);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        (enter < leave && leave > 0.0).then(|| position + toward * enter.max(0.0))
    }
}

/// Optical thickness from a place to a light, by steps as long as places are apart.
fn optical_thickness(lattice: &Lattice, mu_t: &[f32], from: Vec3, toward: &Toward) -> f32 {
    let (direction, length) = match toward {
        Toward::Direction(direction) => (*direction, f32::INFINITY),
        Toward::Position(position) => ((*position - from).normalize_or_zero(), position.distance(from)),
    };
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
