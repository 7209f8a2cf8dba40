//! Plane-parallel layers: what they reflect, transmit and absorb.

use std::sync::atomic::Ordering;

use pyo3::FromPyObject;
use pyo3::prelude::{PyRef, PyResult, Python, pyfunction};
use tyndall_transport::walk::slab_input::{
    ALBEDO, ASYMMETRY, AZIMUTH, COSINE, REFRACTIVE_INDEX, Rule, TAU, slanted, views,
};
use tyndall_transport::walk::{Estimate, Incidence, LayerFluxes, Slab};

use crate::effort::Effort;
use crate::error::wrong;
use crate::interrupt::cancellable;
use crate::phase::PhaseFunction;

/// A layer as Python gives it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct SlabInput<'py> {
    tau: f64,
    albedo: f64,
    phase: Scattering<'py>,
    /// Degrees off the normal; diffuse light without.
    incidence: Option<f64>,
    n: f64,
    ground_albedo: f64,
    radiance: Vec<f64>,
    azimuth: f64,
}

/// How a layer scatters.
#[derive(FromPyObject)]
enum Scattering<'py> {
    Function(PyRef<'py, PhaseFunction>),
    /// Henyey and Greenstein's, by its mean cosine.
    Asymmetry(f64),
}

/// Mean and standard error.
type Pair = (f64, f64);

/// Reflectance, transmittance, unscattered, absorptance; radiance at the cosines, at the top and then at the bottom; and
/// the number of photons.
type Fluxes = ([Pair; 4], Vec<Pair>, u64);

impl SlabInput<'_> {
    fn slab(&self) -> PyResult<Slab> {
        let check = |key: &str, rule: &Rule, x: f64| {
            rule.check(x).map_err(|mend| wrong(format!("{key}: {mend}, not {x}")))
        };
        check("tau", &TAU, self.tau)?;
        check("albedo", &ALBEDO, self.albedo)?;
        check("n", &REFRACTIVE_INDEX, self.n)?;
        check("ground_albedo", &ALBEDO, self.ground_albedo)?;
        check("azimuth", &AZIMUTH, self.azimuth)?;
        for &mu in &self.radiance {
            check("radiance", &COSINE, mu)?;
        }
        if self.tau.is_infinite() && self.ground_albedo > 0.0 {
            return Err(wrong(
                "ground_albedo: there is no ground below an infinite layer; give a finite tau",
            ));
        }
        if self.n != 1.0 && !self.radiance.is_empty() {
            return Err(wrong("radiance: is not known behind reflecting faces; leave n away"));
        }
        let phase_function = match &self.phase {
            Scattering::Function(phase) => phase.phase_function().clone(),
            Scattering::Asymmetry(g) => {
                tyndall_optics::PhaseFunction::HenyeyGreenstein { g: check("g", &ASYMMETRY, *g)? }
            }
        };
        let incidence = match self.incidence {
            None => Incidence::Diffuse,
            Some(degrees) => {
                slanted(degrees).map_err(|mend| wrong(format!("incidence: {mend}, not {degrees}")))?
            }
        };
        Ok(Slab {
            tau: self.tau,
            albedo: self.albedo,
            phase_function,
            incidence,
            refractive_index: self.n,
            ground_albedo: self.ground_albedo,
            views: views(&self.radiance, self.azimuth, self.tau.is_finite()),
        })
    }
}

/// Sends photons through layers, each with a stream of random numbers of its own; none before all are known to make sense.
#[pyfunction]
pub(crate) fn slabs(py: Python<'_>, layers: Vec<SlabInput<'_>>, effort: Effort) -> PyResult<Vec<Fluxes>> {
    let slabs = layers.iter().map(SlabInput::slab).collect::<PyResult<Vec<Slab>>>()?;
    let (fluxes, signal) = cancellable(py, |cancel| {
        let measured = (0..).zip(&slabs).map(|(stream, slab)| {
            let fluxes = slab.measure(&effort.options(stream), cancel);
            (!cancel.load(Ordering::Relaxed)).then_some(fluxes)
        });
        measured.collect::<Option<Vec<LayerFluxes>>>()
    });
    if let Some(signal) = signal {
        return Err(signal);
    }
    Ok(fluxes.unwrap_or_default().iter().map(of_python).collect())
}

fn of_python(fluxes: &LayerFluxes) -> Fluxes {
    let pair = |estimate: &Estimate| (estimate.mean, estimate.standard_error);
    let totals = [&fluxes.reflectance, &fluxes.transmittance, &fluxes.unscattered, &fluxes.absorptance];
    (totals.map(pair), fluxes.radiance.iter().map(pair).collect(), fluxes.samples)
}
