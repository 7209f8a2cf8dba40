//! Claims about the brick grid, on trees drawn at random: values, bounds, traversal, the one-tap lookup.

use glam::{DAffine3, DVec3};
use std::ops::ControlFlow;
use tyndall_volumes::{BrickGrid, Filter, Grid, GridClass, GridValues, Leaf, Storage, Tile, Tree};

/// A small generator for the test's own choices.
struct Draws(u64);

impl Draws {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % n
    }
    fn unit(&mut self) -> f64 {
        self.below(1 << 30) as f64 / (1u64 << 30) as f64
    }
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

/// Leaves, 8³ and 128³ tiles scattered over a box around the origin.
fn random_tree(draws: &mut Draws, background: f32) -> Tree<f32> {
    let mut tree = Tree { background, tiles: vec![], leaves: vec![], leaf_values: vec![] };
    let mut taken = std::collections::HashSet::new();
    if draws.below(2) == 0 {
        let origin = [-128, 0, -128];
        tree.tiles.push(Tile { origin, log2_edge: 7, value: draws.unit() as f32, active: true });
    }
    for _ in 0..40 {
        let block = [draws.below(24) as i32 - 12, draws.below(24) as i32 - 30, draws.below(10) as i32];
        let origin = block.map(|x| x * 8);
        if !taken.insert(block) {
            continue;
        }
        if draws.below(5) == 0 {
            tree.tiles.push(Tile {
                origin,
                log2_edge: 3,
                value: draws.unit() as f32,
                active: draws.below(2) == 0,
            });
            continue;
        }
        tree.leaves.push(Leaf { origin, active: std::array::from_fn(|_| draws.below(1 << 30) << 20) });
        tree.leaf_values.extend((0..512).map(|_| (draws.unit() * 2.0 - 0.3) as f32));
    }
    tree
}

/// The value of a voxel, straight from the tree.
fn voxel(tree: &Tree<f32>, p: [i32; 3]) -> f32 {
    for (i, leaf) in tree.leaves.iter().enumerate() {
        let d: [i32; 3] = std::array::from_fn(|a| p[a] - leaf.origin[a]);
        if d.iter().all(|x| (0..8).contains(x)) {
            return tree.leaf_values[i * 512 + (d[0] << 6 | d[1] << 3 | d[2]) as usize];
        }
    }
    let inside = |t: &&Tile<f32>| (0..3).all(|a| (0..1 << t.log2_edge).contains(&(p[a] - t.origin[a])));
    // Smaller tiles stand before the larger ones that they cut into.
    let smallest = tree.tiles.iter().filter(inside).min_by_key(|t| t.log2_edge);
    smallest.map_or(tree.background, |t| t.value)
}

#[test]
fn voxels_are_those_of_the_tree() {
    for seed in 0..20 {
        let mut draws = Draws(seed);
        let tree = random_tree(&mut draws, if seed % 2 == 0 { 0.0 } else { 0.25 });
        let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
        for _ in 0..3000 {
            let p = [0; 3].map(|_: i32| draws.below(400) as i32 - 260);
            assert_eq!(bricks.voxel(p), voxel(&tree, p), "seed {seed} at {p:?}");
        }
    }
}

#[test]
fn filtered_values_stay_within_the_bounds_of_their_segment() {
    for seed in 0..30 {
        let mut draws = Draws(seed);
        let tree = random_tree(&mut draws, if seed % 3 == 0 { 0.1 } else { 0.0 });
        for storage in [Storage::U8, Storage::F16, Storage::F32] {
            let filter = if seed % 2 == 0 { Filter::Trilinear } else { Filter::Nearest };
            let bricks = BrickGrid::from_tree(&tree, "t", storage).unwrap().with_filter(filter);
            for _ in 0..30 {
                let origin = draws.point() * 400.0 - 260.0;
                let mut direction = draws.point() * 400.0 - 260.0 - origin;
                if draws.below(4) == 0 {
                    direction.x = 0.0;
                }
                if draws.below(4) == 0 {
                    direction.z = -0.0;
                }
                let mut reached = None;
                let _ = bricks.segments::<()>(origin, direction, (0.0, 2.0), |segment| {
                    assert!(segment.end > segment.start);
                    if let Some(end) = reached {
                        assert_eq!(segment.start, end, "segments join");
                    }
                    reached = Some(segment.end);
                    for _ in 0..4 {
                        let t = segment.start + draws.unit() * (segment.end - segment.start);
                        let value = bricks.value(origin + direction * t) as f32;
                        assert!(
                            value >= segment.bounds.min - 1e-6 && value <= segment.bounds.max + 1e-6,
                            "seed {seed} {storage:?}: {value} outside {:?}",
                            segment.bounds
                        );
                    }
                    ControlFlow::Continue(())
                });
            }
        }
    }
}

