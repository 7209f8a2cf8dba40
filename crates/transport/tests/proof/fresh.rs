//! Random numbers that are the same each time, unless fresh ones are asked for.
//!
//! A test passes or fails by its fixed seeds for good. Whether it would fail as rarely as it says is found out with other
//! seeds: `TYNDALL_SEED=NUMBER` in the environment gives all tests others, and draws other random scenes. `.ci/nightly`
//! does so again and again. Only the light paths change, and the rays and points that tests draw: what grids hold stays.

use std::sync::LazyLock;

use tyndall_lanes::Random;

/// The variable that asks for them.
const VARIABLE: &str = "TYNDALL_SEED";

static NUMBER: LazyLock<u64> = LazyLock::new(|| {
    let Some(text) = std::env::var_os(VARIABLE) else { return 0 };
    let number = text.to_str().and_then(|text| text.parse::<u32>().ok());
    number.unwrap_or_else(|| panic!("{VARIABLE} must be a number below 2^32, not {}", text.display())).into()
});

/// The number that was given, or 0.
pub fn number() -> u64 {
    *NUMBER
}

/// The seed to take where a test says `own`, far below 2^32.
pub fn seed(own: u64) -> u64 {
    own + (number() << 32)
}

/// [`Random::new`] with such a seed.
pub fn random(own: u64, pixel: u64, sample: u64) -> Random {
    Random::new(seed(own), pixel, sample)
}
