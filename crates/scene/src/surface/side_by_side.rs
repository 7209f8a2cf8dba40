//! Rays side by side, so that the arithmetic of one is that of many and becomes vector code.

use glam::DVec3;

use crate::Ray;

/// Rays in a group. Loops over less than two AVX-512 registers of doubles the compiler unrolls, and makes bad vector code of them.
pub const LANES: usize = 16;

/// Some rays, each up to a distance. Those that are not set end where they begin, and meet nothing.
#[derive(Debug, Clone, Copy)]
pub struct RayGroup {
    /// By component, then by ray.
    pub(super) origin: [[f64; LANES]; 3],
    pub(super) direction: [[f64; LANES]; 3],
    pub(super) end: [f64; LANES],
}

impl Default for RayGroup {
    fn default() -> Self {
        Self { origin: [[0.0; LANES]; 3], direction: [[1.0; LANES]; 3], end: [0.0; LANES] }
    }
}

impl RayGroup {
    /// Makes ray number `k` this one, of unit direction, up to the distance `end`.
    #[inline(always)]
    pub fn set(&mut self, k: usize, ray: &Ray, end: f64) {
        for axis in 0..3 {
            self.origin[axis][k] = ray.origin[axis];
            self.direction[axis][k] = ray.direction[axis];
        }
        self.end[k] = end;
    }

    /// Ray number `k`.
    #[inline(always)]
    pub fn ray(&self, k: usize) -> Ray {
        let ([ox, oy, oz], [dx, dy, dz]) = (&self.origin, &self.direction);
        Ray { origin: DVec3::new(ox[k], oy[k], oz[k]), direction: DVec3::new(dx[k], dy[k], dz[k]) }
    }
}
