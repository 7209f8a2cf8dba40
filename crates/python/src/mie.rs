//! Single spheres by Lorenz-Mie theory, and refractive indices, over arrays.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::{Bound, PyResult, Python, pyfunction};
use tyndall_optics::mie::Sphere;
use tyndall_optics::{Material, RefractiveIndex, Substance};

use crate::error::wrong;
use crate::interrupt::cancellable;
use crate::slices::numbers;

/// One-dimensional arrays of efficiencies.
type Efficiencies<'py> = [Bound<'py, PyArray1<f64>>; 5];

/// `q_ext, q_sca, q_abs, q_back, g` of as many spheres as there are size parameters, and their phase functions at all
/// cosines, 1/sr, sphere by sphere.
#[pyfunction]
pub(crate) fn mie_spheres<'py>(
    py: Python<'py>,
    x: PyReadonlyArray1<'py, f64>,
    n: PyReadonlyArray1<'py, f64>,
    k: PyReadonlyArray1<'py, f64>,
    cos_theta: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Efficiencies<'py>, Bound<'py, PyArray1<f64>>)> {
    let (x, n, k) = (numbers("x", &x)?, numbers("m", &n)?, numbers("m", &k)?);
    let cosines = numbers("cos_theta", &cos_theta)?;
    let work = |cancel: &std::sync::atomic::AtomicBool| -> Result<_, String> {
        let mut rows = [const { Vec::new() }; 5];
        let mut values = Vec::new();
        for ((&x, &n), &k) in x.iter().zip(n).zip(k) {
            if cancel.load(std::sync::atomic::Ordering::Relaxed) {
                break;
            }
            let sphere = Sphere::new(RefractiveIndex { n, k }, x).map_err(|error| error.to_string())?;
            let figures = [sphere.q_ext, sphere.q_sca, sphere.q_abs, sphere.q_back, sphere.g];
            for (row, figure) in rows.iter_mut().zip(figures) {
                row.push(figure);
            }
            values.extend(cosines.iter().map(|&cos_theta| sphere.phase_function(cos_theta)));
        }
        Ok((rows, values))
    };
    let (answer, signal) = cancellable(py, work);
    if let Some(signal) = signal {
        return Err(signal);
    }
    let (rows, values) = answer.map_err(wrong)?;
    Ok((rows.map(|row| row.into_pyarray(py)), values.into_pyarray(py)))
}

/// n and k of a material that is built in at wavelengths in nm.
#[pyfunction]
pub(crate) fn refractive_index<'py>(
    py: Python<'py>,
    material: &str,
    wavelength_nm: PyReadonlyArray1<'py, f64>,
) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
    let Some(found) = Material::from_name(material) else {
        return Err(wrong(format!("material: there is no `{material}`; there is {}", names())));
    };
    let substance = Substance::Material(found);
    let (mut n, mut k) = (Vec::new(), Vec::new());
    for &wavelength in numbers("wavelength_nm", &wavelength_nm)? {
        let index = substance.refractive_index(wavelength).map_err(wrong)?;
        n.push(index.n);
        k.push(index.k);
    }
    Ok([n, k].map(|row| row.into_pyarray(py)))
}

fn names() -> String {
    let names: Vec<String> = Material::ALL.iter().map(|material| format!("`{}`", material.name())).collect();
    names.join(", ")
}
