//! A medium that glows, as a light: points of it are drawn in proportion to what they send out, roughly.
//!
//! The light of a place is S = μa Le + ε per length. The medium is cut into cells, the bricks of its grid or a lattice; a
//! cell of volume V is drawn with
//!
//!   P = (1 − f) S̄V / Σ S̄V + f V / Σ V,
//!
//! with S̄ the mean of S over a few points of the cell, and then a point uniformly within it, so that the density per volume
//! is P/V. The share f keeps the density above 0 wherever S can be, also where those few points have missed it. Cells in
//! which the grid is 0 are left out. In a homogeneous box or sphere the density is 1/V everywhere.
//!
//! Sampling fire by its voxels is Villemin & Hery 2013, "Practical illumination from flames".

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use tyndall_volumes::BrickGrid;
use tyndall_volumes::bricks::Cell;

use crate::{Density, Volume};

/// A medium that glows.
#[derive(Debug, Clone)]
pub struct VolumeLight {
    volume: usize,
    region: Region,
    world_to_local: DAffine3,
    local_to_world: DAffine3,
    /// Volume in world space of a unit of volume in local space.
    scale: f64,
    power: DVec3,
}

/// A point of a medium that glows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeLightSample {
    /// Where it is.
    pub position: DVec3,
    /// Density per volume with which it was drawn, 1/length³.
    pub pdf_volume: f64,
}

/// What points are drawn from, in local coordinates.
#[derive(Debug, Clone)]
enum Region {
    /// Uniformly the unit ball.
    Ball,
    /// Cells with the probability of each.
    Cells(Cells, Shares),
}

#[derive(Debug, Clone)]
enum Cells {
    /// n³ equal boxes between two corners, x slowest.
    Lattice([DVec3; 2], usize),
    /// Cells of a grid by their corners, in ascending order.
    Grid(Arc<BrickGrid>, Vec<Cell>),
}

/// Share of the points that are drawn uniformly over the cells.
const UNIFORM_SHARE: f64 = 0.05;

/// Lookups that estimating the light of all cells may take.
const LOOKUPS: usize = 1 << 22;

/// Cells along each axis of a shape in which the light varies.
const LATTICE: usize = 24;

impl VolumeLight {
    /// The light of `volume`, which is number `number` of its scene. None if it sends out nothing or has no bounds: then
    /// only paths through it find its light.
    pub fn new(volume: &Volume, number: usize) -> Option<Self> {
        if !volume.glows() {
            return None;
        }
        let is_uniform = volume.fields.is_none();
        let (cells, world_to_local) = match (emission_grid(volume), &volume.density) {
            (Some((grid, world_to_local)), _) => (Some(cells_of_grid(grid)), world_to_local),
            (None, Density::Grid(grid)) => (Some(cells_of_grid(grid)), volume.world_to_local),
            (None, Density::Sphere) if is_uniform => (None, volume.world_to_local),
            (None, Density::Box { .. } | Density::Sphere) => {
                let cells = if is_uniform { 1 } else { LATTICE };
                (Some(Cells::Lattice(volume.local_box()?, cells)), volume.world_to_local)
            }
            (None, Density::Everywhere | Density::Slab { .. } | Density::Atmosphere { .. }) => return None,
        };
        let local_to_world = world_to_local.inverse();
        let scale = local_to_world.matrix3.determinant().abs();
        let (region, total) = match cells {
            None => (Region::Ball, source_at(volume, local_to_world.translation) * (4.0 / 3.0 * PI)),
            Some(cells) => {
                let (probabilities, total) = cells.probabilities(volume, &local_to_world)?;
                (Region::Cells(cells, Shares::new(probabilities)), total)
            }
        };
        let power = 4.0 * PI * scale * total;
        let is_sound = power.is_finite() && power.max_element() > 0.0 && scale > 0.0;
        is_sound.then_some(Self { volume: number, region, world_to_local, local_to_world, scale, power })
    }

    /// Number of the volume in its scene.
    pub fn volume(&self) -> usize {
        self.volume
    }

    /// A point for `u` uniform in [0, 1)³.
    pub fn sample(&self, u: [f64; 3]) -> VolumeLightSample {
        let (local, pdf) = match &self.region {
            Region::Ball => (uniform_in_ball(u), 1.0 / (4.0 / 3.0 * PI)),
            Region::Cells(cells, shares) => {
                let chosen = shares.find(u[0]);
                let (start, probability) = shares.of(chosen);
                let first = ((u[0] - start) / probability).clamp(0.0, 1.0 - f64::EPSILON);
                let [min, max] = cells.bounds(chosen);
                let extent = max - min;
                (min + extent * DVec3::new(first, u[1], u[2]), probability / extent.element_product())
            }
        };
        VolumeLightSample {
            position: self.local_to_world.transform_point3(local),
            pdf_volume: pdf / self.scale,
        }
    }