/// Steps of 1e-10 are lost in the rounding of distances of 1e7, and steps of a voxel in those of 1e17.
#[test]
fn rays_from_far_away_come_to_an_end() {
    let mut draws = Draws(7);
    let bricks = BrickGrid::from_tree(&random_tree(&mut draws, 0.0), "t", Storage::F32).unwrap();
    let [low, high] = bricks.domain();
    for distance in [1e5, 1e7, 1e9, 1e12, 1e17, 1e30, 1e200] {
        let mut crossed = 0;
        for _ in 0..300 {
            let target = low + (high - low) * draws.point();
            let mut toward = draws.point() - 0.5;
            if draws.below(3) == 0 {
                toward.y *= 1e-7;
            }
            let toward = toward.normalize();
            let origin = target - toward * distance;
            let (mut reached, mut segments) = (0.0, 0);
            let _ = bricks.segments::<()>(origin, toward, (0.0, f64::INFINITY), |segment| {
                assert!(segment.start >= reached && segment.end > segment.start, "{segment:?} {reached}");
                reached = segment.end;
                segments += 1;
                assert!(segments < 10_000, "{origin} {toward}");
                ControlFlow::Continue(())
            });
            crossed += u32::from(segments > 0);
        }
        assert!(crossed > 290 || distance > 1e13, "{crossed} of 300 rays from {distance} have met the grid");
    }
}

#[test]
fn cells_are_visited_once_each_are_those_of_lookups_and_fill_the_domain() {
    for seed in 0..5 {
        let tree = random_tree(&mut Draws(seed), 0.0);
        let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
        let table = bricks.origin().map(f64::from);
        let [low, high] = bricks.domain().map(|corner| corner - DVec3::from_array(table));
        let (mut corners, mut inside) = (Vec::new(), 0.0);
        bricks.visit_cells(|cell, bounds| {
            let edge = 1_u32 << cell.shift;
            for p in [cell.corner, cell.corner.map(|at| at + edge - 1)] {
                assert_eq!((bricks.cell(p), bricks.cell_bounds(p)), (cell, bounds));
            }
            let least = DVec3::from_array(cell.corner.map(f64::from));
            let extent = (least + f64::from(edge)).min(high) - least.max(low);
            inside += extent.max(DVec3::ZERO).element_product();
            corners.push(cell.corner);
        });
        assert!((inside / (high - low).element_product() - 1.0).abs() < 1e-9);
        let count = corners.len();
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(corners.len(), count);
    }
}

/// Half a voxel further on, a voxel fills the unit cube between its number and the next.
#[test]
fn without_a_filter_each_voxel_is_a_cube() {
    for (background, faces) in [(0.0, [-1.0, 1.0]), (0.25, [-0.5, 0.5])] {
        let tree = random_tree(&mut Draws(9), background);
        let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
        let filtered_domain = bricks.domain();
        let bricks = bricks.with_filter(Filter::Nearest);
        let mut draws = Draws(10);
        for _ in 0..2000 {
            let voxel = [0; 3].map(|_: i32| draws.below(400) as i32 - 260);
            let p = DVec3::from_array(voxel.map(f64::from)) + draws.point() * 0.999;
            assert_eq!(bricks.value(p) as f32, bricks.voxel(voxel), "{p}");
        }
        let active = [0, 1].map(|i| filtered_domain[i] - faces[i]);
        assert_eq!(bricks.domain(), [active[0], active[1] + 1.0]);
        assert_eq!(bricks.with_filter(Filter::Trilinear).domain(), filtered_domain);
    }
}

#[test]
fn segments_cover_the_part_of_the_ray_inside_the_domain() {
    let mut draws = Draws(5);
    let tree = random_tree(&mut draws, 0.0);
    let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
    let [low, high] = bricks.domain();
    let middle = (low + high) * 0.5;
    for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z] {
        let mut length = 0.0;
        let _ = bricks.segments::<()>(middle - axis * 1e4, axis, (0.0, f64::INFINITY), |segment| {
            length += segment.end - segment.start;
            ControlFlow::Continue(())
        });
        let width = ((high - low) * axis).abs().max_element();
        assert!((length - width).abs() < 1e-6, "{axis}: {length} of {width}");
    }
}

