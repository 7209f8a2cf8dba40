//! A geometry in its place: an affine map of something canonical, such as the unit sphere.
//!
//! Rays are taken to the local coordinates without changing their parameter t, and normals are brought back by the
//! transposed inverse, which keeps an outer side outside even if the map mirrors.
//!
//! Rays leave a surface from an offset along its normal that is 10⁵ times the rounding error of the place: that of a
//! coordinate x is a few times 2⁻⁵³ |x|, and the coordinates are those of the primitive, in its own coordinates, and of
//! where the map takes them.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::local::{LocalHit, LocalPoint};
use super::triangle_mesh::TriangleMesh;
use super::{Hit, cuboid, cylinder, disc, sphere, square};
use crate::Ray;

/// The offset over the coordinates.
const OFFSET: f64 = 1e-11;
/// The least distance of a place from a sharp edge, in offsets, so that the offset ends on the side where it began also
/// where faces meet at a small angle.
const MARGIN: f64 = 100.0;
/// Cosines less than this are as good as none.
const LEAST_COSINE: f64 = 1e-12;

/// What is placed.
#[derive(Debug, Clone)]
pub(super) enum Geometry {
    /// Triangles; `smooth` if their own normals light them.
    Mesh { mesh: Arc<TriangleMesh>, smooth: bool },
    /// The unit sphere.
    Sphere,
    /// The unit cube [0, 1]³.
    Cuboid,
    /// The unit square in z = 0.
    Square,
    /// The unit disc in z = 0, with a hole.
    Disc { inner_radius: f64 },
    /// The cylinder of radius 1 for z from 0 to 1.
    Cylinder { capped: bool },
    /// The plane z = 0; texture coordinates are (x, y).
    Plane,
}

/// A geometry in the world.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    /// The geometry.
    pub geometry: Geometry,
    /// Local coordinates to those of the world.
    pub to_world: DAffine3,
    to_local: DAffine3,
    /// Whether the inner side is the outer one.
    pub flip: bool,
    /// A bound on how much longer local vectors are than those of the world.
    enlargement: f64,
    /// Normal and tangent, of unit length, if they are the same everywhere.
    even: Option<[DVec3; 2]>,
}

impl Placed {
    /// `None` if the map flattens.
    pub fn new(geometry: Geometry, to_world: DAffine3, flip: bool) -> Option<Self> {
        let to_local = to_world.inverse();
        if !to_world.is_finite() || !to_local.is_finite() {
            return None;
        }
        let columns = to_local.matrix3.to_cols_array();
        let enlargement = columns.iter().map(|x| x * x).sum::<f64>().sqrt();
        let even = matches!(geometry, Geometry::Square | Geometry::Plane).then(|| {
            let normal = to_local.matrix3.transpose().z_axis.normalize_or(DVec3::Z);
            [normal, to_world.matrix3.x_axis.normalize_or(normal.any_orthonormal_vector())]
        });
        Some(Self { geometry, to_world, to_local, flip, enlargement, even })
    }

    /// Coordinates of the world to local ones.
    pub fn to_local(&self) -> &DAffine3 {
        &self.to_local
    }

    /// Where `ray` meets it before `end`.
    pub fn intersect(&self, ray: &Ray, end: f64) -> Option<LocalHit> {
        let ray = &self.local_ray(ray);
        match &self.geometry {
            Geometry::Mesh { mesh, .. } => mesh.intersect(ray, end),
            Geometry::Sphere => sphere::intersect(ray, end),
            Geometry::Cuboid => cuboid::intersect(ray, end),
            Geometry::Square => square::intersect(ray, end),
            Geometry::Disc { inner_radius } => disc::intersect(ray, end, *inner_radius),
            Geometry::Cylinder { capped: true } => cylinder::intersect_capped(ray, end),
            Geometry::Cylinder { capped: false } => cylinder::intersect_open(ray, end),
            Geometry::Plane => square::plane_hit(ray, end),
        }
    }

