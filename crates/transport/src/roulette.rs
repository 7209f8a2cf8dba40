//! Paths that would never end.
//!
//! Roulette ends paths by what they carry. Where nothing absorbs light and nothing lets it out, as in a medium of albedo 1 that
//! fills all space, they would go on for ever. After so many turns that hardly a path gets there otherwise, every turn ends
//! one path in a hundred, and what the others carry makes up for it.

/// Turns of a path after which it may end whatever it carries.
const LONG_PATH: u32 = 1 << 14;

/// Probability with which a long path goes on.
const LONG_PATH_SURVIVAL: f64 = 0.99;

/// Probability with which a path goes on after so many `turns`: in proportion to its `strength`, which survivors double, below
/// the `threshold`; 1 above it, unless the path is long.
pub(crate) fn survival(strength: f64, threshold: f64, turns: u32) -> f64 {
    let by_strength = if strength >= threshold { 1.0 } else { strength / (2.0 * threshold) };
    if turns < LONG_PATH { by_strength } else { by_strength.min(LONG_PATH_SURVIVAL) }
}
