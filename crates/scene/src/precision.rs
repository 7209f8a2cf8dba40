//! How short the ways between collisions are, against how finely numbers tell places apart.
//!
//! Places in a volume are numbers of about its size L; neighbours among single floats are L/2²³ apart, among doubles L/2⁵².
//! A path that goes in steps of the mean free path 1/μt stands still, or gets out where it should not, once these steps are as
//! short. In a grid a path walks from cell to cell, and rounding moves it at each. The limits are where half-spaces of
//! albedo 0.9 still reflect what they should, with a factor of some ten to spare.

use crate::build::scene_radius;
use crate::{Density, Scene, Volume};

/// The numbers that it takes to follow paths through a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precision {
    /// Single floats do.
    Single,
    /// It takes doubles.
    Double,
    /// Doubles are too coarse.
    Beyond,
}

/// Collisions along the edge of a voxel, up to which single floats and doubles do.
const ALONG_VOXEL: [f64; 2] = [64.0, 1e7];

/// Optical thickness of an even volume, up to which single floats and doubles do.
const ALONG_VOLUME: [f64; 2] = [1e6, 1e12];

impl Volume {
    /// The numbers that it takes; `scene_size` counts for a volume without a size of its own.
    pub(crate) fn precision(&self, scene_size: f64) -> Precision {
        let medium = &self.medium;
        let mu_t = medium.chromatic.as_ref().map_or(medium.mu_t, |chromatic| chromatic.mu_t.max_element());
        let to_world = self.world_to_local.inverse().matrix3;
        let unit = [to_world.x_axis, to_world.y_axis, to_world.z_axis].map(|axis| axis.length());
        let unit = unit.into_iter().fold(0.0, f64::max);
        let (length, [single, double]) = match &self.density {
            Density::Grid(grid) => (unit * f64::from(grid.bounds().max), ALONG_VOXEL),
            Density::Box { min, max } => (unit * (*max - *min).max_element(), ALONG_VOLUME),
            Density::Sphere => (2.0 * unit, ALONG_VOLUME),
            Density::Slab { bottom, top } => (unit * (top - bottom), ALONG_VOLUME),
            Density::Atmosphere { bottom, top, scale_height } => {
                (unit * scale_height.min(top - bottom), ALONG_VOLUME)
            }
            Density::Everywhere => (scene_size, ALONG_VOLUME),
        };
        let thickness = mu_t * length;
        if thickness > double {
            Precision::Beyond
        } else if thickness > single && medium.albedo.max_element() > 0.0 {
            Precision::Double
        } else {
            Precision::Single
        }
    }
}

impl Scene {
    /// A volume that single floats are too coarse for, if there is one.
    pub fn too_dense_for_single_precision(&self) -> Option<&Volume> {
        let size = 2.0 * scene_radius(&self.volumes, &self.surfaces);
        self.volumes.iter().find(|volume| volume.precision(size) > Precision::Single)
    }
}
