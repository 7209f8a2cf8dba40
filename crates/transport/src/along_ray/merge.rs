//! Several media along one ray: coefficients add, and so do bounds, over pieces cut wherever one of the media's cells
//! ends.

use std::ops::ControlFlow;

use super::bounding::Cell;
use super::extinction::Stretch;

/// Cells with the sums of the bounds.
pub(super) fn cells<'s, 'a: 's>(stretches: impl Iterator<Item = &'s Stretch<'a>>) -> Vec<Cell> {
    let each: Vec<Vec<Cell>> = stretches
        .map(|stretch| {
            let mut cells = Vec::new();
            let _ = stretch.cells(|cell| {
                cells.push(cell);
                ControlFlow::<()>::Continue(())
            });
            cells
        })
        .collect();
    let cuts = sorted(each.iter().flatten().flat_map(|cell| [cell.start, cell.end]).collect());
    let mut next = vec![0; each.len()];
    let mut merged = Vec::with_capacity(cuts.len());
    for pair in cuts.windows(2) {
        let mut sum = Cell { start: pair[0], end: pair[1], min: 0.0, max: 0.0 };
        for (cells, next) in each.iter().zip(&mut next) {
            while cells.get(*next).is_some_and(|cell| cell.end <= sum.start) {
                *next += 1;
            }
            if let Some(cell) = cells.get(*next).filter(|cell| cell.start <= sum.start) {
                sum.min += cell.min;
                sum.max += cell.max;
            }
        }
        merged.push(sum);
    }
    merged
}

/// All ends of intervals within which all of the media are smooth.
pub(super) fn smooth_intervals<'s, 'a: 's>(stretches: impl Iterator<Item = &'s Stretch<'a>>) -> Vec<f64> {
    let mut cuts = Vec::new();
    for stretch in stretches {
        let _ = stretch.smooth_intervals(|a, b| {
            cuts.extend([a, b]);
            ControlFlow::<()>::Continue(())
        });
    }
    sorted(cuts)
}

fn sorted(mut cuts: Vec<f64>) -> Vec<f64> {
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}
