//! The densities with which each channel as the hero would have drawn a path, over their mean.
//!
//! With p = (1/n) Σ p_c the weight of channel λ is A_λ p_λ/p (see [`super`]). Only ratios matter, so after every step
//! all are divided by the mean of the p_c. Steps multiply by factors given as logarithms up to a common constant; the
//! greatest of those becomes 1, and what underflows beside it has no weight either.

use glam::DVec4;
use tyndall_scene::Channels;

use super::flight::Flight;
use super::shadow::ShadowRay;

/// Greatest exponent of a ratio of densities: e^700 is just a number, and over it the weight is 0 for all purposes.
const GREATEST_EXPONENT: f64 = 700.0;

/// The densities of a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathDensities {
    /// 1/n.
    share: f64,
    /// p_c/p; their mean is 1.
    relative: DVec4,
    /// q_c/p without the light's own density p_l, if the path could have been drawn by next-event estimation.
    next_event: Option<DVec4>,
}

impl PathDensities {
    /// Those of a camera ray: the same for every hero.
    pub(super) fn new(channels: &Channels) -> Self {
        Self { share: 1.0 / channels.count() as f64, relative: channels.ones(), next_event: None }
    }

    /// p_c/p.
    pub(super) fn relative(&self) -> DVec4 {
        self.relative
    }

    /// After a free flight, with what each hero's tentative collisions had made of it.
    pub(super) fn fly(&mut self, flight: &Flight) {
        let greatest = self.greatest(flight.log_density);
        self.relative *= exp(flight.log_density - greatest, 0.0);
        if let Some(next_event) = &mut self.next_event {
            *next_event *=
                exp(flight.log_next_event - (libm::log(flight.null_fraction) + greatest), GREATEST_EXPONENT);
        }
        self.normalise();
    }

    /// After a mirror, whose direction next-event estimation does not find.
    pub(super) fn mirror(&mut self) {
        self.next_event = None;
    }

    /// After turning into a direction that the channels would have drawn with the densities `phase`: their phase functions.
    pub(super) fn turn(&mut self, phase: DVec4) {
        self.next_event = Some(self.relative);
        self.relative *= phase;
        self.normalise();
    }

    /// Weight p/(p + p_l q) of a path that has left or met a lamp, against next-event estimation with the density `light_pdf`.
    pub(super) fn weight_against(&self, light_pdf: f64) -> f64 {
        let next_event = self.next_event.map_or(0.0, |next_event| self.mean(next_event));
        1.0 / (1.0 + light_pdf * next_event)
    }

    /// f_λ/(A_λ L_λ) over the densities of all ways to a light along a shadow ray, with L over the light's density
    /// `light_pdf`; none for a delta light, which has one way only. `value` is what the turn towards the light makes of light,
    /// `pdf` the densities with which paths turn there.
    pub(super) fn connect(
        &self,
        value: DVec4,
        pdf: DVec4,
        shadow: &ShadowRay,
        light_pdf: Option<f64>,
    ) -> DVec4 {
        let greatest = self.greatest(shadow.log_density);
        let drawn = self.relative * exp(shadow.log_density - greatest, 0.0);
        let arriving = drawn * exp(-shadow.optical_thickness, 0.0) * shadow.null_fraction;
        let continued = light_pdf.map_or(0.0, |light_pdf| self.mean(arriving * pdf) / light_pdf);
        arriving * value * (shadow.roulette / (self.mean(drawn) + continued))
    }

    fn mean(&self, densities: DVec4) -> f64 {
        densities.element_sum() * self.share
    }

    /// The greatest of the logarithms, of channels that may still have been the hero.
    fn greatest(&self, logarithms: DVec4) -> f64 {
        let possible = self.relative.cmpgt(DVec4::ZERO);
        DVec4::select(possible, logarithms, DVec4::NEG_INFINITY).max_element()
    }

    fn normalise(&mut self) {
        let mean = self.mean(self.relative);
        self.relative /= mean;
        if let Some(next_event) = &mut self.next_event {
            *next_event /= mean;
        }
    }
}

/// e to the power of each exponent, cut at `greatest`.
fn exp(exponents: DVec4, greatest: f64) -> DVec4 {
    DVec4::from_array(exponents.to_array().map(|exponent| libm::exp(exponent.min(greatest))))
}
