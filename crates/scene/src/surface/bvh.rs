//! A hierarchy of bounding boxes: a binary tree in which a ray finds the items whose boxes it meets, near ones first.
//!
//! Built from the top: each range of items is parted where the surface area heuristic, evaluated at 16 bins along each
//! axis, is least (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"). Boxes are kept in f32,
//! rounded outwards; they are met in f64, with the far distances widened by more than rounding takes away (Ize 2013,
//! "Robust BVH ray traversal"), so that no box is missed that the ray touches.

use glam::DVec3;

use crate::Ray;

/// Items that a leaf holds at most, unless their centres coincide.
const LEAF: usize = 4;
const BINS: usize = 16;
/// Cost of a step in the tree over that of an item.
const STEP_COST: f32 = 0.7;
/// Below this depth ranges are halved, so that the stack of a traversal, which is one deeper than the tree, is bounded.
const SAH_DEPTH: usize = 64;
const STACK: usize = SAH_DEPTH + 34;

/// The tree. Items are known by number.
#[derive(Debug, Clone, Default)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    /// Numbers of the items, those of a leaf together.
    order: Vec<u32>,
}

/// A box; a leaf with the items `first..first + count` of the order, or, if `count` is 0, the parent of the nodes
/// `first` and `first + 1`.
#[derive(Debug, Clone, Copy)]
struct Node {
    min: [f32; 3],
    first: u32,
    max: [f32; 3],
    count: u32,
}

impl Bvh {
    /// The tree over items with these boxes.
    pub fn new(boxes: impl Iterator<Item = [DVec3; 2]>) -> Self {
        let items: Vec<Bounds> = boxes.map(Bounds::around).collect();
        let mut order: Vec<u32> = (0..items.len() as u32).collect();
        if items.is_empty() {
            return Self::default();
        }
        let mut nodes = vec![Node::over(&items, &order, 0)];
        let mut ranges = vec![(0, 0, order.len(), 0)];
        while let Some((node, first, last, depth)) = ranges.pop() {
            let range = &mut order[first..last];
            let Some(left) = part(&items, range, depth) else { continue };
            let middle = first + left;
            let child = nodes.len() as u32;
            let halves = [(first, middle), (middle, last)];
            nodes.extend(halves.map(|(from, to)| Node::over(&items, &order[from..to], from)));
            (nodes[node].first, nodes[node].count) = (child, 0);
            ranges.push((child as usize + 1, middle, last, depth + 1));
            ranges.push((child as usize, first, middle, depth + 1));
        }
        Self { nodes, order }
    }

    /// The box around all items.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let root = self.nodes.first()?;
        Some([root.min, root.max].map(|corner| DVec3::from_array(corner.map(f64::from))))
    }

    /// Shows the items whose boxes `ray` meets between 0 and `end` to `visit`, roughly from near to far, with the present
    /// end; what `visit` returns becomes the end.
    pub fn traverse(&self, ray: &Ray, mut end: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let slabs = Slabs::new(ray);
        let mut stack = [(0_u32, 0.0_f64); STACK];
        let mut depth = 0;
        let Some(root) = self.nodes.first() else { return };
        if slabs.distance(root, end).is_none() {
            return;
        }
        let mut node = root;
        loop {
            if node.count > 0 {
                let first = node.first as usize;
                for &item in &self.order[first..first + node.count as usize] {
                    end = visit(item, end);
                }
            } else {
                let children = [node.first, node.first + 1];
                let left = slabs.distance(&self.nodes[children[0] as usize], end);
                let right = slabs.distance(&self.nodes[children[1] as usize], end);
                let near = match (left, right) {
                    (Some(left), Some(right)) => {
                        let is_swapped = right < left;
                        let far = if is_swapped { (children[0], left) } else { (children[1], right) };
                        stack[depth] = far;
                        depth += 1;
                        Some(children[usize::from(is_swapped)])
                    }
                    (Some(_), None) => Some(children[0]),
                    (None, Some(_)) => Some(children[1]),
                    (None, None) => None,
                };
                if let Some(near) = near {
                    node = &self.nodes[near as usize];
                    continue;
                }
            }
            // The nearest box left over that still begins before the end.
            loop {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                let (number, distance) = stack[depth];
                if distance <= end {
                    node = &self.nodes[number as usize];
                    break;
                }
            }
        }
    }
}

