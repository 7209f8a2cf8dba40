//! Transmittance in closed form, for a homogeneous medium: T = exp(−μt·length) (Beer's law).
//!
//! Exact; no lookups.

pub(super) fn transmittance(mu_t: f64, interval: Option<(f64, f64)>) -> f64 {
    interval.map_or(1.0, |(enter, leave)| (-mu_t * (leave - enter)).exp())
}
