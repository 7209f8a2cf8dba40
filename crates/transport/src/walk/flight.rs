//! Straight flights within a horizontal layer, which may repeat itself periodically in x and z.
//!
//! A periodic layer is one tile. A flight that comes to a side of the tile goes on at the opposite side; since
//! flights have no memory, distances and transmittances are drawn anew for every tile.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Ray, Volume};

use super::photon::first_collision;
use crate::transmittance::estimate_transmittance;

/// The tile that a layer repeats: x from `min[0]` to `max[0]`, z from `min[1]` to `max[1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    /// Least x and z.
    pub min: [f64; 2],
    /// Greatest x and z.
    pub max: [f64; 2],
}

/// The space in which flights are followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Space<'a> {
    pub volumes: &'a [Volume],
    /// y of the lower and of the upper face.
    pub faces: [f64; 2],
    pub tile: Option<Tile>,
}

/// How a flight ended.
pub(super) enum Flight<'a> {
    /// In a volume.
    Collision(&'a Volume),
    /// At the face towards which it went.
    Face,
}

/// Least slope of a flight. Flatter ones would pass so many tiles; one scattering in 10⁹ has such a direction and is
/// tilted by less than 10⁻⁹.
const LEAST_SLOPE: f64 = 1e-9;

impl<'a> Space<'a> {
    /// Moves the ray's origin to where its flight ends.
    pub fn fly(&self, ray: &mut Ray, random: &mut Random) -> Flight<'a> {
        if self.tile.is_some() && ray.direction.y.abs() < LEAST_SLOPE {
            ray.direction.y = LEAST_SLOPE.copysign(ray.direction.y);
        }
        loop {
            let (end, side) = self.next_border(ray);
            if let Some((distance, volume)) = first_collision(self.volumes, ray, end, random) {
                ray.origin = ray.at(distance);
                return Flight::Collision(volume);
            }
            if !self.cross(ray, end, side) {
                return Flight::Face;
            }
        }
    }

    /// An unbiased estimate of the transmittance from the ray's origin to the face towards which it goes, and the point
    /// there.
    pub fn transmittance_to_face(&self, mut ray: Ray, random: &mut Random) -> (f64, DVec3) {
        let mut transmittance = 1.0;
        loop {
            let (end, side) = self.next_border(&ray);
            for volume in self.volumes {
                transmittance *= estimate_transmittance(volume, &ray, (0.0, end), random);
                if transmittance == 0.0 {
                    return (0.0, ray.origin);
                }
            }
            if !self.cross(&mut ray, end, side) {
                return (transmittance, ray.origin);
            }
        }
    }

    /// Distance to the face or side of the tile that comes next, and the axis (0 is x, 1 is z) if it is a side.
    fn next_border(&self, ray: &Ray) -> (f64, Option<usize>) {
        let face = self.faces[usize::from(ray.direction.y > 0.0)];
        let mut end = if ray.direction.y == 0.0 {
            f64::INFINITY
        } else {
            ((face - ray.origin.y) / ray.direction.y).max(0.0)
        };
        let mut side = None;
        let Some(tile) = &self.tile else { return (end, None) };
        let (origin, direction) = ([ray.origin.x, ray.origin.z], [ray.direction.x, ray.direction.z]);
        for axis in 0..2 {
            if direction[axis] == 0.0 {
                continue;
            }
            let far = if direction[axis] > 0.0 { tile.max[axis] } else { tile.min[axis] };
            let distance = ((far - origin[axis]) / direction[axis]).max(0.0);
            if distance < end {
                end = distance;
                side = Some(axis);
            }
        }
        (end, side)
    }

    /// Moves the ray's origin over the distance `end` and, at a side of the tile, to the opposite one; `false` at a face.
    fn cross(&self, ray: &mut Ray, end: f64, side: Option<usize>) -> bool {
        ray.origin = ray.at(end);
        let (Some(axis), Some(tile)) = (side, &self.tile) else {
            // Exactly, whatever the product has rounded to.
            ray.origin.y = self.faces[usize::from(ray.direction.y > 0.0)];
            return false;
        };
        let [coordinate, along] = if axis == 0 {
            [&mut ray.origin.x, &mut ray.direction.x]
        } else {
            [&mut ray.origin.z, &mut ray.direction.z]
        };
        *coordinate = if *along > 0.0 { tile.min[axis] } else { tile.max[axis] };
        true
    }
}
