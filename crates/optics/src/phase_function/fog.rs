//! Fog and clouds: Lorenz-Mie scattering by water droplets, fitted by (1 − w) Henyey-Greenstein + w Draine.
//!
//! Source: Jendersie & d'Eon 2023, "An approximate Mie scattering function for fog and cloud rendering", eqs. 4–7 for
//! diameters d from 5 to 50 µm, and the supplemental document for smaller ones. The droplets' sizes scatter about d, so
//! that rainbow and glory are smoothed away. The fit has steps where its pieces meet, a large one at 1.5 µm.

use super::PhaseFunction;

/// Greatest diameter of droplets, in µm, that the fit was made for.
pub const GREATEST_FOG_DIAMETER_UM: f64 = 50.0;

/// Parameters of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FogFit {
    /// Mean cosine of the Henyey-Greenstein part.
    pub g_hg: f64,
    /// Parameter g of the Draine part.
    pub g_draine: f64,
    /// Parameter α of the Draine part.
    pub alpha: f64,
    /// Weight of the Draine part.
    pub weight_draine: f64,
}

impl FogFit {
    /// The fit for droplets of `d` µm in diameter, above 0 and at most [`GREATEST_FOG_DIAMETER_UM`].
    pub fn new(d: f64) -> FogFit {
        let l = libm::log(d);
        if d <= 0.1 {
            FogFit {
                g_hg: 13.8 * d * d,
                g_draine: 1.1456 * d * libm::sin(9.29044 * d),
                alpha: 250.0,
                weight_draine: 0.252977 - 312.983 * libm::pow(d, 4.3),
            }
        } else if d < 1.5 {
            let inner = (l - 0.238604) * (l + 1.00667) / (0.507522 - 0.15677 * l);
            FogFit {
                g_hg: 0.862 - 0.143 * l * l,
                g_draine: 0.379685 * libm::cos(1.19692 * libm::cos(inner) + 1.37932 * l + 0.0625835)
                    + 0.344213,
                alpha: 250.0,
                weight_draine: 0.146209 * libm::cos(3.38707 * l + 2.11193) + 0.316072 + 0.0778917 * l,
            }
        } else if d < 5.0 {
            FogFit {
                g_hg: 0.0604931 * libm::log(l) + 0.940256,
                g_draine: 0.500411 - 0.081287 / (-2.0 * l + libm::tan(l) + 1.27551),
                alpha: 7.30354 * l + 6.31675,
                weight_draine: 0.026914 * (l - libm::cos(5.68947 * (libm::log(l) - 0.0292149))) + 0.376475,
            }
        } else {
            FogFit {
                g_hg: libm::exp(-0.0990567 / (d - 1.67154)),
                g_draine: libm::exp(-2.20679 / (d + 3.91029) - 0.428934),
                alpha: libm::exp(3.62489 - 8.29288 / (d + 5.52825)),
                weight_draine: libm::exp(-0.599085 / (d - 0.641583) - 0.665888),
            }
        }
    }

    /// The mixture that the fit stands for.
    pub fn phase_function(&self) -> PhaseFunction {
        PhaseFunction::mixture(
            self.weight_draine,
            PhaseFunction::Draine { g: self.g_draine, alpha: self.alpha },
            PhaseFunction::HenyeyGreenstein { g: self.g_hg },
        )
    }
}
