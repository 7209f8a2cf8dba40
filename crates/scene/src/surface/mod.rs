//! Surfaces ready to trace: where rays meet them, what they are made of, and which volumes they bound.

mod boundaries;
mod build;
mod build_material;
mod bvh;
mod closed;
mod cuboid;
mod cylinder;
mod disc;
mod flats;
mod local;
mod material;
mod mesh;
mod picture;
mod pieces;
mod placed;
mod side_by_side;
mod sphere;
mod square;
mod texture;
mod triangle;
mod triangle_mesh;
mod world_primitive;

use glam::DVec3;

pub use self::boundaries::{Boundaries, Presence};
pub(crate) use self::build::{VolumeNumber, build_surfaces, numbers_of};
pub use self::build_material::MaterialBuilder;
pub(crate) use self::build_material::{MOST_PARTS, conductor_index};
use self::bvh::Bvh;
use self::flats::Flats;
use self::local::LocalHit;
pub use self::material::{ConductorIndex, Material};
pub use self::mesh::{Mesh, read_mesh, write_ply};
pub use self::picture::Picture;
use self::placed::{Geometry, Placed};
pub use self::side_by_side::{LANES, RayGroup};
pub use self::texture::{Colour, ImageLookup, Placement, Texture};
pub use self::world_primitive::{SurfacePoint, WorldPrimitive};
use crate::Ray;

/// All surfaces of a scene.
#[derive(Debug, Clone, Default)]
pub struct Surfaces {
    /// What the surfaces belong to.
    pub shapes: Vec<Shape>,
    /// What they are made of.
    pub materials: Vec<Material>,
    /// Where the shapes are.
    placed: Vec<Placed>,
    /// The infinite planes, and the squares if they are few.
    flats: Flats,
    /// Numbers of the other shapes, and a tree over them.
    others: Vec<usize>,
    tree: Bvh,
    /// A box around all shapes that have an end.
    bounds: Option<[DVec3; 2]>,
}

/// One `[[shape]]`, or one of its instances.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// How messages call it.
    pub name: String,
    /// Number of its material.
    pub material: usize,
    /// Numbers of the volumes that are inside it.
    pub interior: Vec<usize>,
    /// Numbers of the volumes that end at it.
    pub exterior: Vec<usize>,
    /// Number of its light, if it shines.
    pub light: Option<usize>,
    /// Number in the layer of objects.
    pub id: u32,
    /// Whether its shadows are for a compositor.
    pub is_shadow_catcher: bool,
}

/// That a ray meets a shape, and where along the ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    shape: usize,
    hit: LocalHit,
}

impl Meeting {
    /// Distance along the ray.
    pub fn distance(&self) -> f64 {
        self.hit.t
    }

    /// Number of the shape.
    pub fn shape(&self) -> usize {
        self.shape
    }
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// Place on the surface.
    pub position: DVec3,
    /// Unit normal of the surface itself, to its outer side.
    pub normal: DVec3,
    /// Unit normal that it is lit by, on the same side of the surface.
    pub shading_normal: DVec3,
    /// Direction in which the first texture coordinate grows; any along the surface where there is none.
    pub tangent: DVec3,
    /// Texture coordinates.
    pub uv: [f64; 2],
    /// Number of the shape.
    pub shape: usize,
    /// Number of the primitive within the shape.
    pub primitive: usize,
    /// Distance from the surface at which rays leave it: far above the rounding errors of the place.
    pub offset: f64,
}

