//! A fair-weather cumulus: billows upon billows over a flat base.
//!
//! Convection makes a cumulus a heap of bubbles, each with smaller bubbles on it. So does this: a few large spheres
//! in a heap; on each, smaller ones, three times over; the field is the depth below the nearest sphere's surface,
//! its surface is frayed by noise, and everything under the condensation level is cut away. Density rises from 0 to
//! 1 within a thin skin, as the crisp edge of a cumulus does.
//!
//! Positions are in the unit cube; y is up.

use glam::{DAffine3, DVec3, UVec3, Vec3};
use rayon::prelude::*;
use tyndall_lanes::Random;
use tyndall_machine::memory::{MemoryError, ask_for};
use tyndall_volumes::{Grid, GridClass, GridValues, LEAF_VOXELS, Leaf, Tree};

use super::noise::fractal_noise;

/// Height of the flat base.
const BASE: f32 = 0.26;
/// Depth over which density rises from 0 to 1.
const SKIN: f32 = 0.018;
/// How far noise moves the surface.
const FRAY: f32 = 0.035;
/// Generations of bubbles on bubbles.
const GENERATIONS: u32 = 3;

/// Memory of a leaf.
const LEAF_BYTES: usize = size_of::<(Leaf, [f32; LEAF_VOXELS])>();

/// A cumulus as a grid named `density` of `resolution`³ voxels in a cube of edge `size` about `center`; only leaves
/// with some cloud in them are kept. The same arguments give the same cloud.
///
/// # Errors
/// If there is no memory for it.
pub fn cumulus(seed: u32, resolution: u32, center: DVec3, size: f64) -> Result<Grid, MemoryError> {
    let spheres = heap_of_spheres(seed);
    let leaves_along = resolution.div_ceil(8);
    let mut tree = Tree { background: 0.0, tiles: Vec::new(), leaves: Vec::new(), leaf_values: Vec::new() };
    let slabs: Vec<_> = (0..leaves_along)
        .into_par_iter()
        .map(|x| {
            // How much of a slab is cloud shows when it is there.
            let leaves = leaves_along as usize * leaves_along as usize;
            ask_for(leaves, LEAF_BYTES, || {
                format!("the {leaves} leaves of a slab of {resolution}\u{b3} voxels")
            })?;
            Ok(slab_of_leaves(&spheres, x, leaves_along, resolution, seed))
        })
        .collect::<Result<_, MemoryError>>()?;
    let leaves: usize = slabs.iter().map(Vec::len).sum();
    ask_for(leaves, LEAF_BYTES, || format!("{leaves} leaves of 512 voxels of 4 bytes"))?;
    tree.leaf_values.reserve_exact(leaves * LEAF_VOXELS);
    for slab in slabs {
        for (leaf, values) in slab {
            tree.leaves.push(leaf);
            tree.leaf_values.extend(values);
        }
    }
    let voxel = size / f64::from(resolution);
    let corner = center - DVec3::splat(0.5 * size - 0.5 * voxel);
    Ok(Grid {
        name: "density".into(),
        class: GridClass::FogVolume,
        index_to_world: DAffine3::from_scale_rotation_translation(
            DVec3::splat(voxel),
            glam::DQuat::IDENTITY,
            corner,
        ),
        saved_as_half: false,
        codec: "computed".into(),
        metadata: Vec::new(),
        values: GridValues::Float(tree),
    })
}

#[derive(Clone, Copy)]
struct Sphere {
    centre: Vec3,
    radius: f32,
}

/// The bubbles, large ones first.
fn heap_of_spheres(seed: u32) -> Vec<Sphere> {
    let mut random = Random::new(u64::from(seed), 0, 0);
    let mut spheres = Vec::new();
    // The heap: a row of domes whose heights fall off from the middle.
    for i in 0..14 {
        let angle = i as f32 * 2.399_963;
        let reach = (i as f32 / 14.0).sqrt();
        let jitter = Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5;
        let radius = (0.17 - 0.085 * reach) * (0.8 + 0.4 * random.f32());
        let height = 0.22 * (1.0 - reach * reach) * (0.6 + 0.8 * random.f32());
        let centre = Vec3::new(
            0.5 + 0.29 * reach * libm::cosf(angle),
            BASE + 0.06 + height,
            0.5 + 0.22 * reach * libm::sinf(angle),
        );
        spheres.push(Sphere { centre: centre + jitter * 0.05, radius });
    }
    let mut first = 0;
    for _ in 0..GENERATIONS {
        let last = spheres.len();
        for parent in first..last {
            let Sphere { centre, radius } = spheres[parent];
            for _ in 0..11 {
                let toward = upward_direction(&mut random);
                let child = radius * (0.3 + 0.28 * random.f32());
                spheres.push(Sphere { centre: centre + toward * (radius * 0.92), radius: child });
            }
        }
        first = last;
    }
    spheres
}

/// A random direction, more often up than down: bubbles rise.
fn upward_direction(random: &mut Random) -> Vec3 {
    let y = 1.0 - 1.6 * libm::powf(random.f32(), 1.3);
    let (sin, cos) = tyndall_lanes::sin_cos_turns(random.f32());
    let across = (1.0 - y * y).max(0.0).sqrt();
    Vec3::new(across * cos, y, across * sin)
}