/// A direction such as (1, cos 90°, 0) in floating point leaves the plane of a face by 6e-17 a voxel.
#[test]
fn a_ray_nearly_in_the_plane_of_a_face_does_not_crawl() {
    let leaf = |x, across| Leaf { origin: [x, across, across], active: [u64::MAX; 8] };
    let tree = Tree {
        background: 0.0,
        tiles: vec![],
        leaves: (0..64).map(|i| leaf(i / 2 * 8, i % 2 * 8)).collect(),
        leaf_values: (0..64 * 512).map(|i| (i % 7) as f32).collect(),
    };
    let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
    for slope in [6e-17, -6e-17, 1e-12, -1e-12] {
        for plane in [0.0, 1.0, 8.0] {
            let mut segments = 0;
            let direction = DVec3::new(1.0, slope, -slope);
            let _ = bricks.segments::<()>(DVec3::new(-5.0, plane, plane), direction, (0.0, 1e3), |_| {
                segments += 1;
                if segments > 1000 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            assert!((20..100).contains(&segments), "slope {slope} at {plane}: {segments} segments");
        }
    }
}

#[test]
fn the_domain_holds_everything_that_differs_from_the_background() {
    let mut draws = Draws(9);
    let mut tree = random_tree(&mut draws, 0.0);
    // Inactive voxels with values are cut by design; here every voxel is active.
    tree.leaves.iter_mut().for_each(|leaf| leaf.active = [u64::MAX; 8]);
    tree.tiles.iter_mut().for_each(|tile| tile.active = true);
    let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
    let [low, high] = bricks.domain();
    for _ in 0..20_000 {
        let p = draws.point() * 420.0 - 270.0;
        if p.cmplt(low).any() || p.cmpgt(high).any() {
            assert_eq!(bricks.value(p), 0.0, "{p}");
        }
    }
}

#[test]
fn a_huge_tile_costs_kilobytes() {
    let tile = Tile { origin: [-4096, 0, 4096], log2_edge: 12, value: 0.5, active: true };
    let tree = Tree { background: 0.0, tiles: vec![tile], leaves: vec![], leaf_values: vec![] };
    let bricks = BrickGrid::from_tree(&tree, "t", Storage::F16).unwrap();
    assert!(bricks.memory_bytes() < 1 << 20, "{} bytes", bricks.memory_bytes());
    assert_eq!(bricks.voxel([-1, 4095, 4096]), 0.5);
    assert_eq!(bricks.voxel([0, 4095, 4096]), 0.0);
    assert_eq!(bricks.value(DVec3::new(-0.5, 10.0, 5000.0)), 0.25);
}

#[test]
fn stray_voxels_far_apart_are_refused_or_small() {
    let leaf = |origin| Leaf { origin, active: [1; 8] };
    let near_and_far = |distance| Tree {
        background: 0.0,
        tiles: vec![],
        leaves: vec![leaf([0; 3]), leaf([distance; 3])],
        leaf_values: (0..1024).map(|i| i as f32).collect(),
    };
    let far = BrickGrid::from_tree(&near_and_far(1 << 27), "t", Storage::F32).unwrap();
    assert!(far.memory_bytes() < 4 << 20, "{} bytes", far.memory_bytes());
    assert_eq!(far.voxel([1 << 27; 3]), 512.0);
    assert!(BrickGrid::from_tree(&near_and_far(0x7fff_fff0), "t", Storage::F32).is_err());
}

#[test]
fn one_random_tap_has_the_trilinear_mean() {
    let mut draws = Draws(3);
    let tree = random_tree(&mut draws, 0.0);
    let bricks = BrickGrid::from_tree(&tree, "t", Storage::F32).unwrap();
    let corner = DVec3::from_array(tree.leaves[0].origin.map(f64::from));
    for _ in 0..20 {
        let p = corner + draws.point() * 8.0;
        let n = 20_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let value = f64::from(bricks.voxel((p + draws.point()).floor().as_ivec3().to_array()));
            sum += value;
            squares += value * value;
        }
        let mean = sum / n as f64;
        let error = ((squares / n as f64 - mean * mean).max(1e-12) / n as f64).sqrt();
        assert!((mean - bricks.value(p)).abs() < 4.5 * error, "{mean} against {}", bricks.value(p));
    }
}

#[test]
fn non_finite_values_become_zero_and_are_counted() {
    let mut values = vec![1.0; 512];
    values[3] = f32::NAN;
    values[77] = f32::INFINITY;
    let leaf = Leaf { origin: [0; 3], active: [u64::MAX; 8] };
    let tree = Tree { background: 0.0, tiles: vec![], leaves: vec![leaf], leaf_values: values };
    let bricks = BrickGrid::from_tree(&tree, "t", Storage::F16).unwrap();
    assert_eq!(bricks.non_finite(), 2);
    assert_eq!((bricks.voxel([0, 0, 3]), bricks.voxel([0, 0, 4])), (0.0, 1.0));
}

#[test]
fn a_vector_grid_is_refused_by_name() {
    let tree = Tree { background: [0.0; 3], tiles: vec![], leaves: vec![], leaf_values: vec![] };
    let grid = Grid {
        name: "vel".into(),
        class: GridClass::Unknown,
        index_to_world: DAffine3::IDENTITY,
        saved_as_half: false,
        codec: "none".into(),
        metadata: vec![],
        values: GridValues::Vec3(tree),
    };
    let message = BrickGrid::new(&grid, Storage::F16).unwrap_err().to_string();
    assert!(message.contains("`vel`"), "{message}");
}