    /// What there is to know of a hit of `ray` on this, which is `shape`.
    pub fn hit(&self, ray: &Ray, hit: &LocalHit, shape: usize) -> Hit {
        let local_ray = self.local_ray(ray);
        let offset = OFFSET * self.reach(&local_ray, hit);
        let point = self.point(&local_ray, hit, MARGIN * offset * self.enlargement);
        let to_normal = self.to_local.matrix3.transpose();
        let mut normal = match self.even {
            Some([normal, _]) => normal,
            None => (to_normal * point.normal).normalize_or(-ray.direction),
        };
        // Where the ray grazes, rounding must not tell another story of which way it crosses.
        let cosine = ray.direction.dot(normal);
        let side = if hit.enters { -1.0 } else { 1.0 };
        if cosine * side <= 0.0 {
            normal = (normal + ray.direction * (side * LEAST_COSINE - cosine)).normalize();
        }
        let shading_normal = point.shading_normal.map_or(normal, |lit_by| {
            let lit_by = (to_normal * lit_by).normalize_or(normal);
            let same_side = lit_by.dot(normal);
            if same_side == 0.0 { normal } else { lit_by * same_side.signum() }
        });
        let tangent = match self.even {
            Some([_, tangent]) => tangent,
            None => {
                let tangent = self.to_world.transform_vector3(point.tangent);
                tangent.normalize_or(normal.any_orthonormal_vector())
            }
        };
        let outwards = if self.flip { -1.0 } else { 1.0 };
        Hit {
            t: hit.t,
            position: self.to_world.transform_point3(point.position),
            normal: normal * outwards,
            shading_normal: shading_normal * outwards,
            tangent,
            uv: point.uv,
            shape,
            primitive: hit.primitive as usize,
            offset,
        }
    }

    /// The greatest coordinate that the place of a hit is computed from.
    fn reach(&self, local_ray: &Ray, hit: &LocalHit) -> f64 {
        let size = match &self.geometry {
            Geometry::Mesh { mesh, .. } => mesh.size(hit.primitive),
            Geometry::Plane => local_ray.at(hit.t).abs(),
            _ => DVec3::ONE,
        };
        let DMat3 { x_axis, y_axis, z_axis } = self.to_world.matrix3;
        let spread = x_axis.abs() * size.x + y_axis.abs() * size.y + z_axis.abs() * size.z;
        (spread + self.to_world.translation.abs()).max_element()
    }

    fn point(&self, ray: &Ray, hit: &LocalHit, margin: f64) -> LocalPoint {
        match &self.geometry {
            Geometry::Mesh { mesh, smooth } => mesh.point(hit, margin, *smooth),
            Geometry::Sphere => sphere::point(ray, hit.t),
            Geometry::Cuboid => cuboid::point(ray, hit.t, hit.primitive, margin),
            Geometry::Square | Geometry::Plane => square::point(ray, hit.t),
            Geometry::Disc { inner_radius } => disc::point(ray, hit.t, *inner_radius),
            Geometry::Cylinder { capped } => {
                cylinder::point(ray, hit.t, hit.primitive, if *capped { margin } else { 0.0 })
            }
        }
    }

    /// A box around it; `None` for a plane.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let rows = self.to_world.matrix3.transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis];
        let around = |reach: [f64; 3]| {
            let reach = DVec3::from_array(reach);
            [self.to_world.translation - reach, self.to_world.translation + reach]
        };
        let [min, max] = match &self.geometry {
            Geometry::Mesh { mesh, .. } => self.around_corners(mesh.bounds()),
            Geometry::Sphere => around(rows.map(DVec3::length)),
            Geometry::Cuboid => self.around_corners([DVec3::ZERO, DVec3::ONE]),
            Geometry::Square => self.around_corners([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]),
            Geometry::Disc { .. } => around(rows.map(|row| row.truncate().length())),
            Geometry::Cylinder { .. } => {
                let [min, max] = around(rows.map(|row| row.truncate().length()));
                let along = self.to_world.matrix3.z_axis;
                [min + along.min(DVec3::ZERO), max + along.max(DVec3::ZERO)]
            }
            Geometry::Plane => return None,
        };
        // Far more than rounding; a box around a flat thing has some thickness.
        let margin = OFFSET * min.abs().max(max.abs()).max_element();
        Some([min - margin, max + margin])
    }

    fn around_corners(&self, corners: [DVec3; 2]) -> [DVec3; 2] {
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        (0..8).fold(empty, |[min, max], number| {
            let corner = DVec3::from_array(std::array::from_fn(|axis| corners[(number >> axis) & 1][axis]));
            let corner = self.to_world.transform_point3(corner);
            [min.min(corner), max.max(corner)]
        })
    }

    fn local_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_local.transform_point3(ray.origin),
            direction: self.to_local.transform_vector3(ray.direction),
        }
    }
}
