//! Proof of the transport: what it computes against what is known without it.
//!
//! Every test is a statistical one with fixed seeds, so that it gives the same answer each time; the level at which it
//! would fail by chance for other seeds (see [`fresh`]) is stated with each. Where both integrators can be asked, both are.

mod adaptive;
mod agreement;
mod chromatic;
mod effort;
mod emission;
mod estimators;
mod fast_spectral;
mod fresh;
mod golden;
mod phase_functions;
mod random_scenes;
mod rendering;
mod same_bits;
mod sampler;
mod scenes;
mod slab;
mod spectrum;
mod statistics;
mod surfaces;
mod thin_grids;
mod walk;
mod white_furnace;