impl Surfaces {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// The nearest surface along `ray`, of unit direction, before the distance `end`.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, end: f64) -> Option<Hit> {
        self.meet(ray, end).map(|meeting| self.hit(ray, &meeting))
    }

    /// The same, without what there is to know of the place.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray, end: f64) -> Option<Meeting> {
        let nearest = self.flats.intersect(ray, end);
        if self.others.is_empty() { nearest } else { self.meet_others(ray, end, nearest) }
    }

    /// What each of some rays meets.
    #[inline(always)]
    pub fn meet_all(&self, rays: &RayGroup) -> [Option<Meeting>; LANES] {
        let mut meetings = self.flats.intersect_all(rays);
        if !self.others.is_empty() {
            for (k, meeting) in meetings.iter_mut().enumerate() {
                if rays.end[k] > 0.0 {
                    *meeting = self.meet_others(&rays.ray(k), rays.end[k], *meeting);
                }
            }
        }
        meetings
    }

    #[inline(never)]
    fn meet_others(&self, ray: &Ray, end: f64, nearest: Option<Meeting>) -> Option<Meeting> {
        let mut nearest = nearest;
        let end = nearest.as_ref().map_or(end, |meeting| meeting.hit.t);
        self.tree.traverse(ray, end, |item, end| {
            let shape = self.others[item as usize];
            let Some(hit) = self.placed[shape].intersect(ray, end) else { return end };
            nearest = Some(Meeting { shape, hit });
            hit.t
        });
        nearest
    }

    /// The place where `ray` meets a surface.
    pub fn hit(&self, ray: &Ray, meeting: &Meeting) -> Hit {
        self.placed[meeting.shape].hit(ray, &meeting.hit, meeting.shape)
    }

    /// Whether any surface is in the way of `ray`, of unit direction, before the distance `end`: that of materials which let
    /// light pass as well.
    #[inline(always)]
    pub fn stand_in(&self, ray: &Ray, end: f64) -> bool {
        self.flats.stand_in(ray, end) || (!self.others.is_empty() && self.others_stand_in(ray, end))
    }

    /// Whether any surface is in the way of each of some rays.
    #[inline(always)]
    pub fn stand_in_all(&self, rays: &RayGroup) -> [bool; LANES] {
        let mut met = self.flats.stand_in_all(rays);
        if !self.others.is_empty() {
            for (k, met) in met.iter_mut().enumerate() {
                *met = *met || (rays.end[k] > 0.0 && self.others_stand_in(&rays.ray(k), rays.end[k]));
            }
        }
        met
    }

    #[inline(never)]
    fn others_stand_in(&self, ray: &Ray, end: f64) -> bool {
        let mut is_met = false;
        self.tree.traverse(ray, end, |item, end| {
            is_met |= self.placed[self.others[item as usize]].intersect(ray, end).is_some();
            // No box begins before it: this ends the traversal.
            if is_met { f64::NEG_INFINITY } else { end }
        });
        is_met
    }

    /// Makes the shapes ready to be met by rays.
    fn index(&mut self) {
        let is_plane = |placed: &Placed| matches!(placed.geometry, Geometry::Plane);
        let is_square = |placed: &Placed| matches!(placed.geometry, Geometry::Square);
        let are_few = self.placed.iter().filter(|placed| is_square(placed)).count() <= flats::MOST;
        let mut boxes = Vec::new();
        for (number, placed) in self.placed.iter().enumerate() {
            let bounds = placed.bounds();
            if let Some([min, max]) = bounds {
                let [least, most] = self.bounds.unwrap_or([min, max]);
                self.bounds = Some([least.min(min), most.max(max)]);
            }
            match bounds {
                Some(bounds) if !(are_few && is_square(placed)) => {
                    self.others.push(number);
                    boxes.push(bounds);
                }
                _ => self.flats.add(number, placed.to_local(), is_plane(placed)),
            }
        }
        self.tree = Bvh::new(boxes.into_iter());
    }

    /// A box around all surfaces that have an end; `None` if there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.bounds
    }

    /// Number of triangles of all meshes, each counted as often as it stands in the scene.
    pub fn triangle_count(&self) -> u64 {
        let triangles = |placed: &Placed| match &placed.geometry {
            Geometry::Mesh { mesh, .. } => mesh.mesh().triangles.len() as u64,
            _ => 0,
        };
        self.placed.iter().map(triangles).sum()
    }

    /// The pieces of a shape in world space, in the order of [`Hit::primitive`]; `None` for an infinite plane, and for a
    /// sphere, disc or cylinder that its transform has deformed.
    pub fn world_primitives(&self, shape: usize) -> Option<Vec<WorldPrimitive>> {
        pieces::world_primitives(&self.placed[shape])
    }

    /// The shape that a hit is on.
    pub fn shape(&self, hit: &Hit) -> &Shape {
        &self.shapes[hit.shape]
    }

    /// The material of a hit.
    pub fn material(&self, hit: &Hit) -> &Material {
        &self.materials[self.shape(hit).material]
    }
}

impl Hit {
    /// Where a ray in `direction` leaves the surface from, on the side it goes to and far enough not to meet the same
    /// place again.
    pub fn leave(&self, direction: DVec3) -> DVec3 {
        let side = if direction.dot(self.normal) < 0.0 { -1.0 } else { 1.0 };
        self.position + self.normal * (side * self.offset)
    }

    /// The local frame of [`tyndall_optics::bsdf`]: tangent, bitangent and shading normal.
    pub fn frame(&self) -> [DVec3; 3] {
        let normal = self.shading_normal;
        let tangent = self.tangent - normal * normal.dot(self.tangent);
        let tangent = tangent.normalize_or(normal.any_orthonormal_vector());
        [tangent, normal.cross(tangent), normal]
    }
}
