//! The density of pbrt-v4's "cloud" (Pharr, Jakob & Humphreys 2023, section 11.4.5, after Schpok et al. 2003): five octaves
//! of Perlin's noise at a place that noise has moved, thinner with height.
//!
//! Noise is Perlin's of 2002, "Improving noise", with his permutation.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::grids::{Cells, Lattice};
use super::media::Corners;

/// What a cloud looks like.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shape {
    pub density: f64,
    pub wispiness: f64,
    pub frequency: f64,
}

/// Cells along the longest edge of the box: the finest octave has 78 waves a unit at the default frequency of 5.
const LONGEST: f64 = 192.0;

impl Shape {
    /// The density in a box, and one cell beyond it on all sides, so that interpolation is right up to its faces.
    pub(super) fn cells(&self, [min, max]: Corners) -> Cells {
        let edges = max - min;
        let counts = (edges / edges.max_element() * LONGEST).ceil().max(DVec3::splat(2.0));
        let size = edges / counts;
        let [nx, ny, nz] = counts.to_array().map(|count| count as usize + 2);
        let corner = min - size;
        let center =
            |x: usize, y: usize, z: usize| corner + (DVec3::new(x as f64, y as f64, z as f64) + 0.5) * size;
        let plane = |z: usize| -> Vec<f32> {
            (0..ny)
                .flat_map(|y| (0..nx).map(move |x| (x, y)))
                .map(|(x, y)| self.density(center(x, y, z)) as f32)
                .collect()
        };
        let planes: Vec<Vec<f32>> = (0..nz).into_par_iter().map(plane).collect();
        Cells::of(Lattice { cells: [nx, ny, nz], bounds: [corner, max + size] }, planes.concat())
    }

    /// The density at a place.
    pub(super) fn density(&self, place: DVec3) -> f64 {
        let mut moved = self.frequency * place;
        if self.wispiness > 0.0 {
            let (mut strength, mut scale) = (0.05 * self.wispiness, 10.0);
            for _ in 0..2 {
                moved += strength * slope(scale * moved);
                strength *= 0.5;
                scale *= 1.99;
            }
        }
        let (mut sum, mut weight, mut scale) = (0.0, 0.5, 1.0);
        for _ in 0..5 {
            sum += weight * noise(scale * moved);
            weight *= 0.5;
            scale *= 1.99;
        }
        let billows = ((1.0 - place.y) * 4.5 * self.density * sum).clamp(0.0, 1.0);
        (billows + 2.0 * (0.5 - place.y).max(0.0)).clamp(0.0, 1.0)
    }
}

/// Slope of the noise along the axes, by differences over 0.01 as in pbrt.
fn slope(place: DVec3) -> DVec3 {
    const STEP: f64 = 0.01;
    let here = noise(place);
    let along = |axis: DVec3| (noise(place + STEP * axis) - here) / STEP;
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

/// Perlin's noise, from about −1 to 1 and 0 at whole numbers.
fn noise(place: DVec3) -> f64 {
    // Numbers that large are whole.
    if place.abs().max_element() >= 1e9 || place.is_nan() {
        return 0.0;
    }
    let cell = place.floor();
    let offset = place - cell;
    let cell = cell.as_ivec3();
    let weight = offset * offset * offset * (offset * (offset * 6.0 - 15.0) + 10.0);
    let lerp = |t: f64, a: f64, b: f64| a + (b - a) * t;
    let corner = |x: i32, y: i32, z: i32| {
        let by = IVec3::new(x, y, z);
        gradient(cell + by, offset - by.as_dvec3())
    };
    let edge = |y: i32, z: i32| lerp(weight.x, corner(0, y, z), corner(1, y, z));
    let face = |z: i32| lerp(weight.y, edge(0, z), edge(1, z));
    lerp(weight.z, face(0), face(1))
}

/// One of twelve gradients, chosen by the cell, times the offset.
fn gradient(cell: IVec3, offset: DVec3) -> f64 {
    let permute = |index: i32| i32::from(PERMUTATION[(index & 255) as usize]);
    let hash = permute(permute(permute(cell.x) + (cell.y & 255)) + (cell.z & 255)) & 15;
    let u = if hash < 8 || hash == 12 || hash == 13 { offset.x } else { offset.y };
    let v = if hash < 4 || hash == 12 || hash == 13 { offset.y } else { offset.z };
    let signed = |value: f64, bit: i32| if hash & bit == 0 { value } else { -value };
    signed(u, 1) + signed(v, 2)
}

/// Perlin's permutation of 0 to 255.
#[rustfmt::skip]
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225,
    140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122,
    60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241,
    81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_permutation_is_one() {
        let mut sorted = PERMUTATION;
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(index, &value)| index == usize::from(value)));
    }

    #[test]
    fn noise_is_perlins() {
        // 0 at whole numbers; at (3.14, 42, 7) the reference implementation of 2002 prints 0.13691995878400012.
        assert_eq!(noise(DVec3::new(3.0, -4.0, 5.0)), 0.0);
        assert!((noise(DVec3::new(3.14, 42.0, 7.0)) - 0.13691995878400012).abs() < 1e-12);
    }

    #[test]
    fn clouds_are_dense_below_and_gone_above() {
        let shape = Shape { density: 1.0, wispiness: 1.0, frequency: 5.0 };
        assert_eq!(shape.density(DVec3::new(0.3, -0.1, 0.2)), 1.0);
        assert_eq!(shape.density(DVec3::new(0.3, 1.0, 0.2)), 0.0);
        let cells = Shape { density: 1.0, ..shape }.cells([DVec3::ZERO, DVec3::new(1.0, 0.02, 0.01)]);
        assert_eq!(cells.lattice.cells, [194, 6, 4]);
    }
}
