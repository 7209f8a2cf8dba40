//! Integrals over cos θ and the phase functions that all tests go through.

use std::f64::consts::TAU;

use glam::DVec3;
use tyndall_optics::PhaseFunction;
use tyndall_optics::phase_function::{Sggx, SggxKind};

/// Phase functions of every kind but SGGX, up to the ends of their parameters.
pub fn kinds() -> Vec<PhaseFunction> {
    let mut kinds = vec![PhaseFunction::Isotropic, PhaseFunction::Rayleigh, c1_cloud()];
    for g in [0.0, 1e-12, -5e-5, -0.6, 0.3, 0.85, 0.98, 0.999, -0.999] {
        kinds.push(PhaseFunction::HenyeyGreenstein { g });
        kinds.push(PhaseFunction::Schlick { k: g });
        kinds.push(PhaseFunction::cornette_shanks(g));
        kinds.push(PhaseFunction::Draine { g, alpha: 250.0 });
    }
    kinds.push(PhaseFunction::double_henyey_greenstein(0.9, -0.4, 0.8));
    kinds.push(PhaseFunction::double_henyey_greenstein(0.9, -0.4, 1.0));
    kinds.push(PhaseFunction::double_henyey_greenstein(0.9, -0.4, 0.0));
    kinds.extend([1e-3, 0.1, 0.7, 1.499, 1.5, 4.9, 5.0, 20.0, 50.0].map(PhaseFunction::fog));
    kinds
}

/// SGGX of both kinds, smooth and rough, about several axes.
pub fn sggx_kinds() -> Vec<PhaseFunction> {
    let mut kinds = Vec::new();
    for kind in [SggxKind::Surface, SggxKind::Fibre] {
        for (roughness, axis) in [(0.1, DVec3::X), (0.5, DVec3::new(1.0, -2.0, 0.5)), (1.0, DVec3::Z)] {
            kinds.push(PhaseFunction::Sggx(Sggx::new(kind, axis, roughness)));
        }
    }
    kinds
}

/// Deirmendjian's C.1 cloud at 0.67 µm, from the table of I3RC.
pub fn c1_cloud() -> PhaseFunction {
    let table = tyndall_optics::phase_function::parse_phase_table(include_str!("../truth/c1_cloud.txt"));
    table.expect("the table is sound").at(550.0)
}

/// ∫ f(cos θ) f_p dω over cos θ from `low` to `high`.
pub fn integrate(phase: &PhaseFunction, low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    integral(low, high, |cos| TAU * f(cos) * phase.value_at_cosine(cos))
}

/// ∫ f(μ) dμ over part of −1…1, for f with peaks at the ends: Gauss's rule of five points in panels that halve towards
/// both ends down to 1e-9, each again cut into four.
pub fn integral(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const POINTS: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let mut bounds: Vec<f64> =
        (0..30).flat_map(|i| [-1.0 + 0.5_f64.powi(i), 1.0 - 0.5_f64.powi(i)]).collect();
    bounds.extend([-1.0, 1.0, low, high]);
    bounds.retain(|bound| (low..=high).contains(bound));
    bounds.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for panel in bounds.windows(2) {
        let width = (panel[1] - panel[0]) / 4.0;
        for quarter in 0..4 {
            let middle = panel[0] + width * (f64::from(quarter) + 0.5);
            sum += POINTS.iter().map(|(x, w)| 0.5 * width * w * f(middle + 0.5 * width * x)).sum::<f64>();
        }
    }
    sum
}

/// The same with the cells of a table as panels, on each of which its values are linear.
pub fn integral_over_cells(cosines: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    cosines.windows(2).map(|cell| integral_over_cell(cell[0], cell[1], &f)).sum()
}

/// Romberg's rule.
fn integral_over_cell(low: f64, high: f64, f: &impl Fn(f64) -> f64) -> f64 {
    let width = high - low;
    let mut rows: Vec<f64> = vec![0.5 * width * (f(low) + f(high))];
    for level in 1..7 {
        let n = 1 << (level - 1);
        let step = width / f64::from(n);
        let middles: f64 = (0..n).map(|i| f(low + step * (f64::from(i) + 0.5))).sum();
        let mut next = vec![0.5 * (rows[0] + step * middles)];
        for (order, coarse) in rows.iter().enumerate() {
            let factor = f64::from(4_u32.pow(order as u32 + 1));
            next.push(next[order] + (next[order] - coarse) / (factor - 1.0));
        }
        rows = next;
    }
    rows[rows.len() - 1]
}