impl Node {
    /// A leaf.
    fn over(items: &[Bounds], range: &[u32], first: usize) -> Self {
        let all = range.iter().fold(Bounds::EMPTY, |all, &item| all.union(&items[item as usize]));
        Self { min: all.min, max: all.max, first: first as u32, count: range.len() as u32 }
    }
}

/// A ray as boxes see it.
struct Slabs {
    origin: [f64; 3],
    inverse: [f64; 3],
    is_negative: [bool; 3],
}

impl Slabs {
    fn new(ray: &Ray) -> Self {
        // Along a face 0 times infinity would be no number: no direction is exactly 0 here.
        let away = |d: f64| if d.abs() < 1e-300 { 1e-300_f64.copysign(d) } else { d };
        let DVec3 { x, y, z } = ray.direction;
        Self {
            origin: ray.origin.to_array(),
            inverse: [1.0 / away(x), 1.0 / away(y), 1.0 / away(z)],
            is_negative: [x.is_sign_negative(), y.is_sign_negative(), z.is_sign_negative()],
        }
    }

    /// Where the ray enters the box of `node`, if it does so before `end`.
    #[inline]
    fn distance(&self, node: &Node, end: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (min, max) = (f64::from(node.min[axis]), f64::from(node.max[axis]));
            let (first, last) = if self.is_negative[axis] { (max, min) } else { (min, max) };
            near = near.max((first - self.origin[axis]) * self.inverse[axis]);
            far = far.min((last - self.origin[axis]) * self.inverse[axis]);
        }
        let far = far * (1.0 + 8.0 * f64::EPSILON);
        (near <= far && near <= end).then_some(near)
    }
}

/// A box of f32.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The least box beyond this one.
    fn around([min, max]: [DVec3; 2]) -> Self {
        let range = f64::from(f32::MIN)..=f64::from(f32::MAX);
        let rounded = |x: f64| x.clamp(*range.start(), *range.end()) as f32;
        Self {
            min: min.to_array().map(|x| rounded(x).next_down()),
            max: max.to_array().map(|x| rounded(x).next_up()),
        }
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Twice the centre.
    fn centre(&self, axis: usize) -> f32 {
        self.min[axis] + self.max[axis]
    }

    /// Half the area; 0 of nothing.
    fn half_area(&self) -> f32 {
        let [x, y, z] = std::array::from_fn(|axis| (self.max[axis] - self.min[axis]).max(0.0));
        x * y + y * z + z * x
    }
}

/// Parts a range in two and returns how many items the first part has; `None` if it is best a leaf.
fn part(items: &[Bounds], range: &mut [u32], depth: usize) -> Option<usize> {
    if range.len() <= 1 {
        return None;
    }
    let best = if depth < SAH_DEPTH { best_plane(items, range) } else { None };
    let Some(plane) = best else {
        // Their centres coincide, or there is no telling them apart.
        return (range.len() > LEAF).then_some(range.len() / 2);
    };
    if range.len() <= LEAF && plane.cost >= range.len() as f32 {
        return None;
    }
    let mut left = 0;
    for index in 0..range.len() {
        if plane.bin(&items[range[index] as usize]) < plane.boundary {
            range.swap(index, left);
            left += 1;
        }
    }
    Some(left)
}

/// Between two bins along an axis.
struct Plane {
    axis: usize,
    low: f32,
    per_length: f32,
    /// The first bin behind it.
    boundary: usize,
    /// Expected cost of a ray that meets the whole, in items.
    cost: f32,
}

impl Plane {
    fn bin(&self, item: &Bounds) -> usize {
        (((item.centre(self.axis) - self.low) * self.per_length) as usize).min(BINS - 1)
    }
}

