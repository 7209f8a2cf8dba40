//! `MediumInterface`: from the media on the two sides of surfaces to volumes, and the shapes that bound them.
//!
//! pbrt says which medium a ray is in after each surface; Tyndall counts, for each volume, the surfaces that enter it
//! (`interior`) and leave it (`exterior`). For scenes without contradictions that is the same. Where one box or sphere
//! without a material is all that bounds a medium, it is a box or sphere of that medium, or a grid, and needs no surface.

use std::collections::{HashMap, HashSet};

use glam::{DAffine3, DVec3};
use tyndall_scene::description::{
    BoxShape, MediumDescription, Names, ShapeDescription, SphereShape, VolumeDescription,
};

use super::context::Context;
use super::materials::{Passage, here};
use super::media::{self, Corners, Matter};
use super::place::Place;
use super::shapes::Body;
use super::transforms;
use super::world::{CameraUse, World};
use crate::{ImportError, affine};

/// A surface between two media.
#[derive(Debug)]
pub(super) struct Boundary {
    /// Number of the shape in the list of shapes.
    pub shape: usize,
    /// Names of the media on its sides; empty for none.
    pub inside: String,
    pub outside: String,
    pub passage: Passage,
    /// The body it bounds, unless it stands at several places.
    pub body: Body,
    pub to_world: DAffine3,
    pub place: Place,
}

/// The media of a scene.
#[derive(Debug, Default)]
pub(super) struct Media {
    /// What fills the scene.
    pub medium: Option<MediumDescription>,
    pub volumes: Vec<VolumeDescription>,
    /// The volumes bounded by shapes that the camera is in; `None` if there are no such volumes.
    pub inside: Option<Names>,
}

/// Which surfaces have a medium on which side.
#[derive(Debug, Default)]
struct Use {
    interiors: Vec<usize>,
    exteriors: Vec<usize>,
}

/// Puts the media of a scene where the boundaries say; `shapes` lose those that are no longer needed.
pub(super) fn media(
    world: &World,
    boundaries: &[Boundary],
    camera: &CameraUse,
    shapes: &mut [Option<ShapeDescription>],
    exposure: f64,
    context: &Context,
) -> Result<Media, ImportError> {
    let mut order: Vec<&str> = Vec::new();
    let mut uses: HashMap<&str, Use> = HashMap::new();
    let check = |name: &str, place: &Place| {
        if name.is_empty() || world.media.contains_key(name) {
            return Ok(());
        }
        Err(place.error(format!("there is no medium \"{name}\": make it by `MakeNamedMedium`")))
    };
    check(&camera.medium, &camera.entity.place)?;
    for (number, boundary) in boundaries.iter().enumerate() {
        for (name, is_inside) in [(&boundary.inside, true), (&boundary.outside, false)] {
            check(name, &boundary.place)?;
            if name.is_empty() {
                continue;
            }
            let entry = uses.entry(name).or_insert_with(|| {
                order.push(name);
                Use::default()
            });
            if is_inside { entry.interiors.push(number) } else { entry.exteriors.push(number) }
        }
    }
    if !camera.medium.is_empty() && !uses.contains_key(camera.medium.as_str()) {
        order.push(&camera.medium);
        uses.insert(&camera.medium, Use::default());
    }
    let eye = camera.world_to_camera.inverse().translation;
    let mut builder = Builder { boundaries, shapes, media: Media::default(), names: HashSet::new(), context };
    builder.names.insert("medium".to_owned());
    let mut is_bounded = false;
    let mut camera_names = Vec::new();
    for name in order {
        let medium = &world.media[name];
        let matter = media::matter(name, medium, exposure, context)?;
        let used = &uses[name];
        let is_camera_in = camera.medium == name;
        let wrapper = match (used.interiors.as_slice(), used.exteriors.as_slice()) {
            (&[only], []) => Some(only).filter(|&only| builder.wraps(only, eye, is_camera_in)),
            _ => None,
        };
        let names = match wrapper {
            Some(wrapper) => builder.wrapped(name, matter, medium.to_world, wrapper),
            None if used.interiors.is_empty() => builder.unbounded(name, matter, &medium.entity.place),
            None => {
                let names = builder.bounded(name, matter, used);
                if is_camera_in {
                    camera_names.extend(names.iter().cloned());
                }
                is_bounded = true;
                names
            }
        };
        for &number in &used.exteriors {
            builder.add(number, &names, |shape| &mut shape.exterior);
        }
    }
    is_bounded |= builder.shapes.iter().flatten().any(|shape| shape.interior.is_some());
    builder.media.inside = is_bounded.then_some(Names::Several(camera_names));
    for name in world.media.keys().filter(|name| !uses.contains_key(name.as_str())) {
        let place = &world.media[name].entity.place;
        context.choice(place, format!("the medium \"{name}\" is on no side of a surface and left out"));
    }
    Ok(builder.media)
}

