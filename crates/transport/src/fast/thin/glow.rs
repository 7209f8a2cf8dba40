//! The light that the medium sends out, as a light to draw from.
//!
//! A place y is drawn with a density p_V in proportion to a table of the source term, so that what it brings, but for the
//! distance and what is in the way, is about the same for all places. A path that turned at x with the density p_ω finds y
//! along its ray with the density p_ω p_e(y), where p_e is in proportion to the same source; so of the weights that join
//! both (Veach 1997, section 9.2, with squares) the source cancels:
//!
//!   w_path = a²/(a² + b²),   a = p_ω A,   b = n P d²
//!
//! with n draws of probability P, the distance d, and the area A that the medium's light seems to come from.

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;

use super::super::coarse::Lattice;

/// Places to draw light from.
pub(super) struct Glow {
    lattice: Lattice,
    /// About the source term at each place.
    pub source: Vec<f32>,
    /// Its sums up to and including each place, over all of it.
    sums: Vec<f32>,
    /// 1 over the volume of a place times the sum of the table.
    density_scale: f64,
    /// The area that the light seems to come from.
    area: f64,
}

impl Glow {
    /// The places of a table; `None` if it is dark.
    pub fn new(lattice: Lattice, source: Vec<f32>) -> Option<Glow> {
        let mut total = 0.0;
        let sums: Vec<f64> = source
            .iter()
            .map(|&x| {
                total += f64::from(x);
                total
            })
            .collect();
        let per_length = f64::from(lattice.per_length);
        let area = lattice.apparent_area(&source);
        (total > 0.0 && area > 0.0).then(|| Glow {
            lattice,
            source,
            sums: sums.iter().map(|sum| (sum / total) as f32).collect(),
            density_scale: per_length.powi(3) / total,
            area,
        })
    }

    /// A place, relative to the scene's centre, and its density per volume.
    #[inline(always)]
    pub fn draw(&self, random: &mut Random) -> (Vec3, f64) {
        let u = random.f32();
        let number = self.sums.partition_point(|&sum| sum <= u).min(self.sums.len() - 1);
        let density = f64::from(self.source[number]) * self.density_scale;
        (self.lattice.within_place(number, random.f32x3()), density)
    }

    /// Weight of a place found by a path, by the path's density in its direction and the probability of the draws together.
    #[inline(always)]
    pub fn path_weight(&self, path_pdf: f64, draws: f64, from: DVec3, place: DVec3) -> f64 {
        let by_path = (path_pdf * self.area).powi(2);
        let by_light = (draws * place.distance_squared(from)).powi(2);
        if by_path + by_light > 0.0 { by_path / (by_path + by_light) } else { 1.0 }
    }
}
