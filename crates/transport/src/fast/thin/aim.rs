//! Directions from surfaces towards the medium: half of the paths that go on from a surface aim at a ball around most of it,
//! since beside it there may be nothing, and the balance heuristic's mixture p = (p_f + p_ball)/2 joins them with those
//! that the surface draws.

use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use tyndall_lanes::Random;

use super::super::coarse::Lattice;

/// Radius of the ball, in root mean squares of the distance from its centre.
const RADII: f64 = 1.5;

/// A ball around most of something.
pub(super) struct Ball {
    centre: DVec3,
    radius: f64,
}

impl Ball {
    /// That of a table, relative to the scene's centre; `None` if it is empty.
    pub fn new(lattice: &Lattice, table: &[f32]) -> Option<Ball> {
        let (mut sum, mut first, mut second) = (0.0, DVec3::ZERO, 0.0);
        for (number, &value) in table.iter().enumerate() {
            let (place, value) = (lattice.within_place(number, [0.5; 3]).as_dvec3(), f64::from(value));
            sum += value;
            first += place * value;
            second += place.length_squared() * value;
        }
        let centre = first / sum;
        let radius = RADII * (second / sum - centre.length_squared()).max(0.0).sqrt();
        (radius > 0.0 && radius.is_finite()).then_some(Ball { centre, radius })
    }

    /// The ball as it is seen from a place relative to the scene's centre; `None` from inside.
    #[inline(always)]
    pub fn seen_from(&self, from: Vec3) -> Option<Cone> {
        let offset = self.centre - from.as_dvec3();
        let distance_squared = offset.length_squared();
        let sine_squared = self.radius * self.radius / distance_squared;
        (sine_squared < 1.0).then(|| Cone {
            axis: offset / distance_squared.sqrt(),
            // 1 − cos θ without loss of digits.
            height: sine_squared / (1.0 + (1.0 - sine_squared).sqrt()),
        })
    }
}

/// Directions around an axis.
#[derive(Clone, Copy)]
pub(super) struct Cone {
    axis: DVec3,
    /// 1 less the cosine of the half angle.
    height: f64,
}

impl Cone {
    /// A direction, uniform over the solid angle.
    #[inline(always)]
    pub fn draw(&self, random: &mut Random) -> DVec3 {
        let drop = self.height * random.f64();
        let sine = (drop * (2.0 - drop)).sqrt();
        let (sin, cos) = (TAU * random.f64()).sin_cos();
        let (x, y) = self.axis.any_orthonormal_pair();
        (x * (sine * cos) + y * (sine * sin) + self.axis * (1.0 - drop)).normalize()
    }

    /// Density of a unit vector, 1/sr.
    #[inline(always)]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        if direction.dot(self.axis) >= 1.0 - self.height { 1.0 / (TAU * self.height) } else { 0.0 }
    }
}