    /// Density per volume, 1/length³, with which [`sample`](Self::sample) draws `position`; 0 outside the medium.
    pub fn pdf_volume(&self, position: DVec3) -> f64 {
        let local = self.world_to_local.transform_point3(position);
        let pdf = match &self.region {
            Region::Ball => {
                if local.length_squared() <= 1.0 {
                    1.0 / (4.0 / 3.0 * PI)
                } else {
                    0.0
                }
            }
            Region::Cells(cells, shares) => cells.find(local).map_or(0.0, |cell| {
                let [min, max] = cells.bounds(cell);
                shares.of(cell).1 / (max - min).element_product()
            }),
        };
        pdf / self.scale
    }

    /// Least and greatest corner of a box around it, in world space.
    pub fn bounds(&self) -> [DVec3; 2] {
        let corners = match &self.region {
            Region::Ball => [DVec3::NEG_ONE, DVec3::ONE],
            Region::Cells(Cells::Lattice(corners, _), _) => *corners,
            Region::Cells(Cells::Grid(grid, _), _) => grid.domain(),
        };
        let center = self.local_to_world.transform_point3(0.5 * (corners[0] + corners[1]));
        let half = 0.5 * (corners[1] - corners[0]);
        let axes = self.local_to_world.matrix3;
        let reach = axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        [center - reach, center + reach]
    }

    /// Power in all directions, 4π ∫ S dV, roughly.
    pub(super) fn power(&self) -> DVec3 {
        self.power
    }
}

/// The grid outside which the volume certainly does not glow, if that is its emission grid.
fn emission_grid(volume: &Volume) -> Option<(&Arc<BrickGrid>, DAffine3)> {
    let (field, _) = volume.fields.as_ref()?.emission.as_ref()?;
    // Beyond its domain a grid counts as its background at collisions, and as nothing for emission per length.
    let has_temperature = volume.fields.as_ref().is_some_and(|fields| fields.temperature.is_some());
    let glows_at_collisions = has_temperature || volume.medium.emission != DVec3::ZERO;
    let is_guide = field.grid.background() == 0.0 || !glows_at_collisions;
    is_guide.then_some((&field.grid, field.world_to_local))
}

fn cells_of_grid(grid: &Arc<BrickGrid>) -> Cells {
    let mut cells = Vec::new();
    grid.visit_cells(|cell, bounds| {
        let [min, max] = clipped(grid, &cell);
        if bounds.max > 0.0 && (max - min).min_element() > 0.0 {
            cells.push(cell);
        }
    });
    cells.sort_unstable_by_key(|cell| cell.corner);
    Cells::Grid(grid.clone(), cells)
}

