//! A phase function for each of some wavelengths, as tables and Lorenz-Mie theory give them.
//!
//! Between two wavelengths the phase functions are mixed in proportion, which again is a phase function and is
//! sampled exactly; beyond the first and last, theirs hold.

use super::PhaseFunction;

/// Phase functions over wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralPhase {
    /// Increasing, nm; as many as phase functions, or none if one holds for all wavelengths.
    wavelengths_nm: Vec<f64>,
    phases: Vec<PhaseFunction>,
}

impl From<PhaseFunction> for SpectralPhase {
    /// The same for all wavelengths.
    fn from(phase: PhaseFunction) -> SpectralPhase {
        SpectralPhase { wavelengths_nm: Vec::new(), phases: vec![phase] }
    }
}

impl SpectralPhase {
    /// Phase functions at wavelengths in nm, in any order; `None` if there is none, or if a wavelength is not above 0 or
    /// comes twice.
    pub fn new(mut by_wavelength: Vec<(f64, PhaseFunction)>) -> Option<SpectralPhase> {
        by_wavelength.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_sound = by_wavelength.iter().all(|(nm, _)| nm.is_finite() && *nm > 0.0)
            && by_wavelength.windows(2).all(|pair| pair[0].0 < pair[1].0)
            && !by_wavelength.is_empty();
        let (wavelengths_nm, phases) = by_wavelength.into_iter().unzip();
        is_sound.then_some(SpectralPhase { wavelengths_nm, phases })
    }

    /// Whether it is the same for all wavelengths.
    pub fn is_grey(&self) -> bool {
        self.phases.len() == 1
    }

    /// The wavelengths in nm, increasing; none if the phase function is the same for all.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// The phase functions, in the order of [`wavelengths_nm`](Self::wavelengths_nm); at least one.
    pub fn phases(&self) -> &[PhaseFunction] {
        &self.phases
    }

    /// The phase function at a wavelength in nm, mixed from those on either side of it.
    pub fn at(&self, wavelength_nm: f64) -> PhaseFunction {
        let after = self.wavelengths_nm.partition_point(|nm| *nm <= wavelength_nm);
        if after == 0 || after >= self.phases.len() {
            return self.phases[after.min(self.phases.len() - 1)].clone();
        }
        let (left, right) = (self.wavelengths_nm[after - 1], self.wavelengths_nm[after]);
        let weight = (right - wavelength_nm) / (right - left);
        if weight >= 1.0 {
            return self.phases[after - 1].clone();
        }
        PhaseFunction::mixture(weight, self.phases[after - 1].clone(), self.phases[after].clone())
    }

    /// The phase function of the nearest wavelength.
    pub fn nearest(&self, wavelength_nm: f64) -> &PhaseFunction {
        let distance = |i: &usize| (self.wavelengths_nm[*i] - wavelength_nm).abs();
        let nearest = (0..self.wavelengths_nm.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        &self.phases[nearest.unwrap_or(0)]
    }
}
