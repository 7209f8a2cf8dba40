//! What is in a scene, counted: shapes, triangles, materials, lights, volumes bounded by shapes, and the box around all.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde::Serialize;
use tyndall_scene::description::MaterialChoice;
use tyndall_scene::{Scene, SceneDescription, Volume};

use super::table::{count, number, triple};

/// What is told about a scene as a whole.
#[derive(Debug, Serialize)]
pub struct Contents {
    /// Shapes that are described.
    shapes: usize,
    /// Shapes that stand in the scene, every instance counted.
    placed_shapes: usize,
    /// Triangles of their meshes, those of every instance counted.
    triangles: u64,
    /// Numbers of materials by type.
    materials: BTreeMap<String, usize>,
    /// Numbers of lights by type; shapes that shine are of the type `shape`, media that glow of the type `medium`.
    lights: BTreeMap<String, usize>,
    /// Volumes that are only inside shapes.
    bounded_volumes: BTreeSet<String>,
    /// Least and greatest corner of the box around shapes and volumes that have an end, in scene units.
    world_box: Option<[[f64; 3]; 2]>,
}

impl Contents {
    /// Counts.
    pub fn new(description: &SceneDescription, scene: &Scene) -> Self {
        let surfaces = &scene.surfaces;
        let here = description.shapes.iter().filter_map(|shape| match &shape.material {
            Some(MaterialChoice::Here(material)) => Some(kind(material)),
            _ => None,
        });
        let named = description.materials.iter().map(|named| kind(&named.material));
        let shining =
            surfaces.shapes.iter().filter(|shape| shape.light.is_some()).map(|_| "shape".to_owned());
        let glowing = scene.volumes.iter().filter(|volume| volume.glows()).map(|_| "medium".to_owned());
        let bounded = surfaces.shapes.iter().flat_map(|shape| &shape.interior);
        Self {
            shapes: description.shapes.len(),
            placed_shapes: surfaces.shapes.len(),
            triangles: surfaces.triangle_count(),
            materials: tally(named.chain(here)),
            lights: tally(description.lights.iter().map(kind).chain(shining).chain(glowing)),
            bounded_volumes: bounded
                .filter_map(|&number| Some(scene.volumes.get(number)?.name.clone()))
                .collect(),
            world_box: world_box(scene),
        }
    }

    /// Keys and values for people.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let mut rows = Vec::new();
        if self.shapes > 0 {
            let instances = match self.placed_shapes {
                placed if placed == self.shapes => String::new(),
                placed => format!(", {placed} with instances"),
            };
            rows.push(("shapes", format!("{}{instances}, {} triangles", self.shapes, self.triangles)));
        }
        for (key, kinds) in [("materials", &self.materials), ("lights", &self.lights)] {
            if !kinds.is_empty() {
                let kinds: Vec<String> =
                    kinds.iter().map(|(kind, number)| format!("{number} {kind}")).collect();
                rows.push((key, kinds.join(", ")));
            }
        }
        if !self.bounded_volumes.is_empty() {
            let names: Vec<String> = self.bounded_volumes.iter().map(|name| format!("`{name}`")).collect();
            rows.push(("inside shapes", format!("{}: {}", count(names.len(), "volume"), names.join(", "))));
        }
        if let Some(corners) = self.world_box {
            let [min, max] = corners.map(|corner| triple(corner.map(number)));
            rows.push(("box of everything", format!("{min} to {max}")));
        }
        rows
    }
}

/// The `type` that a scene file gives it.
fn kind(table: &impl Serialize) -> String {
    let kind =
        serde_json::to_value(table).ok().and_then(|table| Some(table.get("type")?.as_str()?.to_owned()));
    kind.unwrap_or_default()
}

fn tally(kinds: impl Iterator<Item = String>) -> BTreeMap<String, usize> {
    let mut tally = BTreeMap::new();
    kinds.for_each(|kind| *tally.entry(kind).or_insert(0) += 1);
    tally
}

fn world_box(scene: &Scene) -> Option<[[f64; 3]; 2]> {
    let is_finite = |corners: &[DVec3; 2]| corners.iter().all(|corner| corner.is_finite());
    let volumes = scene.volumes.iter().filter_map(Volume::world_box).filter(is_finite);
    let all = volumes.chain(scene.surfaces.bounds());
    let all = all.reduce(|[low, high], [min, max]| [low.min(min), high.max(max)])?;
    Some(all.map(|corner| corner.to_array()))
}
