//! A participating medium in space, ready to trace: where it is, how dense, what it does to light.

use glam::{DAffine3, DVec3};
use std::sync::Arc;
use tyndall_optics::PhaseFunction;
use tyndall_volumes::BrickGrid;

use crate::{Exponential, Fields, MediumSpectra, Ray};

/// What a medium does to light where its density is 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Extinction coefficient μt, 1/scene unit: of oriented particles, the greatest over all directions (see
    /// [`Medium::mu_t_along`]); of a chromatic medium, the mean of its channels.
    pub mu_t: f64,
    /// Single-scattering albedo μs/μt, linear RGB in 0…1.
    pub albedo: DVec3,
    /// The phase function.
    pub phase_function: PhaseFunction,
    /// Emitted radiance Le; the source term of the volume rendering equation is μa·Le.
    pub emission: DVec3,
    /// Radiance added per length, 1/scene unit, independent of absorption.
    pub emission_per_length: DVec3,
    /// What depends on colour beside albedo and emission; it takes the place of `mu_t` and `phase_function`.
    pub chromatic: Option<Arc<ChromaticMedium>>,
    /// The same by wavelength. Without it, as after a change of the other fields in code, colours become spectra that have
    /// them.
    pub spectra: Option<Arc<MediumSpectra>>,
}

/// What of a medium depends on colour, beside its albedo and emission.
#[derive(Debug, Clone, PartialEq)]
pub struct ChromaticMedium {
    /// Extinction coefficient μt in red, green and blue, 1/scene unit.
    pub mu_t: DVec3,
    /// Phase functions of red, green and blue, if they differ.
    pub phase_functions: Option<[PhaseFunction; 3]>,
}

impl Medium {
    /// A grey medium that does not glow.
    pub fn grey(mu_t: f64, albedo: f64, phase_function: PhaseFunction) -> Medium {
        Medium {
            mu_t,
            albedo: DVec3::splat(albedo),
            phase_function,
            emission: DVec3::ZERO,
            emission_per_length: DVec3::ZERO,
            chromatic: None,
            spectra: None,
        }
    }

    /// Extinction coefficient for light that travels along the unit vector `direction`, or against it.
    pub fn mu_t_along(&self, direction: DVec3) -> f64 {
        self.mu_t * self.phase_function.projected_area(direction)
    }
}

/// Where the density of a volume comes from, in the volume's local coordinates.
#[derive(Debug, Clone)]
pub enum Density {
    /// 1 everywhere.
    Everywhere,
    /// 1 between two corners.
    Box {
        /// Least corner.
        min: DVec3,
        /// Greatest corner.
        max: DVec3,
    },
    /// 1 within the unit sphere about the origin.
    Sphere,
    /// 1 where bottom < y < top.
    Slab {
        /// y of the lower face.
        bottom: f64,
        /// y of the upper face.
        top: f64,
    },
    /// exp(−(y − bottom)/scale_height) where bottom < y < top.
    Atmosphere {
        /// y of the lower face.
        bottom: f64,
        /// y of the upper face; may be infinite.
        top: f64,
        /// Height over which the density falls by a factor e.
        scale_height: f64,
    },
    /// The filtered values of a grid, none of whose voxels is negative; local coordinates are those of the grid's
    /// filter.
    Grid(Arc<BrickGrid>),
}

/// A medium that stands somewhere. Where volumes overlap, their coefficients add.
#[derive(Debug, Clone)]
pub struct Volume {
    /// How messages call it.
    pub name: String,
    /// World space to the density's local space.
    pub world_to_local: DAffine3,
    /// The density that multiplies the coefficients.
    pub density: Density,
    /// The coefficients at density 1.
    pub medium: Medium,
    /// What varies beside the density.
    pub fields: Option<Arc<Fields>>,
}

