//! Which volumes are present at a place, where shapes bound them.
//!
//! Every volume that some shape bounds has a count: crossing the shape inwards adds 1 for the volumes of its interior and
//! takes 1 from those of its exterior; outwards it is the other way round. The volume is present where its count is
//! above 0. Far away the count is 0 for volumes that are the interior of some shape, and 1 for those that only end at
//! shapes. So shapes that overlap unite, and nested ones take their turns, whatever the order in which a ray meets them.

use glam::DVec3;

use super::{Hit, Surfaces};
use crate::Ray;

/// The volumes of a scene that shapes bound.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Boundaries {
    /// For each volume its place among the bounded ones.
    slots: Vec<Option<usize>>,
    /// Counts far away.
    far_away: Presence,
}

/// The counts of the bounded volumes at a place.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Presence(Vec<i32>);

impl Boundaries {
    /// Those of `volumes` volumes among `surfaces`.
    pub fn new(surfaces: &Surfaces, volumes: usize) -> Self {
        let crossed =
            || surfaces.shapes.iter().filter(|shape| !surfaces.materials[shape.material].is_opaque());
        let is_in = |volume: usize| crossed().any(|shape| shape.interior.contains(&volume));
        let is_out = |volume: usize| crossed().any(|shape| shape.exterior.contains(&volume));
        let mut boundaries = Self::default();
        for volume in 0..volumes {
            let slot = (is_in(volume) || is_out(volume)).then(|| {
                boundaries.far_away.0.push(i32::from(!is_in(volume)));
                boundaries.far_away.0.len() - 1
            });
            boundaries.slots.push(slot);
        }
        boundaries
    }

    /// Whether shapes bound no volume at all.
    pub fn is_empty(&self) -> bool {
        self.far_away.0.is_empty()
    }

    /// Whether the volume of this number is present.
    pub fn is_present(&self, volume: usize, presence: &Presence) -> bool {
        match self.slots.get(volume) {
            Some(Some(slot)) => presence.0[*slot] > 0,
            _ => true,
        }
    }

    /// Whether the volume of this number is there only between shapes.
    pub fn bound(&self, volume: usize) -> bool {
        matches!(self.slots.get(volume), Some(Some(_)))
    }

    /// The counts when exactly these volumes are present.
    pub fn inside(&self, volumes: &[usize]) -> Presence {
        let mut presence = Presence(vec![0; self.far_away.0.len()]);
        for slot in volumes.iter().filter_map(|volume| self.slots.get(*volume).copied().flatten()) {
            presence.0[slot] = 1;
        }
        presence
    }

    /// The counts at `place`, by all crossings between there and far away in an arbitrary direction.
    pub fn presence_at(&self, place: DVec3, surfaces: &Surfaces) -> Presence {
        let mut presence = self.far_away.clone();
        if self.is_empty() {
            return presence;
        }
        // Away from the axes and diagonals along which people build.
        let direction = DVec3::new(0.273_18, 0.861_27, 0.428_49).normalize();
        let mut origin = place;
        while let Some(hit) = surfaces.intersect(&Ray { origin, direction }, f64::INFINITY) {
            self.cross(&mut presence, surfaces, &hit, -direction);
            origin = hit.leave(direction);
        }
        presence
    }

    /// The counts after going through the surface at `hit` in `direction`.
    pub fn cross(&self, presence: &mut Presence, surfaces: &Surfaces, hit: &Hit, direction: DVec3) {
        let shape = surfaces.shape(hit);
        if self.is_empty() || surfaces.materials[shape.material].is_opaque() {
            return;
        }
        let inwards = if direction.dot(hit.normal) < 0.0 { 1 } else { -1 };
        for (volumes, step) in [(&shape.interior, inwards), (&shape.exterior, -inwards)] {
            for slot in volumes.iter().filter_map(|volume| self.slots.get(*volume).copied().flatten()) {
                presence.0[slot] += step;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Material, Shape};
    use super::*;

    fn shape(interior: &[usize], exterior: &[usize]) -> Shape {
        Shape {
            name: String::new(),
            material: 0,
            interior: interior.to_vec(),
            exterior: exterior.to_vec(),
            light: None,
            id: 1,
            is_shadow_catcher: false,
        }
    }

    fn hit(shape: usize) -> Hit {
        Hit {
            t: 1.0,
            position: DVec3::ZERO,
            normal: DVec3::Y,
            shading_normal: DVec3::Y,
            tangent: DVec3::X,
            uv: [0.0; 2],
            shape,
            primitive: 0,
            offset: 1e-10,
        }
    }

    #[test]
    fn a_volume_is_present_between_the_shapes_that_bound_it() {
        let surfaces = Surfaces {
            shapes: vec![shape(&[1], &[]), shape(&[1], &[]), shape(&[2], &[1, 0])],
            materials: vec![Material::Null],
            ..Surfaces::default()
        };
        let boundaries = Boundaries::new(&surfaces, 4);
        let present =
            |presence: &Presence| (0..4).map(|v| boundaries.is_present(v, presence)).collect::<Vec<_>>();
        let mut presence = boundaries.inside(&[0]);
        // Only ended: there far away; bounded by none: everywhere.
        assert_eq!(present(&presence), [true, false, false, true]);
        let mut cross = |shape: usize, direction: DVec3| {
            boundaries.cross(&mut presence, &surfaces, &hit(shape), direction);
            present(&presence)
        };
        assert_eq!(cross(0, DVec3::NEG_Y), [true, true, false, true]);
        assert_eq!(cross(1, DVec3::NEG_Y), [true, true, false, true], "two shapes unite");
        assert_eq!(cross(0, DVec3::Y), [true, true, false, true]);
        assert_eq!(cross(2, DVec3::NEG_Y), [false, false, true, true], "what is inside takes the place");
        assert_eq!(cross(1, DVec3::Y), [false, false, true, true]);
        assert_eq!(cross(2, DVec3::Y), [true, false, false, true]);
    }
}