/// The part of a cell inside the grid's domain.
fn clipped(grid: &BrickGrid, cell: &Cell) -> [DVec3; 2] {
    let least =
        DVec3::from_array(cell.corner.map(f64::from)) + DVec3::from_array(grid.origin().map(f64::from));
    let [low, high] = grid.domain();
    [least.max(low), (least + f64::from(1_u32 << cell.shift)).min(high)]
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Lattice(_, n) => n * n * n,
            Self::Grid(_, cells) => cells.len(),
        }
    }

    fn bounds(&self, number: usize) -> [DVec3; 2] {
        match self {
            Self::Lattice([min, max], n) => {
                let steps = (*max - *min) / *n as f64;
                let index = [number / (n * n), number / n % n, number % n].map(|i| i as f64);
                let least = *min + steps * DVec3::from_array(index);
                [least, least + steps]
            }
            Self::Grid(grid, cells) => clipped(grid, &cells[number]),
        }
    }

    /// Number of the cell that a point is in.
    fn find(&self, local: DVec3) -> Option<usize> {
        let is_between = |[min, max]: [DVec3; 2]| local.cmpge(min).all() && local.cmple(max).all();
        match self {
            Self::Lattice([min, max], n) => {
                let along = (local - *min) / (*max - *min) * *n as f64;
                let index = along.to_array().map(|i| (i as usize).min(n - 1));
                is_between([*min, *max]).then_some((index[0] * n + index[1]) * n + index[2])
            }
            Self::Grid(grid, cells) => {
                if !is_between(grid.domain()) {
                    return None;
                }
                let in_table = local - DVec3::from_array(grid.origin().map(f64::from));
                let corner = grid.cell(in_table.max(DVec3::ZERO).as_uvec3().to_array()).corner;
                cells.binary_search_by_key(&corner, |cell| cell.corner).ok()
            }
        }
    }

    /// The probability of all cells up to and with each, and ∫ S dV in local units; None if all are dark.
    fn probabilities(&self, volume: &Volume, local_to_world: &DAffine3) -> Option<(Vec<f64>, DVec3)> {
        let along = libm::cbrt((LOOKUPS / self.len().max(1)) as f64).clamp(1.0, 6.0) as usize;
        let emitted = |number: usize| {
            let [min, max] = self.bounds(number);
            let step = (max - min) / along as f64;
            let point = |k: usize| {
                let index = [k / (along * along), k / along % along, k % along].map(|i| i as f64 + 0.5);
                source_at(volume, local_to_world.transform_point3(min + step * DVec3::from_array(index)))
            };
            let sum: DVec3 = (0..along.pow(3)).map(point).sum();
            let extent = (max - min).element_product();
            (sum * (extent / along.pow(3) as f64), extent)
        };
        let cells: Vec<(DVec3, f64)> = (0..self.len()).into_par_iter().map(emitted).collect();
        let total: DVec3 = cells.iter().map(|(power, _)| *power).sum();
        let extent: f64 = cells.iter().map(|(_, extent)| extent).sum();
        let strength = total.element_sum();
        if !(strength > 0.0 && strength.is_finite()) {
            return None;
        }
        let mut sum = 0.0;
        let mut cumulative: Vec<f64> = cells
            .iter()
            .map(|(power, volume)| {
                sum +=
                    (1.0 - UNIFORM_SHARE) * power.element_sum() / strength + UNIFORM_SHARE * volume / extent;
                sum
            })
            .collect();
        cumulative.iter_mut().for_each(|up_to| *up_to /= sum);
        Some((cumulative, total))
    }
}

/// What each of some cells is drawn with.
#[derive(Debug, Clone)]
struct Shares {
    /// The probability of all cells up to and with each.
    cumulative: Vec<f64>,
    /// For each of as many equal parts of [0, 1), the cell that it begins in: where to look from (Chen & Asau 1974, "On
    /// generating random variates from an empirical distribution").
    guide: Vec<u32>,
}

impl Shares {
    fn new(cumulative: Vec<f64>) -> Self {
        let parts = cumulative.len();
        let first = |part| cumulative.partition_point(|&up_to| up_to <= part as f64 / parts as f64) as u32;
        let guide = (0..parts).map(first).collect();
        Self { cumulative, guide }
    }

    /// The cell whose share `u`, in [0, 1), falls into.
    fn find(&self, u: f64) -> usize {
        let last = self.cumulative.len() - 1;
        let part = (u * self.guide.len() as f64) as usize;
        let mut cell = (self.guide[part.min(last)] as usize).min(last);
        // Rounding may have led past it.
        while cell > 0 && self.cumulative[cell - 1] > u {
            cell -= 1;
        }
        while cell < last && self.cumulative[cell] <= u {
            cell += 1;
        }
        cell
    }

    /// Where a cell's share begins, and how large it is.
    fn of(&self, cell: usize) -> (f64, f64) {
        let start = if cell == 0 { 0.0 } else { self.cumulative[cell - 1] };
        (start, self.cumulative[cell] - start)
    }
}

fn uniform_in_ball(u: [f64; 3]) -> DVec3 {
    let z = 1.0 - 2.0 * u[1];
    let across = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(2.0 * PI * u[2]);
    DVec3::new(across * cos, across * sin, z) * libm::cbrt(u[0])
}

/// Light of red, green and blue that the volume sends out per length at a place in the world, without regard to directions:
/// what estimates of its power need.
fn source_at(volume: &Volume, position: DVec3) -> DVec3 {
    let medium = &volume.medium;
    let local = volume.world_to_local.transform_point3(position);
    let density = volume.density_anywhere(local);
    let mut source = DVec3::ZERO;
    if density > 0.0 && medium.mu_t > 0.0 {
        let mu_t = medium.chromatic.as_ref().map_or(DVec3::splat(medium.mu_t), |chromatic| chromatic.mu_t);
        let mu_a = mu_t * (DVec3::ONE - volume.albedo_at(position)).max(DVec3::ZERO);
        source += density * mu_a * volume.emission_at(position);
    }
    if medium.emission_per_length != DVec3::ZERO {
        source += medium.emission_per_length * volume.emission_per_length_factor(position);
    }
    source.max(DVec3::ZERO)
}