impl Volume {
    /// The ray in local coordinates. Its direction is not normalised, so that distances along it stay those of the
    /// world.
    pub fn local_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.world_to_local.transform_point3(ray.origin),
            direction: self.world_to_local.transform_vector3(ray.direction),
        }
    }

    /// The distances between which the local ray is inside the density, cut to those from `start` to `end`; for a grid,
    /// inside its domain.
    pub fn interval(&self, local: &Ray, (start, end): (f64, f64)) -> Option<(f64, f64)> {
        let (enter, leave) = match &self.density {
            Density::Everywhere => (start, end),
            Density::Box { min, max } => box_interval(local, *min, *max)?,
            Density::Slab { bottom, top } | Density::Atmosphere { bottom, top, .. } => {
                let infinite = DVec3::splat(f64::INFINITY);
                box_interval(local, (-infinite).with_y(*bottom), infinite.with_y(*top))?
            }
            Density::Sphere => sphere_interval(local)?,
            Density::Grid(grid) => {
                let [min, max] = grid.domain();
                box_interval(local, min, max)?
            }
        };
        let (enter, leave) = (enter.max(start), leave.min(end));
        (enter < leave).then_some((enter, leave))
    }

    /// The density at a place inside it, in local coordinates.
    pub fn density_at(&self, local: DVec3) -> f64 {
        match &self.density {
            Density::Grid(grid) => grid.value(local),
            Density::Atmosphere { bottom, scale_height, .. } => libm::exp(-(local.y - bottom) / scale_height),
            Density::Everywhere | Density::Box { .. } | Density::Sphere | Density::Slab { .. } => 1.0,
        }
    }

    /// Whether a place, in local coordinates, is where the density is.
    pub fn contains(&self, local: DVec3) -> bool {
        match &self.density {
            Density::Sphere => local.length_squared() <= 1.0,
            Density::Slab { bottom, top } | Density::Atmosphere { bottom, top, .. } => {
                (*bottom..=*top).contains(&local.y)
            }
            _ => self.local_box().is_none_or(|[min, max]| local.cmpge(min).all() && local.cmple(max).all()),
        }
    }

    /// The density at any place in local coordinates: none outside.
    pub fn density_anywhere(&self, local: DVec3) -> f64 {
        if self.contains(local) { self.density_at(local) } else { 0.0 }
    }

    /// ∫ density along the local ray between two distances inside the density, in closed form; `None` for a grid.
    pub fn density_integral(&self, local: &Ray, (start, end): (f64, f64)) -> Option<f64> {
        match &self.density {
            Density::Grid(_) => None,
            Density::Atmosphere { bottom, scale_height, .. } => {
                Some(Exponential::of_atmosphere(local, *bottom, *scale_height).integral(start, end))
            }
            _ => Some(end - start),
        }
    }

    /// The distance at which ∫ density along the local ray from `start` on is `integral`, in closed form and as if the
    /// density had no end; infinite if it never is, and for a grid.
    pub fn distance_of_integral(&self, local: &Ray, start: f64, integral: f64) -> f64 {
        match &self.density {
            Density::Grid(_) => f64::INFINITY,
            Density::Atmosphere { bottom, scale_height, .. } => {
                Exponential::of_atmosphere(local, *bottom, *scale_height)
                    .distance_of_integral(start, integral)
            }
            _ => start + integral,
        }
    }

    /// Corners of a box in local coordinates around the density; `None` where it is unbounded.
    pub fn local_box(&self) -> Option<[DVec3; 2]> {
        match &self.density {
            Density::Everywhere | Density::Slab { .. } | Density::Atmosphere { .. } => None,
            Density::Box { min, max } => Some([*min, *max]),
            Density::Sphere => Some([DVec3::NEG_ONE, DVec3::ONE]),
            Density::Grid(grid) => Some(grid.domain()),
        }
    }

    /// Corners of the box around the density in world space; `None` where it is unbounded.
    pub fn world_box(&self) -> Option<[DVec3; 2]> {
        let corners = self.local_box()?;
        let to_world = self.world_to_local.inverse();
        let corner = |i: usize| {
            to_world.transform_point3(DVec3::new(corners[i >> 2].x, corners[i >> 1 & 1].y, corners[i & 1].z))
        };
        let min = (1..8).fold(corner(0), |least, i| least.min(corner(i)));
        let max = (1..8).fold(corner(0), |greatest, i| greatest.max(corner(i)));
        Some([min, max])
    }
}

/// Slab method; a ray in the plane of a face is inside.
pub(crate) fn box_interval(ray: &Ray, min: DVec3, max: DVec3) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        if direction == 0.0 {
            if origin < min[axis] || origin > max[axis] {
                return None;
            }
            continue;
        }
        let a = (min[axis] - origin) / direction;
        let b = (max[axis] - origin) / direction;
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter < leave).then_some((enter, leave))
}