struct Builder<'a> {
    boundaries: &'a [Boundary],
    shapes: &'a mut [Option<ShapeDescription>],
    media: Media,
    /// Names of volumes that are taken.
    names: HashSet<String>,
    context: &'a Context<'a>,
}

impl Builder<'_> {
    /// Whether a surface is nothing but the hull of what is inside, and the camera is where it should be.
    fn wraps(&self, number: usize, eye: DVec3, is_camera_in: bool) -> bool {
        let boundary = &self.boundaries[number];
        let local = boundary.to_world.inverse().transform_point3(eye);
        let is_inside = match boundary.body {
            Body::Box([min, max]) => local.cmpgt(min).all() && local.cmplt(max).all(),
            Body::Sphere(radius) => local.length() < radius,
            Body::Other => return false,
        };
        let is_bare = self.shapes[boundary.shape].as_ref().is_some_and(|shape| shape.emission.is_none());
        boundary.passage == Passage::Free
            && boundary.outside.is_empty()
            && is_bare
            && is_inside == is_camera_in
    }

    /// A medium in one box or sphere.
    fn wrapped(
        &mut self,
        name: &str,
        matter: Matter,
        medium_to_world: DAffine3,
        wrapper: usize,
    ) -> Vec<String> {
        let boundary = &self.boundaries[wrapper];
        match matter {
            Matter::Homogeneous(medium) => {
                let mut volume = VolumeDescription { medium: *medium, ..VolumeDescription::default() };
                match boundary.body {
                    Body::Box(corners) => {
                        (volume.cuboid, volume.transform) = box_at(corners, &boundary.to_world)
                    }
                    Body::Sphere(radius) => match affine::uniform_scale(&boundary.to_world) {
                        Some(scale) => {
                            let center = boundary.to_world.translation.to_array();
                            volume.sphere = Some(SphereShape { center, radius: radius * scale });
                        }
                        None => {
                            volume.sphere = Some(SphereShape { center: [0.0; 3], radius });
                            volume.transform = transforms::description(&boundary.to_world);
                        }
                    },
                    Body::Other => {}
                }
                self.shapes[boundary.shape] = None;
                self.push(name, vec![volume])
            }
            Matter::Grids { volumes, bounds, support } => {
                let to_medium = medium_to_world.inverse() * boundary.to_world;
                let names = self.push(name, volumes);
                let edge = bounds.unwrap_or(media::EVERYWHERE);
                match boundary.body {
                    Body::Box(corners) if affine::keeps_axes(&to_medium) => {
                        let [min, max] = affine::map_box(&to_medium, corners);
                        let kept = [min.max(edge[0]), max.min(edge[1])];
                        if holds(kept, support) {
                            self.shapes[boundary.shape] = None;
                        } else if kept[0].cmplt(kept[1]).all() {
                            self.cut(boundary.shape, kept, &medium_to_world, &names);
                        } else {
                            // The box and the grid do not meet.
                            self.set_interior(wrapper, &names);
                        }
                    }
                    Body::Sphere(radius) => {
                        let is_inside = |[min, max]: Corners| {
                            let corner = |n: usize| {
                                DVec3::select(glam::BVec3::new(n & 1 == 0, n & 2 == 0, n & 4 == 0), min, max)
                            };
                            let to_shape = to_medium.inverse();
                            (0..8).all(|n| to_shape.transform_point3(corner(n)).length() <= radius)
                        };
                        match bounds {
                            _ if is_inside(support) && holds(edge, support) => {
                                self.shapes[boundary.shape] = None
                            }
                            Some(bounds) if is_inside(bounds) => {
                                self.cut(boundary.shape, bounds, &medium_to_world, &names);
                            }
                            _ => self.set_interior(wrapper, &names),
                        }
                    }
                    _ => self.set_interior(wrapper, &names),
                }
                names
            }
        }
    }

    /// Puts a box of the medium's space in the place of a shape, as the boundary of volumes.
    fn cut(&mut self, shape: usize, corners: Corners, medium_to_world: &DAffine3, names: &[String]) {
        let (cuboid, transform) = box_at(corners, medium_to_world);
        self.shapes[shape] = Some(ShapeDescription {
            cuboid,
            transform,
            material: Some(here(tyndall_scene::description::MaterialDescription::Null)),
            interior: Names::some(names.to_vec()),
            ..ShapeDescription::default()
        });
    }

    fn set_interior(&mut self, boundary: usize, names: &[String]) {
        self.add(boundary, names, |shape| &mut shape.interior);
    }

    /// A medium that begins or ends at surfaces of any kind.
    fn bounded(&mut self, name: &str, matter: Matter, used: &Use) -> Vec<String> {
        let volumes = match matter {
            Matter::Homogeneous(medium) => {
                vec![VolumeDescription { medium: *medium, ..VolumeDescription::default() }]
            }
            Matter::Grids { volumes, bounds, support } => {
                if bounds.is_some_and(|bounds| !holds(bounds, support)) {
                    let message = format!(
                        "the grid of the medium \"{name}\" falls to 0 over half a cell beyond its box, not at its faces"
                    );
                    self.context.choice(&self.boundaries[used.interiors[0]].place, message);
                }
                volumes
            }
        };
        let names = self.push(name, volumes);
        for &number in &used.interiors {
            self.set_interior(number, &names);
        }
        names
    }

    /// A medium around everything that is seen.
    fn unbounded(&mut self, name: &str, matter: Matter, place: &Place) -> Vec<String> {
        match matter {
            Matter::Homogeneous(medium) if self.media.medium.is_none() => {
                self.media.medium = Some(*medium);
                vec!["medium".to_owned()]
            }
            Matter::Homogeneous(_) => {
                let message = format!("the medium \"{name}\" has no end, as another has: it is left out");
                self.context.unsupported(place, message);
                Vec::new()
            }
            Matter::Grids { volumes, .. } => self.push(name, volumes),
        }
    }

    /// Adds volumes under names of their own.
    fn push(&mut self, name: &str, volumes: Vec<VolumeDescription>) -> Vec<String> {
        let mut names = Vec::new();
        for volume in volumes {
            let mut candidate = name.to_owned();
            let mut number = 1;
            while !self.names.insert(candidate.clone()) {
                number += 1;
                candidate = format!("{name} {number}");
            }
            names.push(candidate.clone());
            self.media.volumes.push(VolumeDescription { name: Some(candidate), ..volume });
        }
        names
    }

    fn add(
        &mut self,
        boundary: usize,
        names: &[String],
        side: impl Fn(&mut ShapeDescription) -> &mut Option<Names>,
    ) {
        let Some(shape) = self.shapes[self.boundaries[boundary].shape].as_mut().filter(|_| !names.is_empty())
        else {
            return;
        };
        *side(shape) = Names::some(names.to_vec());
    }
}

fn holds([min, max]: Corners, [least, greatest]: Corners) -> bool {
    min.cmple(least).all() && max.cmpge(greatest).all()
}

/// A box at its place: in the world if it stays along the axes there, else with the transform.
fn box_at(
    corners: Corners,
    to_world: &DAffine3,
) -> (Option<BoxShape>, Option<tyndall_scene::description::TransformDescription>) {
    let keeps_axes = affine::keeps_axes(to_world);
    let [min, max] = if keeps_axes { affine::map_box(to_world, corners) } else { corners };
    let transform = if keeps_axes { None } else { transforms::description(to_world) };
    (Some(BoxShape { min: min.to_array(), max: max.to_array() }), transform)
}
