//! `tyndall._tyndall`: what the Python package `tyndall` has from Rust.
//!
//! One file an idea; this one only lists what Python sees. What is written in Python, such as progress bars, xarray and the
//! examples, stands in `python/tyndall/`.

mod accumulation;
mod albedo;
mod array;
mod effort;
mod error;
mod estimators;
mod interrupt;
mod meters;
mod mie;
mod named;
mod phase;
mod pixels;
mod render;
mod scene;
mod slab;
mod slices;
mod tree;
mod units;
mod volume;

use pyo3::prelude::pymodule;

/// The compiled part of `tyndall`.
#[pymodule]
mod _tyndall {
    use pyo3::prelude::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_export]
    use crate::accumulation::Accumulation;
    #[pymodule_export]
    use crate::albedo::albedo_of_reflectance;
    #[pymodule_export]
    use crate::estimators::{
        declared_estimators, estimate_transmittance, optical_thickness, sample_distances,
    };
    #[pymodule_export]
    use crate::meters::meters;
    #[pymodule_export]
    use crate::mie::{mie_spheres, refractive_index};
    #[pymodule_export]
    use crate::phase::PhaseFunction;
    #[pymodule_export]
    use crate::render::{Progress, Render, render};
    #[pymodule_export]
    use crate::scene::{Scene, schema};
    #[pymodule_export]
    use crate::slab::slabs;
    #[pymodule_export]
    use crate::volume::Volume;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