/// The plane of least cost; `None` if all centres coincide.
fn best_plane(items: &[Bounds], range: &[u32]) -> Option<Plane> {
    let mut whole = Bounds::EMPTY;
    let mut centres = Bounds::EMPTY;
    for item in range.iter().map(|&item| &items[item as usize]) {
        whole = whole.union(item);
        let centre = std::array::from_fn(|axis| item.centre(axis));
        centres = centres.union(&Bounds { min: centre, max: centre });
    }
    let mut best: Option<Plane> = None;
    for axis in 0..3 {
        let low = centres.min[axis];
        let per_length = BINS as f32 / (centres.max[axis] - low);
        if !per_length.is_finite() {
            continue;
        }
        let mut plane = Plane { axis, low, per_length, boundary: 0, cost: f32::INFINITY };
        let mut bins = [(Bounds::EMPTY, 0_usize); BINS];
        for item in range.iter().map(|&item| &items[item as usize]) {
            let (bounds, count) = &mut bins[plane.bin(item)];
            *bounds = bounds.union(item);
            *count += 1;
        }
        let mut behind = [0.0; BINS];
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for bin in (1..BINS).rev() {
            bounds = bounds.union(&bins[bin].0);
            count += bins[bin].1;
            behind[bin] = if count > 0 { bounds.half_area() * count as f32 } else { f32::INFINITY };
        }
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for boundary in 1..BINS {
            bounds = bounds.union(&bins[boundary - 1].0);
            count += bins[boundary - 1].1;
            let before = if count > 0 { bounds.half_area() * count as f32 } else { f32::INFINITY };
            let cost = STEP_COST + (before + behind[boundary]) / whole.half_area().max(f32::MIN_POSITIVE);
            if cost < plane.cost {
                (plane.cost, plane.boundary) = (cost, boundary);
            }
        }
        if plane.boundary > 0 && best.as_ref().is_none_or(|best| plane.cost < best.cost) {
            best = Some(plane);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_lanes::Random;

    fn boxes(count: usize, spread: f64, random: &mut Random) -> Vec<[DVec3; 2]> {
        let mut vector =
            |scale: f64| DVec3::from_array(std::array::from_fn(|_| scale * (random.f64() - 0.5)));
        (0..count)
            .map(|_| {
                let (centre, half) = (vector(spread), vector(0.2).abs());
                [centre - half, centre + half]
            })
            .collect()
    }

    /// The items are those that a test of every box finds; among them are boxes that all coincide, and ones in a
    /// geometric sequence, on which halving by area would go deep.
    #[test]
    fn every_box_that_a_ray_meets_is_visited_once_and_no_other() {
        let mut random = Random::new(11, 0, 0);
        let mut sequence = boxes(200, 0.0, &mut random);
        for (n, [min, max]) in sequence.iter_mut().enumerate() {
            let scale = 0.7_f64.powi(n as i32);
            (*min, *max) = (*min * scale, *max * scale + scale);
        }
        let same = vec![[DVec3::ZERO, DVec3::ONE]; 50];
        for boxes in [boxes(1, 1.0, &mut random), boxes(500, 2.0, &mut random), same, sequence] {
            let bvh = Bvh::new(boxes.iter().copied());
            for _ in 0..500 {
                let mut vector = || DVec3::from_array(std::array::from_fn(|_| 3.0 * (random.f64() - 0.5)));
                let ray = Ray { origin: vector(), direction: vector().normalize() };
                let slabs = Slabs::new(&ray);
                let alone = |bounds: &[DVec3; 2]| {
                    let Bounds { min, max } = Bounds::around(*bounds);
                    slabs.distance(&Node { min, max, first: 0, count: 1 }, 2.0).is_some()
                };
                let expected: Vec<usize> = (0..boxes.len()).filter(|&n| alone(&boxes[n])).collect();
                let mut found = Vec::new();
                bvh.traverse(&ray, 2.0, |item, end| {
                    found.push(item as usize);
                    end
                });
                // A leaf shows all its items.
                found.retain(|&n| alone(&boxes[n]));
                found.sort_unstable();
                assert_eq!(found, expected);
            }
        }
        assert!(Bvh::new(std::iter::empty()).bounds().is_none());
    }
}