/// All leaves of the cube with x-coordinate `x` (in leaves) that have cloud in them.
fn slab_of_leaves(
    spheres: &[Sphere],
    x: u32,
    leaves_along: u32,
    resolution: u32,
    seed: u32,
) -> Vec<(Leaf, [f32; LEAF_VOXELS])> {
    let leaf_edge = 8.0 / resolution as f32;
    let half_diagonal = 0.87 * leaf_edge;
    let reach = half_diagonal + 1.5 * FRAY;
    let near = |s: &&Sphere, axis: usize, middle: f32| (s.centre[axis] - middle).abs() < s.radius + reach;
    let middle = |i: u32| (i as f32 + 0.5) * leaf_edge;
    let in_slab: Vec<Sphere> = spheres.iter().filter(|s| near(s, 0, middle(x))).copied().collect();
    let mut leaves = Vec::new();
    for y in (0..leaves_along).filter(|&y| middle(y) > BASE - reach) {
        let in_row: Vec<Sphere> = in_slab.iter().filter(|s| near(s, 1, middle(y))).copied().collect();
        for z in 0..leaves_along {
            let centre = Vec3::new(middle(x), middle(y), middle(z));
            let depth = |s: &Sphere| s.radius - s.centre.distance(centre);
            let greatest = in_row.iter().map(depth).fold(f32::NEG_INFINITY, f32::max);
            if greatest < -reach {
                continue;
            }
            // Any other sphere is nowhere in the leaf the one whose surface is farthest above.
            let decisive = |s: &&Sphere| depth(s) >= greatest - 2.0 * half_diagonal;
            let here: Vec<Sphere> = in_row.iter().filter(decisive).copied().collect();
            if let Some(values) = leaf_values(&here, UVec3::new(x, y, z) * 8, resolution, seed) {
                let origin = [x, y, z].map(|i| 8 * i as i32);
                leaves.push((Leaf { origin, active: active_mask(&values) }, values));
            }
        }
    }
    leaves
}

/// Densities of a leaf whose least voxel is `first`; `None` if all are 0.
fn leaf_values(spheres: &[Sphere], first: UVec3, resolution: u32, seed: u32) -> Option<[f32; LEAF_VOXELS]> {
    let mut values = [0.0; LEAF_VOXELS];
    let mut any = false;
    for (i, value) in values.iter_mut().enumerate() {
        let i = i as u32;
        let voxel = first + UVec3::new(i >> 6, i >> 3 & 7, i & 7);
        if voxel.max_element() >= resolution {
            continue;
        }
        let p = (voxel.as_vec3() + 0.5) / resolution as f32;
        *value = density(spheres, p, seed);
        any |= *value > 0.0;
    }
    any.then_some(values)
}

fn density(spheres: &[Sphere], p: Vec3, seed: u32) -> f32 {
    let mut depth = spheres.iter().fold(f32::NEG_INFINITY, |d, s| d.max(s.radius - s.centre.distance(p)));
    if depth < -1.5 * FRAY {
        return 0.0;
    }
    // Deep inside nothing that noise does can be seen.
    if depth < 3.0 * FRAY + SKIN {
        depth += FRAY * fractal_noise(p * 26.0, 4, seed) - 0.2 * FRAY;
    }
    let above_base = p.y - BASE + 0.02 * fractal_noise(p * 9.0, 3, seed ^ 0x5bd1);
    let depth = depth.min(above_base * 0.6);
    let skin = (depth / SKIN).clamp(0.0, 1.0);
    skin * skin * (3.0 - 2.0 * skin)
}

fn active_mask(values: &[f32; LEAF_VOXELS]) -> [u64; 8] {
    std::array::from_fn(|x| {
        let row = &values[x * 64..x * 64 + 64];
        row.iter().enumerate().fold(0, |mask, (bit, &value)| mask | u64::from(value > 0.0) << bit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(grid: &Grid) -> &Tree<f32> {
        match &grid.values {
            GridValues::Float(tree) => tree,
            other => panic!("a float grid was expected, not {other:?}"),
        }
    }

    #[test]
    fn a_cloud_is_the_same_each_time_and_another_for_another_seed() {
        let a = cumulus(1, 48, DVec3::ZERO, 2.0).unwrap();
        assert_eq!(tree(&a), tree(&cumulus(1, 48, DVec3::ZERO, 2.0).unwrap()));
        assert_ne!(tree(&a), tree(&cumulus(2, 48, DVec3::ZERO, 2.0).unwrap()));
    }

    #[test]
    fn a_cloud_keeps_clear_of_its_cube_and_fills_a_fair_part_of_it() {
        for seed in 0..3 {
            let grid = cumulus(seed, 64, DVec3::ZERO, 1.0).unwrap();
            let tree = tree(&grid);
            let mut filled = 0;
            for (leaf, values) in tree.leaves.iter().zip(tree.leaf_values.chunks(LEAF_VOXELS)) {
                for (i, &value) in values.iter().enumerate() {
                    assert!((0.0..=1.0).contains(&value));
                    if value > 0.0 {
                        filled += 1;
                        let at = [i >> 6, i >> 3 & 7, i & 7];
                        let on_face = (0..3).any(|a| {
                            let voxel = leaf.origin[a] + at[a] as i32;
                            voxel == 0 || voxel == 63
                        });
                        assert!(!on_face, "seed {seed}: cloud is cut off at {leaf:?}");
                    }
                }
            }
            let share = f64::from(filled) / 64.0_f64.powi(3);
            assert!((0.02..0.5).contains(&share), "seed {seed}: {share}");
        }
    }
}
