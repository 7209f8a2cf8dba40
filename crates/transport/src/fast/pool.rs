//! The paths in flight on one thread.
//!
//! What the march touches at every step stands in arrays, one for each quantity, so that its arithmetic runs over
//! many paths at once; the rest of a path is needed only when something happens to it. The arrays of 256
//! paths take 26 KiB and stay near the core.

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;

use crate::first_draws::FirstDraws;
use crate::found_light::Turned;
use crate::path_layers::FirstMet;
use crate::work::Pixel;

use super::gather::Gathered;
use super::split::Fork;

/// Paths in flight on a thread: enough that the loads of some hide behind the work of others.
pub(super) const POOL: usize = 256;

/// What a ray is for, in [`Rays::shadow`]: a path's own, that looks for a collision.
pub(super) const OWN: f32 = 0.0;

/// The camera's, that [gathers](super::gather) on its way.
pub(super) const GATHERS: f32 = -1.0;

/// A shadow ray.
pub(super) const SHADOW: f32 = 1.0;

/// State of the rays, in local voxel coordinates of the volume that each is in. Distances `t` are in world units.
pub(super) struct Rays {
    pub ox: [f32; POOL],
    pub oy: [f32; POOL],
    pub oz: [f32; POOL],
    /// The origin, a small distance further along each axis: where the ray is in a face of cells, or nearly, the cell
    /// ahead of it is looked up.
    pub ax: [f32; POOL],
    pub ay: [f32; POOL],
    pub az: [f32; POOL],
    pub dx: [f32; POOL],
    pub dy: [f32; POOL],
    pub dz: [f32; POOL],
    /// 1/d.
    pub ix: [f32; POOL],
    pub iy: [f32; POOL],
    pub iz: [f32; POOL],
    /// Where the ray is.
    pub t: [f32; POOL],
    /// Where it leaves the volume, or a nearer collision in another volume; 0 for a place without a ray.
    pub end: [f32; POOL],
    /// Optical thickness under the majorant up to the next tentative collision.
    pub tau: [f32; POOL],
    /// The least step: the small distance of `ax` along the axis that the ray is fastest on.
    pub nudge: [f32; POOL],
    /// μt at density 1 of the volume.
    pub mu_t: [f32; POOL],
    /// What the bounds of cells are multiplied by to majorants: μt, or more.
    pub rate: [f32; POOL],
    /// Majorant of the cell that the ray is in.
    pub majorant: [f32; POOL],
    /// Weight of ratio tracking; stays 1 on rays that look for a collision.
    pub transmittance: [f32; POOL],
    /// [`SHADOW`], [`OWN`] or [`GATHERS`]: above, at or below 0.
    pub shadow: [f32; POOL],
    pub volume: [u32; POOL],
    /// Probability that the last tentative collision of a gathering ray is null, and the number to decide it by.
    pub null: [[f32; 2]; POOL],
    pub random: [Random; POOL],
}

impl Rays {
    pub fn new() -> Box<Rays> {
        let zero = [0.0; POOL];
        Box::new(Rays {
            ox: zero,
            oy: zero,
            oz: zero,
            ax: zero,
            ay: zero,
            az: zero,
            dx: [1.0; POOL],
            dy: [1.0; POOL],
            dz: [1.0; POOL],
            ix: [1.0; POOL],
            iy: [1.0; POOL],
            iz: [1.0; POOL],
            t: zero,
            end: zero,
            tau: zero,
            nudge: zero,
            mu_t: zero,
            rate: zero,
            majorant: zero,
            transmittance: zero,
            shadow: zero,
            volume: [0; POOL],
            null: [[0.0; 2]; POOL],
            random: [Random::default(); POOL],
        })
    }
}

/// The rest of a path: touched when it collides, leaves or starts. Positions are centred world space.
#[derive(Clone, Copy, Default)]
pub(super) struct Path {
    pub pixel: Pixel,
    /// The path's random numbers before the first.
    pub begun: Random,
    /// Numbers up to its first turn.
    pub draws: FirstDraws,
    /// Start of the current ray.
    pub position: Vec3,
    /// Direction of the path's own ray (not of a shadow ray).
    pub direction: Vec3,
    pub throughput: Vec3,
    /// Density with which `direction` was drawn from a phase function, or at a surface.
    pub turn_pdf: f32,
    /// Where that was; none for the camera's ray and after a mirror, which next-event estimation does not compete with.
    pub turned: Option<DVec3>,
    /// Turns so far, at collisions and surfaces.
    pub turns: u32,
    /// Collisions so far.
    pub scatterings: u32,
    /// Volume of the nearest collision found so far along the ray, and its distance.
    pub nearest: Option<(u32, f32)>,
    /// Number of the span that the current ray is in.
    pub place: u32,
    /// What the shadow ray brings if nothing is in its way.
    pub direct: Vec3,
    /// Whether a medium sent that out.
    pub direct_is_glow: bool,
    pub shadow_direction: Vec3,
    pub light_distance: f32,
    /// Where the current ray ends at the latest.
    pub ray_end: f32,
    pub background: Vec3,
    pub emission: Vec3,
    pub single: Vec3,
    pub multiple: Vec3,
    /// What the camera's ray met.
    pub first: Option<FirstMet>,
    /// What it has gathered.
    pub gathered: Gathered,
    /// Where it has split.
    pub fork: Fork,
}

impl Path {
    /// What light that the path finds is weighted by.
    #[inline(always)]
    pub fn turned(&self) -> Turned {
        self.turned.map(|from| (from, f64::from(self.turn_pdf)))
    }

    /// Makes a shadow ray ready, which brings `direct` if nothing is in its way.
    #[inline(always)]
    pub fn look(&mut self, direct: Vec3, is_glow: bool, (toward, distance): (DVec3, f64)) {
        self.direct = direct;
        self.direct_is_glow = is_glow;
        self.shadow_direction = toward.as_vec3();
        self.light_distance = distance as f32;
    }

    /// Adds light that was scattered as often as the path has been.
    #[inline(always)]
    pub fn add_in_scattered(&mut self, radiance: Vec3) {
        match self.scatterings {
            0 => self.background += radiance,
            1 => self.single += radiance,
            _ => self.multiple += radiance,
        }
    }
}