/// The unit sphere, by the numerically stable quadratic (Haines, Günther & Akenine-Möller 2019, "Precision
/// improvements for ray/sphere intersection").
fn sphere_interval(ray: &Ray) -> Option<(f64, f64)> {
    let a = ray.direction.length_squared();
    let half_b = -ray.origin.dot(ray.direction);
    let nearest = ray.origin + ray.direction * (half_b / a);
    let discriminant = 1.0 - nearest.length_squared();
    if discriminant <= 0.0 {
        return None;
    }
    let c = ray.origin.length_squared() - 1.0;
    let q = half_b + (a * discriminant).sqrt().copysign(half_b);
    let (first, second) = (c / q, q / a);
    Some((first.min(second), first.max(second)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn homogeneous(density: Density, world_to_local: DAffine3) -> Volume {
        let medium = Medium::grey(1.0, 1.0, PhaseFunction::Isotropic);
        Volume { name: "test".into(), world_to_local, density, medium, fields: None }
    }

    fn interval(volume: &Volume, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        volume.interval(&volume.local_ray(&Ray { origin, direction }), (0.0, 100.0))
    }

    #[test]
    fn rays_enter_and_leave_shapes_at_world_distances() {
        let shrunk = DAffine3::from_scale(DVec3::splat(2.0)).inverse();
        let sphere = homogeneous(Density::Sphere, shrunk);
        assert_eq!(interval(&sphere, DVec3::new(0.0, 0.0, 5.0), DVec3::NEG_Z), Some((3.0, 7.0)));
        assert_eq!(interval(&sphere, DVec3::ZERO, DVec3::X), Some((0.0, 2.0)));
        assert_eq!(interval(&sphere, DVec3::new(0.0, 2.1, 5.0), DVec3::NEG_Z), None);
        assert_eq!(interval(&sphere, DVec3::new(0.0, 0.0, 5.0), DVec3::Z), None);

        let slab = homogeneous(Density::Slab { bottom: 0.0, top: 1.0 }, DAffine3::IDENTITY);
        assert_eq!(interval(&slab, DVec3::new(3.0, 2.0, 1.0), DVec3::NEG_Y), Some((1.0, 2.0)));
        assert_eq!(interval(&slab, DVec3::new(3.0, 0.5, 1.0), DVec3::X), Some((0.0, 100.0)));
        assert_eq!(interval(&slab, DVec3::new(3.0, 1.5, 1.0), DVec3::X), None);

        let cube = homogeneous(Density::Box { min: DVec3::ZERO, max: DVec3::ONE }, DAffine3::IDENTITY);
        assert_eq!(interval(&cube, DVec3::new(0.5, 0.5, -1.0), DVec3::Z), Some((1.0, 2.0)));
        assert_eq!(interval(&cube, DVec3::new(0.5, 1.5, -1.0), DVec3::Z), None);
    }

    #[test]
    fn the_integral_of_an_atmosphere_is_that_of_a_fine_quadrature_and_is_inverted() {
        let density = Density::Atmosphere { bottom: 1.0, top: f64::INFINITY, scale_height: 2.0 };
        let atmosphere = homogeneous(density, DAffine3::IDENTITY);
        for slope in [-0.9_f64, -1e-3, -1e-12, 0.0, 1e-12, 1e-3, 0.9] {
            let direction = DVec3::new((1.0 - slope * slope).sqrt(), slope, 0.0);
            let ray = Ray { origin: DVec3::new(0.0, 5.0, 0.0), direction };
            let (start, end) = (0.5, 3.5);
            let steps = 3000;
            let step = (end - start) / f64::from(steps);
            let height = |k: i32| ray.at(start + (f64::from(k) + 0.5) * step).y;
            let quadrature: f64 = (0..steps).map(|k| step * (-(height(k) - 1.0) / 2.0).exp()).sum();
            let integral = atmosphere.density_integral(&ray, (start, end)).unwrap();
            assert!((integral / quadrature - 1.0).abs() < 1e-7, "{slope}: {integral} {quadrature}");
            let distance = atmosphere.distance_of_integral(&ray, start, integral);
            assert!((distance - end).abs() < 1e-9, "{slope}: {distance}");
        }
        // Straight up from 5 to infinity there is e^-2 · 2 in all.
        let up = Ray { origin: DVec3::new(0.0, 5.0, 0.0), direction: DVec3::Y };
        let all = 2.0 * (-2.0_f64).exp();
        assert_eq!(atmosphere.interval(&up, (0.0, f64::INFINITY)), Some((0.0, f64::INFINITY)));
        assert!((atmosphere.density_integral(&up, (0.0, f64::INFINITY)).unwrap() - all).abs() < 1e-15);
        assert_eq!(atmosphere.distance_of_integral(&up, 0.0, 1.001 * all), f64::INFINITY);
        // Down from where the density underflows: half of all there is lies above 1 + 2 ln 2.
        let down = Ray { origin: DVec3::new(0.0, 3001.0, 0.0), direction: DVec3::NEG_Y };
        let distance = atmosphere.distance_of_integral(&down, 0.0, 1.0);
        assert!((distance - (3000.0 - 2.0 * 2.0_f64.ln())).abs() < 1e-9, "{distance}");
    }

    #[test]
    fn the_world_box_surrounds_a_rotated_shape() {
        let turn = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_4);
        let cube = homogeneous(Density::Box { min: DVec3::NEG_ONE, max: DVec3::ONE }, turn.inverse());
        let [min, max] = cube.world_box().unwrap();
        assert!((max.x - 2.0_f64.sqrt()).abs() < 1e-12 && (min.y + 2.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(homogeneous(Density::Everywhere, turn).world_box(), None);
    }
}
