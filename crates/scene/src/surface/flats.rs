//! All squares and planes of a scene, met by a ray side by side.
//!
//! A flat shape is the part z = 0 of its local coordinates, for a square with x and y in [0, 1]. The rows of the maps stand
//! in arrays, [`GROUP`] shapes together, so that the arithmetic of one is that of all and becomes vector code; it is the
//! arithmetic of a single square, to the bit. Rooms are made of a few such shapes, and for those this takes a fraction of
//! the time of a tree with a shape a leaf. Many rays are met by one shape after the other instead, rays side by side, with
//! the same arithmetic again.

use glam::DAffine3;

use super::Meeting;
use super::local::LocalHit;
use super::side_by_side::{LANES, RayGroup};
use crate::Ray;

/// Shapes side by side.
const GROUP: usize = 4;

/// More squares than this are left to the tree.
pub(super) const MOST: usize = 32;

/// The flat shapes.
#[derive(Debug, Clone, Default)]
pub(super) struct Flats {
    groups: Vec<Group>,
}

#[derive(Debug, Clone)]
struct Group {
    /// Columns of the maps to local coordinates, the translation last; by component, then by shape.
    columns: [[[f64; GROUP]; 3]; 4],
    /// Greatest distance of x and y from 1/2: 1/2 for a square, infinite for a plane.
    reach: [f64; GROUP],
    /// Number of the shape.
    shape: [usize; GROUP],
}

impl Flats {
    /// Adds the shape of this number.
    pub fn add(&mut self, shape: usize, to_local: &DAffine3, is_plane: bool) {
        let full = |group: &Group| group.shape[GROUP - 1] != usize::MAX;
        if self.groups.last().is_none_or(full) {
            self.groups.push(Group::EMPTY);
        }
        let Some(group) = self.groups.last_mut() else { return };
        let lane = group.shape.iter().position(|&number| number == usize::MAX).unwrap_or(0);
        for (column, values) in group.columns.iter_mut().zip(to_local.to_cols_array_2d()) {
            for (component, value) in column.iter_mut().zip(values) {
                component[lane] = value;
            }
        }
        group.reach[lane] = if is_plane { f64::INFINITY } else { 0.5 };
        group.shape[lane] = shape;
    }

    /// The shape that `ray` meets first before `end`, and where.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, end: f64) -> Option<Meeting> {
        let (mut nearest, mut shape, mut enters) = (end, usize::MAX, false);
        for group in &self.groups {
            let (t, down) = group.distances(ray);
            for lane in 0..GROUP {
                let is_nearer = t[lane] < nearest;
                nearest = if is_nearer { t[lane] } else { nearest };
                shape = if is_nearer { group.shape[lane] } else { shape };
                enters = if is_nearer { down[lane] < 0.0 } else { enters };
            }
        }
        (shape != usize::MAX).then(|| Meeting { shape, hit: LocalHit::new(nearest, 0, enters) })
    }

    /// The shape that each of some rays meets first before its end, and where.
    #[inline(always)]
    pub fn intersect_all(&self, rays: &RayGroup) -> [Option<Meeting>; LANES] {
        let mut nearest = rays.end;
        let (mut shape, mut down) = ([u64::MAX; LANES], [0.0; LANES]);
        for group in &self.groups {
            for lane in 0..group.count() {
                let (t, along_z) = group.distances_of(lane, rays);
                let number = group.shape[lane] as u64;
                for k in 0..LANES {
                    let is_nearer = t[k] < nearest[k];
                    nearest[k] = if is_nearer { t[k] } else { nearest[k] };
                    shape[k] = if is_nearer { number } else { shape[k] };
                    down[k] = if is_nearer { along_z[k] } else { down[k] };
                }
            }
        }
        let mut meetings = [None; LANES];
        for k in 0..LANES {
            if shape[k] != u64::MAX {
                let hit = LocalHit::new(nearest[k], 0, down[k] < 0.0);
                meetings[k] = Some(Meeting { shape: shape[k] as usize, hit });
            }
        }
        meetings
    }

    /// Whether each of some rays meets any of them before its end.
    #[inline(always)]
    pub fn stand_in_all(&self, rays: &RayGroup) -> [bool; LANES] {
        let mut nearest = [f64::INFINITY; LANES];
        for group in &self.groups {
            for lane in 0..group.count() {
                let (t, _) = group.distances_of(lane, rays);
                for k in 0..LANES {
                    nearest[k] = if t[k] < nearest[k] { t[k] } else { nearest[k] };
                }
            }
        }
        let mut met = [false; LANES];
        for k in 0..LANES {
            met[k] = nearest[k] < rays.end[k];
        }
        met
    }

    /// Whether `ray` meets any of them before `end`.
    #[inline(always)]
    pub fn stand_in(&self, ray: &Ray, end: f64) -> bool {
        // A loop of its own: inside `any` the arithmetic would be compiled apart from its caller, for the least processor.
        for group in &self.groups {
            let (t, _) = group.distances(ray);
            if t.iter().fold(false, |is_met, &t| is_met | (t < end)) {
                return true;
            }
        }
        false
    }
}

impl Group {
    /// Shapes that no ray meets.
    const EMPTY: Self =
        Self { columns: [[[0.0; GROUP]; 3]; 4], reach: [-1.0; GROUP], shape: [usize::MAX; GROUP] };

