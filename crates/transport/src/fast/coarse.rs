//! Tables of something all over the media of a scene, a few voxels apart: rough, small enough for a core's cache, and
//! functions of the scene alone, so that every part of a render has the same ones. They only lead estimators to where it
//! pays, or stand in for what is then corrected; no expected value depends on them.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use tyndall_scene::{Scene, Volume};

/// Number of places in a table, about: 128 KiB, which leave room in a core's cache. Eight times as many know more, and cost
/// scenes A and G more time than that saves.
const PLACES: f64 = (1 << 15) as f64;

/// The places of a table: a lattice over the box around all volumes. Positions are relative to the scene's centre.
#[derive(Clone, Copy)]
pub(super) struct Lattice {
    pub min: Vec3,
    pub max: Vec3,
    /// Places per length.
    pub per_length: f32,
    /// Places along each axis, at least 2; x is the slowest in tables.
    places: [usize; 3],
    /// The last place along each axis, less what keeps a neighbour ahead.
    last: Vec3,
}

impl Lattice {
    /// The places for a scene whose volumes are all somewhere.
    pub fn new(scene: &Scene, centre: DVec3) -> Option<Lattice> {
        let boxes: Option<Vec<[DVec3; 2]>> = scene.volumes.iter().map(Volume::world_box).collect();
        let [min, max] = boxes?.into_iter().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
        let size = max - min;
        let spacing = libm::cbrt(size.element_product() / PLACES).max(size.max_element() * 1e-3);
        if spacing <= 0.0 || !spacing.is_finite() {
            return None;
        }
        let places = (size / spacing).to_array().map(|count| count.ceil() as usize + 1);
        let (min, max) = ((min - centre).as_vec3(), (max - centre).as_vec3());
        let last = Vec3::from_array(places.map(|count| (count - 1) as f32)) * (1.0 - f32::EPSILON);
        Some(Lattice { min, max, per_length: (1.0 / spacing) as f32, places, last })
    }

    /// A table of what `value` is at each place.
    pub fn table(&self, value: impl Fn(Vec3) -> f32 + Sync) -> Vec<f32> {
        let [nx, ny, nz] = self.places;
        let spacing = 1.0 / self.per_length;
        let position = |number: usize| {
            let at = [number / (ny * nz), number / nz % ny, number % nz];
            self.min + Vec3::from_array(at.map(|i| i as f32)) * spacing
        };
        (0..nx * ny * nz).into_par_iter().map(|number| value(position(number))).collect()
    }

    /// Mean of something over a cube around a place, as wide as the places are apart, by eight points.
    pub fn mean_around(&self, position: Vec3, value: impl Fn(Vec3) -> f32) -> f32 {
        let quarter = 0.25 / self.per_length;
        let corner = |bits: u32| {
            Vec3::from_array([0, 1, 2].map(|axis| if bits >> axis & 1 == 1 { quarter } else { -quarter }))
        };
        (0..8).map(|bits| value(position + corner(bits))).sum::<f32>() / 8.0
    }

    /// The mean optical thickness along the rows of places, parallel to all three axes, in which there is anything.
    pub fn mean_thickness(&self, mu_t: &[f32]) -> f32 {
        let [nx, ny, nz] = self.places;
        let row = |start: usize, stride: usize, count: usize| {
            (0..count).map(|i| mu_t[start + i * stride]).sum::<f32>() / self.per_length
        };
        let along_x = (0..ny * nz).map(|start| row(start, ny * nz, nx));
        let along_y = (0..nx * nz).map(|number| row(number / nz * (ny * nz) + number % nz, nz, ny));
        let along_z = (0..nx * ny).map(|number| row(number * nz, 1, nz));
        let rows = along_x.chain(along_y).chain(along_z).filter(|&thickness| thickness > 0.0);
        let (sum, count) = rows.fold((0.0, 0_u32), |(sum, count), thickness| (sum + thickness, count + 1));
        sum / count.max(1) as f32
    }

    /// A table's values mixed trilinearly; outside the box, those at its border.
    #[inline(always)]
    pub fn lookup(&self, table: &[f32], position: Vec3) -> f32 {
        let [_, ny, nz] = self.places;
        let p = self.within(position);
        let i = [p.x as u32, p.y as u32, p.z as u32];
        let f = p - Vec3::new(i[0] as f32, i[1] as f32, i[2] as f32);
        let at = (i[0] as usize * ny + i[1] as usize) * nz + i[2] as usize;
        let near = mixed(&table[at..at + nz + 2], nz, f);
        let far = mixed(&table[at + ny * nz..at + ny * nz + nz + 2], nz, f);
        near + (far - near) * f.x
    }

    /// A table's value at the nearest place.
    #[inline]
    pub fn nearest(&self, table: &[f32], position: Vec3) -> f32 {
        let [_, ny, nz] = self.places;
        let p = self.within(position) + 0.5;
        table[(p.x as usize * ny + p.y as usize) * nz + p.z as usize]
    }

    #[inline(always)]
    fn within(&self, position: Vec3) -> Vec3 {
        ((position - self.min) * self.per_length).max(Vec3::ZERO).min(self.last)
    }
}

/// The first two values of two rows of `length` mixed by their shares along y and z.
#[inline(always)]
fn mixed(rows: &[f32], length: usize, share: Vec3) -> f32 {
    let a = rows[0] + (rows[1] - rows[0]) * share.z;
    let b = rows[length] + (rows[length + 1] - rows[length]) * share.z;
    a + (b - a) * share.y
}
