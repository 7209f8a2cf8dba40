//! How many particles there are of each radius r: n(r) dr, normalised to anything.
//!
//! ```text
//! gamma           n ∝ r^{(1−3b)/b} exp(−r/(ab))        a = r_eff, b = v_eff    (Hansen & Travis 1974, eq. 2.56)
//! log-normal      n ∝ exp(−ln²(r/r_g) / (2 ln² σ_g)) / r                       (ibid., eq. 2.60, with ln σ_g for σ_g)
//! modified gamma  n ∝ r^α exp(−(α/γ)(r/r_mode)^γ)                              (Deirmendjian 1969)
//! power law       n ∝ r^{−p}
//! ```
//!
//! The effective radius is ∫ r³n dr / ∫ r²n dr, and the effective variance ∫ (r − r_eff)² r²n dr / (r_eff² ∫ r²n dr).

use super::MieError;

/// A size distribution; all radii in µm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeDistribution {
    /// Its form.
    pub law: SizeLaw,
    /// There are no particles with smaller radii; 0 cuts nothing off.
    pub r_min: f64,
    /// There are no particles with greater radii; infinity cuts nothing off.
    pub r_max: f64,
}

/// The form of a size distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SizeLaw {
    /// All particles are alike; limits do not matter.
    Single {
        /// Their radius.
        r: f64,
    },
    /// Gamma distribution, of cloud and fog droplets.
    Gamma {
        /// Effective radius.
        r_eff: f64,
        /// Effective variance, between 0 and 0.5.
        v_eff: f64,
    },
    /// Log-normal distribution, of aerosols.
    LogNormal {
        /// Median radius.
        r_g: f64,
        /// Geometric standard deviation, above 1.
        sigma_g: f64,
    },
    /// Deirmendjian's distribution.
    ModifiedGamma {
        /// The most frequent radius.
        r_mode: f64,
        /// Power of small radii.
        alpha: f64,
        /// Power of the radius in the exponential.
        gamma: f64,
    },
    /// Power law; it needs both limits.
    PowerLaw {
        /// How steeply it falls.
        exponent: f64,
    },
}

/// What is left out at either end, as the logarithm of a fraction of the greatest weight.
const CUT: f64 = -17.0;

/// Radii that are computed, µm.
const RADII: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

impl From<SizeLaw> for SizeDistribution {
    /// The distribution with nothing cut off.
    fn from(law: SizeLaw) -> Self {
        Self { law, r_min: 0.0, r_max: f64::INFINITY }
    }
}

impl SizeDistribution {
    /// An error if a parameter is out of range.
    pub fn check(&self) -> Result<(), MieError> {
        let radius =
            |key, value| refuse_unless(RADII.contains(&value), key, value, "it must be from 1e-6 to 1e6 µm");
        let within = |range: std::ops::RangeInclusive<f64>, key, value, mend| {
            refuse_unless(range.contains(&value), key, value, mend)
        };
        match self.law {
            SizeLaw::Single { r } => return radius("r", r),
            SizeLaw::Gamma { r_eff, v_eff } => {
                radius("r_eff", r_eff)?;
                within(1e-5..=0.49, "v_eff", v_eff, "it must be from 0.00001 to 0.49")?;
            }
            SizeLaw::LogNormal { r_g, sigma_g } => {
                radius("r_g", r_g)?;
                within(1.001..=10.0, "sigma_g", sigma_g, "it must be from 1.001 to 10")?;
            }
            SizeLaw::ModifiedGamma { r_mode, alpha, gamma } => {
                radius("r_mode", r_mode)?;
                within(0.1..=1000.0, "alpha", alpha, "it must be from 0.1 to 1000")?;
                within(0.1..=100.0, "gamma", gamma, "it must be from 0.1 to 100")?;
            }
            SizeLaw::PowerLaw { exponent } => {
                within(0.0..=20.0, "exponent", exponent, "it must be from 0 to 20")?;
                radius("r_min", self.r_min)?;
                radius("r_max", self.r_max)?;
            }
        }
        let mend = "it must be at least 0 and less than `r_max`";
        refuse_unless(0.0 <= self.r_min && self.r_min < self.r_max, "r_min", self.r_min, mend)?;
        let [low, high] = self.log_range();
        refuse_unless(low < high, "r_min", self.r_min, "there are no particles between it and `r_max`")
    }

    /// ln of r n(r), the number of particles in a step of ln r; the constant of n(r) is left out.
    pub(super) fn log_density(&self, log_r: f64) -> f64 {
        match self.law {
            SizeLaw::Single { .. } => 0.0,
            SizeLaw::Gamma { r_eff, v_eff } => {
                (1.0 / v_eff - 2.0) * log_r - libm::exp(log_r) / (r_eff * v_eff)
            }
            SizeLaw::LogNormal { r_g, sigma_g } => {
                -0.5 * ((log_r - libm::log(r_g)) / libm::log(sigma_g)).powi(2)
            }
            SizeLaw::ModifiedGamma { r_mode, alpha, gamma } => {
                (alpha + 1.0) * log_r - alpha / gamma * libm::exp(gamma * (log_r - libm::log(r_mode)))
            }
            SizeLaw::PowerLaw { exponent } => (1.0 - exponent) * log_r,
        }
    }

    /// ln r between which all particles are that matter. Those that are left out are few by area (small ones) and by r⁴,
    /// the weight in the forward direction (great ones). Nothing lies between if the limits cut all of them off.
    pub(super) fn log_range(&self) -> [f64; 2] {
        let limits = [libm::log(self.r_min), libm::log(self.r_max)];
        if let SizeLaw::PowerLaw { .. } = self.law {
            return limits;
        }
        [self.edge(2.0, -1.0, CUT).max(limits[0]), self.edge(4.0, 1.0, CUT).min(limits[1])]
    }

    /// Middle and half width, in ln r, of the particles that matter most: where their weight by r³ is above exp(−½) of
    /// its maximum. A power law has no such place; all of it is alike.
    pub(super) fn log_peak(&self) -> [f64; 2] {
        let [low, high] = match self.law {
            SizeLaw::PowerLaw { .. } => [libm::log(self.r_min), libm::log(self.r_max)],
            _ => [self.edge(3.0, -1.0, -0.5), self.edge(3.0, 1.0, -0.5)],
        };
        [0.5 * (low + high), 0.5 * (high - low)]
    }

    /// Where rᵏ r n(r), whose logarithm is concave in ln r, has fallen to exp(`cut`) on the side of `sign`.
    fn edge(&self, power: f64, sign: f64, cut: f64) -> f64 {
        let weight = |log_r: f64| power * log_r + self.log_density(log_r);
        let (mut low, mut high) = (-40.0, 40.0);
        for _ in 0..200 {
            let [a, b] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if weight(a) < weight(b) { low = a } else { high = b }
        }
        let top = 0.5 * (low + high);
        let (mut inside, mut outside) = (top, top + sign * 60.0);
        for _ in 0..80 {
            let middle = 0.5 * (inside + outside);
            if weight(middle) - weight(top) > cut { inside = middle } else { outside = middle }
        }
        outside
    }
}

fn refuse_unless(holds: bool, key: &'static str, value: f64, mend: &'static str) -> Result<(), MieError> {
    if holds { Ok(()) } else { Err(MieError::Distribution { key, value, mend }) }
}
