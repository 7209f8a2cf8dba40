//! A binary tree of lights, from which one is drawn by where it is needed.
//!
//! At each node a child is drawn with the probability of its importance among both (see `emission_bounds.rs`); the
//! probability of a light is the product of those on its way from the root (Conty Estevez & Kulla 2018, without their
//! adaptive splitting). Where both children seem to bring nothing their powers decide, so that probabilities always sum to
//! 1. Drawing and asking for a probability take as many steps as the tree is deep.

use glam::DVec3;

use super::Light;
use super::emission_bounds::EmissionBounds;

/// A binary tree of lights that are somewhere.
#[derive(Debug, Clone)]
pub struct LightTree {
    /// Each inner node stands before its first child; the root is the first.
    nodes: Vec<Node>,
    /// For each light of the scene its leaf.
    leaves: Vec<Option<u32>>,
    /// Numbers of the lights that are not in the tree.
    others: Vec<usize>,
    /// Probability that a light of the tree is drawn.
    share: f64,
}

#[derive(Debug, Clone)]
struct Node {
    bounds: EmissionBounds,
    parent: u32,
    content: Content,
}

#[derive(Debug, Clone, Copy)]
enum Content {
    /// The number of a light.
    Light(usize),
    /// The second child.
    Children(u32),
}

/// Number of lights up to which place does not matter enough to be asked for.
const FEW: usize = 2;

/// Bins along each axis among which splits are looked for.
const BINS: usize = 12;

/// Depth from which on groups are halved, whatever that costs.
const HALVE_FROM: usize = 48;

impl LightTree {
    /// A tree of those `lights` that are somewhere and have a probability above 0, to which powers are in proportion. None
    /// if these are few.
    pub fn new(lights: &[Light], probabilities: &[f64]) -> Option<Self> {
        let (mut group, mut others) = (Vec::new(), Vec::new());
        for (number, (light, &probability)) in lights.iter().zip(probabilities).enumerate() {
            match EmissionBounds::of_light(light, probability) {
                Some(bounds) if probability > 0.0 => group.push((number, bounds)),
                _ => others.push(number),
            }
        }
        if group.len() <= FEW {
            return None;
        }
        let share = 1.0 - others.iter().map(|&number| probabilities[number]).sum::<f64>();
        let mut tree = Self { nodes: Vec::new(), leaves: vec![None; lights.len()], others, share };
        tree.add(&mut group, 0, 0);
        Some(tree)
    }

    /// Numbers of the lights that are not in the tree.
    pub fn others(&self) -> &[usize] {
        &self.others
    }

    /// Probability that one of the tree's lights is drawn and not one of the others, wherever.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Whether the light of this number is in the tree.
    pub fn contains(&self, number: usize) -> bool {
        self.leaves.get(number).is_some_and(Option::is_some)
    }

    /// Number of a light for `u` in [0, 1), and the probability with which it was drawn for `from`.
    pub fn choose(&self, from: DVec3, mut u: f64) -> (usize, f64) {
        let (mut at, mut probability) = (0, 1.0);
        loop {
            let second = match self.nodes[at].content {
                Content::Light(number) => return (number, probability),
                Content::Children(second) => second as usize,
            };
            let of_first = self.share_of_first(at, second, from);
            if u < of_first {
                u /= of_first;
                probability *= of_first;
                at += 1;
            } else {
                u = (u - of_first) / (1.0 - of_first);
                probability *= 1.0 - of_first;
                at = second;
            }
            u = u.clamp(0.0, 1.0 - f64::EPSILON);
        }
    }

    /// Probability with which [`choose`](Self::choose) draws the light of this number for `from`; 0 if it is not in here.
    pub fn probability(&self, number: usize, from: DVec3) -> f64 {
        let Some(leaf) = self.leaves.get(number).copied().flatten() else { return 0.0 };
        let (mut at, mut probability) = (leaf as usize, 1.0);
        while at != 0 {
            let parent = self.nodes[at].parent as usize;
            let Content::Children(second) = self.nodes[parent].content else { return 0.0 };
            let of_first = self.share_of_first(parent, second as usize, from);
            probability *= if at == parent + 1 { of_first } else { 1.0 - of_first };
            at = parent;
        }
        probability
    }

