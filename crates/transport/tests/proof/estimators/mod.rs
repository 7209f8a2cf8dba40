//! Distance samplers and transmittance estimators: mean, variance and cost of each by itself, against closed forms and
//! quadrature, and whole pictures made with them.
//!
//! With `TYNDALL_PROOF=full` in the environment every estimate takes ten times as many samples.

mod airlight;
mod bias;
mod distances;
mod grids;
mod means;
mod moments;
mod pictures;
mod rays;

/// Factor on the numbers of samples.
fn effort() -> u64 {
    if crate::effort::is_full() { 10 } else { 1 }
}