    /// Distance to each shape, infinite where the ray misses it, and the third component of the ray's local direction.
    #[inline(always)]
    fn distances(&self, ray: &Ray) -> ([f64; GROUP], [f64; GROUP]) {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin.to_array(), ray.direction.to_array());
        let [along_x, along_y, along_z, offset] = &self.columns;
        let mut origin = [[0.0; GROUP]; 3];
        let mut direction = [[0.0; GROUP]; 3];
        for axis in 0..3 {
            for lane in 0..GROUP {
                let (x, y, z) = (along_x[axis][lane], along_y[axis][lane], along_z[axis][lane]);
                origin[axis][lane] = x * ox + y * oy + z * oz + offset[axis][lane];
                direction[axis][lane] = x * dx + y * dy + z * dz;
            }
        }
        let mut distance = [0.0; GROUP];
        for lane in 0..GROUP {
            let t = -origin[2][lane] / direction[2][lane];
            let x = origin[0][lane] + direction[0][lane] * t;
            let y = origin[1][lane] + direction[1][lane] * t;
            let reach = self.reach[lane];
            // x ≥ 0 is kept from rounding: the comparison is that of x itself, not of x − 1/2.
            let (least, most) = (0.5 - reach, 0.5 + reach);
            let is_met = (t > 0.0) & (x >= least) & (x <= most) & (y >= least) & (y <= most);
            distance[lane] = if is_met { t } else { f64::INFINITY };
        }
        (distance, direction[2])
    }

    /// How many shapes it has.
    #[inline(always)]
    fn count(&self) -> usize {
        let mut count = GROUP;
        while count > 0 && self.shape[count - 1] == usize::MAX {
            count -= 1;
        }
        count
    }

    /// [`distances`](Self::distances) of one shape to some rays.
    #[inline(always)]
    fn distances_of(&self, lane: usize, rays: &RayGroup) -> ([f64; LANES], [f64; LANES]) {
        let ([ox, oy, oz], [dx, dy, dz]) = (&rays.origin, &rays.direction);
        let [along_x, along_y, along_z, offset] = &self.columns;
        let mut origin = [[0.0; LANES]; 3];
        let mut direction = [[0.0; LANES]; 3];
        for axis in 0..3 {
            let (x, y, z) = (along_x[axis][lane], along_y[axis][lane], along_z[axis][lane]);
            for k in 0..LANES {
                origin[axis][k] = x * ox[k] + y * oy[k] + z * oz[k] + offset[axis][lane];
                direction[axis][k] = x * dx[k] + y * dy[k] + z * dz[k];
            }
        }
        let (least, most) = (0.5 - self.reach[lane], 0.5 + self.reach[lane]);
        let mut distance = [0.0; LANES];
        for k in 0..LANES {
            let t = -origin[2][k] / direction[2][k];
            let x = origin[0][k] + direction[0][k] * t;
            let y = origin[1][k] + direction[1][k] * t;
            // As above.
            let is_met = (t > 0.0) & (x >= least) & (x <= most) & (y >= least) & (y <= most);
            distance[k] = if is_met { t } else { f64::INFINITY };
        }
        (distance, direction[2])
    }
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat, DVec3};
    use tyndall_lanes::Random;

    use super::super::placed::{Geometry, Placed};
    use super::*;

    #[test]
    fn rays_meet_the_same_shapes_at_the_same_distances_as_one_by_one() {
        let mut random = Random::new(5, 0, 0);
        let mut vector = || DVec3::from_array(std::array::from_fn(|_| 4.0 * (random.f64() - 0.5)));
        let placed: Vec<Placed> = (0..7)
            .map(|number| {
                let turn = DQuat::from_scaled_axis(vector());
                let map = DMat3::from_quat(turn) * DMat3::from_diagonal(vector() + 2.5);
                let geometry = if number == 2 { Geometry::Plane } else { Geometry::Square };
                Placed::new(geometry, DAffine3::from_mat3_translation(map, vector()), false).unwrap()
            })
            .collect();
        let mut flats = Flats::default();
        for (number, placed) in placed.iter().enumerate() {
            flats.add(number, placed.to_local(), matches!(placed.geometry, Geometry::Plane));
        }
        let mut met = 0;
        let mut side_by_side = (RayGroup::default(), Vec::new());
        for _ in 0..20_000 {
            let ray = Ray { origin: vector(), direction: vector().normalize() };
            let end = 1.5;
            let hits = placed.iter().enumerate().filter_map(|(n, one)| Some((n, one.intersect(&ray, end)?)));
            let expected = hits.min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t));
            met += usize::from(expected.is_some());
            assert_eq!(flats.intersect(&ray, end), expected.map(|(shape, hit)| Meeting { shape, hit }));
            assert_eq!(flats.stand_in(&ray, end), expected.is_some());
            let (rays, one_by_one) = &mut side_by_side;
            rays.set(one_by_one.len(), &ray, end);
            one_by_one.push(expected.map(|(shape, hit)| Meeting { shape, hit }));
            if one_by_one.len() == LANES {
                assert_eq!(flats.intersect_all(rays)[..], one_by_one[..]);
                for (stands, met) in flats.stand_in_all(rays).iter().zip(one_by_one) {
                    assert_eq!(*stands, met.is_some());
                }
                side_by_side = Default::default();
            }
        }
        assert!((1_000..19_000).contains(&met), "{met}");
    }
}