    fn share_of_first(&self, parent: usize, second: usize, from: DVec3) -> f64 {
        let [first, second] = [parent + 1, second].map(|child| &self.nodes[child].bounds);
        let importances = [first.importance(from), second.importance(from)];
        let [one, other] = if importances == [0.0; 2] { [first.power, second.power] } else { importances };
        one / (one + other)
    }

    /// Adds the group as a subtree below `parent`, and returns the number of its root.
    fn add(&mut self, group: &mut [(usize, EmissionBounds)], parent: u32, depth: usize) -> u32 {
        let node = self.nodes.len() as u32;
        let bounds = union(group);
        if let [(number, _)] = group {
            self.leaves[*number] = Some(node);
            self.nodes.push(Node { bounds, parent, content: Content::Light(*number) });
            return node;
        }
        self.nodes.push(Node { bounds, parent, content: Content::Children(0) });
        let middle = split(group, &bounds, depth);
        let (first, second) = group.split_at_mut(middle);
        self.add(first, node, depth + 1);
        let second = self.add(second, node, depth + 1);
        self.nodes[node as usize].content = Content::Children(second);
        node
    }
}

fn union(group: &[(usize, EmissionBounds)]) -> EmissionBounds {
    group[1..].iter().fold(group[0].1, |all, (_, bounds)| all.union(bounds))
}

/// Sorts the group so that its first part is one child and the rest the other, and returns where that begins: at the split
/// of least cost.
fn split(group: &mut [(usize, EmissionBounds)], bounds: &EmissionBounds, depth: usize) -> usize {
    let least = group.iter().fold(DVec3::INFINITY, |least, (_, bounds)| least.min(bounds.center()));
    let most = group.iter().fold(DVec3::NEG_INFINITY, |most, (_, bounds)| most.max(bounds.center()));
    let extent = most - least;
    let longest = (bounds.max - bounds.min).max_element();
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| depth < HALVE_FROM && extent[axis] > 0.0) {
        let mut bins: [Option<EmissionBounds>; BINS] = [None; BINS];
        for (_, bounds) in group.iter() {
            let bin = &mut bins[bin_of(bounds, axis, least, extent)];
            *bin = Some(bin.map_or(*bounds, |all| all.union(bounds)));
        }
        // A split across a short side makes longer children.
        let penalty = longest / (bounds.max - bounds.min)[axis].max(f64::MIN_POSITIVE);
        let join = |all: Option<EmissionBounds>, bin: &Option<EmissionBounds>| match (all, bin) {
            (Some(all), Some(bin)) => Some(all.union(bin)),
            (all, bin) => all.or(*bin),
        };
        for cut in 1..BINS {
            let parts = [&bins[..cut], &bins[cut..]].map(|part| part.iter().fold(None, join));
            let [Some(first), Some(second)] = parts else { continue };
            let cost = penalty * (first.cost() + second.cost());
            if best.is_none_or(|(least, _, _)| cost < least) {
                best = Some((cost, axis, cut));
            }
        }
    }
    match best {
        Some((_, axis, cut)) => {
            group.sort_by_key(|(number, bounds)| (bin_of(bounds, axis, least, extent) >= cut, *number));
            group.partition_point(|(_, bounds)| bin_of(bounds, axis, least, extent) < cut)
        }
        None => {
            let axis = if extent.x >= extent.y.max(extent.z) {
                0
            } else if extent.y >= extent.z {
                1
            } else {
                2
            };
            group.sort_by(|(_, a), (_, b)| a.center()[axis].total_cmp(&b.center()[axis]));
            group.len() / 2
        }
    }
}

fn bin_of(bounds: &EmissionBounds, axis: usize, least: DVec3, extent: DVec3) -> usize {
    let along = (bounds.center()[axis] - least[axis]) / extent[axis];
    ((along * BINS as f64) as usize).min(BINS - 1)
}
