//! Media that glow, as next-event estimation sees them here: by single voxels.
//!
//! The light of a point, μt (1 − albedo) Le, is a product of fields. The density of a grid, and the grid that multiplies its
//! emission, are each looked up by a voxel of their own, drawn with its trilinear weight: the mean of the product is the product
//! of the means. What is not of that kind is left to [`source_at`].
//!
//! The weights that join next-event estimation with paths that find the point themselves may be any that add up to 1. The
//! reference integrator puts the extinction there into κ (see [`emission`](crate::emission)); here it is the bound of the
//! grid's cell, which takes one lookup in place of eight, and which no voxel that is drawn exceeds, so that a point near by
//! never brings more than that bound allows. The nearest voxel instead left 5 % more of the variance of scene D.

use glam::DVec3;
use tyndall_lanes::Random;

use super::volume::{FastScene, FastVolume, Kind};
use crate::emission::{extinction_at, source_at};

impl FastScene<'_> {
    /// About μt of the volume of this number at a place in the world, for light that travels along `toward`: the same each time
    /// for the same place, as weights want it.
    #[inline(always)]
    pub(super) fn extinction_about(&self, number: usize, position: DVec3, toward: DVec3) -> f64 {
        match &self.volumes[number] {
            FastVolume { kind: Kind::Grid(grid), shines: None, mu_t, phase, .. } => {
                let density = grid.bound_or_nothing((position - self.centre).as_vec3());
                f64::from(mu_t * phase.projected_area(toward.as_vec3()) * density)
            }
            _ => extinction_at(&self.scene.volumes[number], position, toward),
        }
    }

    /// The same, and an estimate of the source term there, radiance per length in red, green and blue.
    #[inline(always)]
    pub(super) fn extinction_and_source(
        &self,
        number: usize,
        position: DVec3,
        toward: DVec3,
        random: &mut Random,
    ) -> (f64, DVec3) {
        let about = self.extinction_about(number, position, toward);
        let source = match &self.volumes[number] {
            volume @ FastVolume { kind: Kind::Grid(grid), shines: None, mu_t, phase, .. } => {
                let here = (position - self.centre).as_vec3();
                let density = grid.drawn_or_nothing(here, random);
                if density <= 0.0 {
                    return (about, DVec3::ZERO);
                }
                let (_, emission) = self.albedo_and_emission(volume, here, random);
                (emission * (mu_t * phase.projected_area(toward.as_vec3()) * density)).as_dvec3()
            }
            _ => source_at(&self.scene.volumes[number], position, about),
        };
        (about, source)
    }
}
