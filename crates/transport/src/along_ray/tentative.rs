//! Tentative collisions: the walk that all null-collision methods share.
//!
//! Along the ray the points of a Poisson process of a rate μ̄ that is constant over each piece. The exponential law has no
//! memory, so the walk starts afresh at the border of a piece. Expected number: ∫ μ̄ up to where the walk is broken off.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use super::{AlongRay, Piece};

/// A point of the process.
pub(crate) struct Tentative<'p> {
    /// Where it is.
    pub t: f64,
    /// The rate there, 1/length.
    pub rate: f64,
    /// ∫ of the rate from the start of the ray to here.
    pub depth: f64,
    /// The piece in which it is.
    pub piece: &'p Piece,
}

impl Tentative<'_> {
    /// Whether a product has become 0 so deep in the medium that the rest of the walk is not worth its time. (A 0 met
    /// earlier, at a real collision that was certain, does not end the walk: its cost is to be the stated one.)
    pub fn is_hopeless(&self, weight: f64) -> bool {
        const DEEP: f64 = 1000.0;
        weight == 0.0 && self.depth > DEEP
    }
}

/// The distance `t` after a step: far away one may be less than the rounding of `t`, and must not be lost.
#[inline]
pub(crate) fn further(t: f64, step: f64) -> f64 {
    (t + step).max(t.next_up())
}

/// Visits the tentative collisions under the rate `rate` of each piece, until `visit` breaks.
pub(crate) fn tentative_collisions<B>(
    ray: &AlongRay,
    rate: impl Fn(&Piece) -> f64,
    random: &mut Random,
    mut visit: impl FnMut(Tentative, &mut Random) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let mut depth = 0.0;
    ray.pieces(|piece| {
        let rate = rate(piece);
        if rate <= 0.0 {
            return ControlFlow::Continue(());
        }
        let mut t = piece.start;
        loop {
            t = further(t, random.exponential_f64() / rate);
            if t >= piece.end {
                depth += rate * (piece.end - piece.start);
                return ControlFlow::Continue(());
            }
            visit(Tentative { t, rate, depth: depth + rate * (t - piece.start), piece }, random)?;
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::along_ray::extinction::Stretch;
    use crate::along_ray::profile::Profile;

    /// Neighbours of 1e19 are 2048 apart, a thousand mean steps.
    #[test]
    fn steps_below_rounding_come_to_an_end() {
        let ray = AlongRay::of(Stretch::with_profile(Profile::Constant(1.0), (1e19, 1e19 + 2e5), 1));
        let mut last = 1e19;
        let mut visited = 0;
        let walk: ControlFlow<()> = tentative_collisions(
            &ray,
            |_| 0.5,
            &mut Random::new(1, 0, 0),
            |at, _| {
                assert!(at.t > last, "stands still at {last}");
                last = at.t;
                visited += 1;
                ControlFlow::Continue(())
            },
        );
        assert!(walk.is_continue() && (50..100).contains(&visited), "{visited}");
    }
}
