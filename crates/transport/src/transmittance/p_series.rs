//! The power series about the majorant, cut by its cumulative mass: p-series CMF.
//!
//!   T = Σₖ Pₖ E[Πᵢ₌₁…ₖ (1 − μt(tᵢ)/μ̄)],   Pₖ = τ̄ᵏ e^(−τ̄)/k!,   τ̄ = ∫ μ̄,   tᵢ independent with density μ̄/τ̄
//!
//! Ratio tracking draws one k from Poisson's law. Here all terms are added up, over one growing product, until Σ Pₖ has
//! reached 99 %; from there each next term is taken with probability τ̄/k < 1, which takes the place of the factor.
//! Source: Georgiev, Misso, Hachisuka, Nowrouzezahrai, Křivánek & Jarosz 2019, "Integral formulations of volumetric
//! transmittance". Unbiased, also where the majorant does not bound. Less variance than ratio tracking for more lookups:
//! about τ̄ + 2.3√τ̄ and a few.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups, Piece};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "p-series-cmf",
    unbiased: true,
    majorant: MajorantUse::NonBounding,
    needs: &[],
    source: "Georgiev et al. 2019",
};

/// Share of Poisson's law whose terms are taken for certain.
const CERTAIN: f64 = 0.99;

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let pieces = cumulated(ray);
    let Some(&(whole, _)) = pieces.last() else { return 1.0 };
    // Logarithms, as e^(−τ̄) may be too small for a number where later terms are not.
    let mut log_mass = -whole;
    let mut mass = libm::exp(log_mass);
    let (mut cumulated_mass, mut product, mut sum, mut k) = (mass, 1.0, mass, 0.0);
    loop {
        k += 1.0;
        if cumulated_mass < CERTAIN || k <= whole {
            log_mass += libm::log(whole / k);
            mass = libm::exp(log_mass);
            cumulated_mass += mass;
        } else if random.f64() * k >= whole {
            return sum;
        }
        let (t, majorant) = draw(&pieces, random);
        product *= 1.0 - ray.mu_t(t, lookups) / majorant;
        if product == 0.0 {
            return sum;
        }
        sum += product * mass;
    }
}

/// The pieces with ∫ μ̄ up to the end of each.
fn cumulated(ray: &AlongRay) -> Vec<(f64, Piece)> {
    let mut pieces = Vec::new();
    let mut depth = 0.0;
    let _ = ray.pieces(|piece| {
        if piece.majorant > 0.0 {
            depth += piece.majorant * (piece.end - piece.start);
            pieces.push((depth, *piece));
        }
        ControlFlow::<()>::Continue(())
    });
    pieces
}

/// A place with density μ̄/τ̄, and the majorant there.
fn draw(pieces: &[(f64, Piece)], random: &mut Random) -> (f64, f64) {
    let depth = random.f64() * pieces[pieces.len() - 1].0;
    let index = pieces.partition_point(|piece| piece.0 <= depth).min(pieces.len() - 1);
    let (end_depth, piece) = pieces[index];
    let t = piece.end - (end_depth - depth) / piece.majorant;
    (t.max(piece.start), piece.majorant)
}
