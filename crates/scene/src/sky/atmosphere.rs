//! The air: how dense each constituent is at a height, what it does at a wavelength, and how much of it a ray
//! meets.
//!
//! Molecules fall off exponentially with height (8 km) and scatter by 1.24062 λ⁻⁴ per metre (λ in µm, at sea
//! level); dust falls off with 1.2 km and has the thickness that the turbidity says, ∝ λ^-1.3 (Ångström
//! 1929), of which 92 % is scattering (continental average of Hess, Koepke & Schult 1998); ozone absorbs, 300
//! Dobson units in a tent from 10 to 40 km with its top at 25 km. Profiles and Rayleigh coefficient: Bruneton
//! 2017, "A Qualitative and Quantitative Evaluation of 8 Clear Sky Models" and its implementation.
//!
//! The optical thickness of a ray at any wavelength is a sum of three columns, the integrals of the
//! densities: τ(λ) = Σ σ_i(λ) N_i. So only columns are tabulated.

use std::f64::consts::PI;

use super::spectrum::{self, COUNT, OZONE_CROSS_SECTION, Spectrum};

/// Radius of the Earth, m.
pub(super) const EARTH_RADIUS: f64 = 6_360_000.0;
/// Height above which there is no air, m.
pub(super) const ATMOSPHERE_HEIGHT: f64 = 100_000.0;
const TOP_RADIUS: f64 = EARTH_RADIUS + ATMOSPHERE_HEIGHT;

const MOLECULES_SCALE_HEIGHT: f64 = 8_000.0;
const DUST_SCALE_HEIGHT: f64 = 1_200.0;
const DUST_ANGSTROM_EXPONENT: f64 = 1.3;
const DUST_ALBEDO: f64 = 0.92;
/// Asymmetry of dust in the phase function of Cornette & Shanks 1992, as Bruneton and Hillaire have it.
const DUST_ASYMMETRY: f64 = 0.8;

/// Densities relative to sea level (ozone: to its greatest) or, integrated along a ray, columns in metres.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Amounts {
    pub(super) molecules: f64,
    pub(super) dust: f64,
    pub(super) ozone: f64,
}

impl Amounts {
    fn combine(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            molecules: f(self.molecules, other.molecules),
            dust: f(self.dust, other.dust),
            ozone: f(self.ozone, other.ozone),
        }
    }

    pub(super) fn plus(self, other: Self, factor: f64) -> Self {
        self.combine(other, |a, b| a + factor * b)
    }
}

/// Relative densities at a height in metres.
pub(super) fn densities(height: f64) -> Amounts {
    Amounts {
        molecules: libm::exp(-height / MOLECULES_SCALE_HEIGHT),
        dust: libm::exp(-height / DUST_SCALE_HEIGHT),
        ozone: (1.0 - (height - 25_000.0).abs() / 15_000.0).max(0.0),
    }
}

/// The air of a place: coefficients and columns.
pub(super) struct Atmosphere {
    /// Scattering coefficient of molecules at sea level, 1/m.
    molecules: Spectrum,
    /// Extinction coefficient of dust at sea level, 1/m.
    dust: Spectrum,
    /// Absorption coefficient of ozone at its greatest density, 1/m.
    ozone: Spectrum,
    columns: Vec<Amounts>,
}

/// What the air at a point does to light, 1/m.
pub(super) struct Coefficients {
    pub(super) extinction: Spectrum,
    pub(super) molecular_scattering: Spectrum,
    pub(super) dust_scattering: Spectrum,
}

const COLUMN_HEIGHTS: usize = 48;
const COLUMN_DIRECTIONS: usize = 128;
const COLUMN_STEPS: usize = 32;

impl Atmosphere {
    /// Air whose whole optical thickness straight up at 550 nm is `turbidity` times that of its molecules.
    pub(super) fn new(turbidity: f64) -> Self {
        let molecules_at = |micrometres: f64| 1.24062e-6 * micrometres.powi(-4);
        let dust_at_550 = (turbidity - 1.0) * molecules_at(0.55) * MOLECULES_SCALE_HEIGHT / DUST_SCALE_HEIGHT;
        let micrometres = spectrum::wavelengths().map(|nanometres| 1e-3 * nanometres);
        // 300 Dobson units of 2.687e20 molecules/m² in a tent that is as high as a layer of 15 km.
        const GREATEST_OZONE: f64 = 300.0 * 2.687e20 / 15_000.0;
        let mut atmosphere = Self {
            molecules: micrometres.map(molecules_at),
            dust: micrometres.map(|lambda| dust_at_550 * libm::pow(lambda / 0.55, -DUST_ANGSTROM_EXPONENT)),
            ozone: OZONE_CROSS_SECTION.map(|cross_section| GREATEST_OZONE * 1e-25 * cross_section),
            columns: Vec::new(),
        };
        atmosphere.columns = column_table();
        atmosphere
    }

    pub(super) fn coefficients(&self, densities: Amounts) -> Coefficients {
        let molecular_scattering = self.molecules.map(|coefficient| coefficient * densities.molecules);
        let dust = self.dust.map(|coefficient| coefficient * densities.dust);
        Coefficients {
            extinction: spectrum::each(|i| {
                molecular_scattering[i] + dust[i] + self.ozone[i] * densities.ozone
            }),
            molecular_scattering,
            dust_scattering: dust.map(|extinction| DUST_ALBEDO * extinction),
        }
    }

    /// exp(-τ) of columns.
    pub(super) fn transmittance(&self, columns: Amounts) -> Spectrum {
        let mut transmittance = [0.0; COUNT];
        for (i, value) in transmittance.iter_mut().enumerate() {
            let thickness = self.molecules[i] * columns.molecules
                + self.dust[i] * columns.dust
                + self.ozone[i] * columns.ozone;
            *value = libm::exp(-thickness);
        }
        transmittance
    }

    /// Transmittance from a point at `radius` from the Earth's centre to a sun whose direction has the cosine
    /// `cos_zenith` with the point's vertical; 0 behind the Earth.
    pub(super) fn sun_transmittance(&self, radius: f64, cos_zenith: f64) -> Spectrum {
        if meets_ground(radius, cos_zenith) {
            return [0.0; COUNT];
        }
        self.transmittance(self.columns_to_space(radius, cos_zenith))
    }

    /// The columns from a point to space along a ray that does not meet the ground, from the table.
    pub(super) fn columns_to_space(&self, radius: f64, cos_zenith: f64) -> Amounts {
        let height = (radius - EARTH_RADIUS).clamp(0.0, ATMOSPHERE_HEIGHT);
        let x = (height / ATMOSPHERE_HEIGHT).sqrt() * (COLUMN_HEIGHTS - 1) as f64;
        let (nearest, farthest) = distances_to_space(radius);
        let distance = distance_to_space(radius, cos_zenith);
        let y = ((distance - nearest) / (farthest - nearest).max(1.0)).clamp(0.0, 1.0).sqrt()
            * (COLUMN_DIRECTIONS - 1) as f64;
        let (i, j) = ((x as usize).min(COLUMN_HEIGHTS - 2), (y as usize).min(COLUMN_DIRECTIONS - 2));
        let (x, y) = (x - i as f64, y - j as f64);
        let at = |i: usize, j: usize| self.columns[i * COLUMN_DIRECTIONS + j];
        let mix = |a: Amounts, b: Amounts, t: f64| a.combine(b, |a, b| a + t * (b - a));
        mix(mix(at(i, j), at(i, j + 1), y), mix(at(i + 1, j), at(i + 1, j + 1), y), x)
    }
}

/// Columns to space by height (∝ square of the index) and by distance to space (likewise, between that
/// straight up and that along the horizon; Bruneton & Neyret 2008 parametrise so).
fn column_table() -> Vec<Amounts> {
    let mut table = Vec::with_capacity(COLUMN_HEIGHTS * COLUMN_DIRECTIONS);
    for i in 0..COLUMN_HEIGHTS {
        let height = ATMOSPHERE_HEIGHT * (i as f64 / (COLUMN_HEIGHTS - 1) as f64).powi(2);
        let radius = EARTH_RADIUS + height;
        let (nearest, farthest) = distances_to_space(radius);
        for j in 0..COLUMN_DIRECTIONS {
            let distance =
                nearest + (farthest - nearest) * (j as f64 / (COLUMN_DIRECTIONS - 1) as f64).powi(2);
            let cos_zenith = if distance > 0.0 {
                ((TOP_RADIUS.powi(2) - radius.powi(2) - distance.powi(2)) / (2.0 * radius * distance))
                    .clamp(-1.0, 1.0)
            } else {
                1.0
            };
            table.push(integrate_columns(radius, cos_zenith, distance, COLUMN_STEPS));
        }
    }
    table
}

/// The columns along a ray over `distance`.
pub(super) fn integrate_columns(radius: f64, cos_zenith: f64, distance: f64, steps: usize) -> Amounts {
    // Away from its lowest point the ray leaves the dense air: steps grow with the square from there.
    let lowest = (-radius * cos_zenith).clamp(0.0, distance);
    let mut columns = Amounts::default();
    for (length, sign) in [(lowest, -1.0), (distance - lowest, 1.0)] {
        if length == 0.0 {
            continue;
        }
        let density =
            |along: f64| densities(radius_along(radius, cos_zenith, lowest + sign * along) - EARTH_RADIUS);
        let (mut near, mut at_near) = (0.0, density(0.0));
        for step in 1..=steps {
            let far = length * (step as f64 / steps as f64).powi(2);
            let at_far = density(far);
            // Simpson's rule.
            let sixth = (far - near) / 6.0;
            columns = columns
                .plus(at_near, sixth)
                .plus(density(0.5 * (near + far)), 4.0 * sixth)
                .plus(at_far, sixth);
            (near, at_near) = (far, at_far);
        }
    }
    columns
}

/// Distance from the Earth's centre after `distance` along a ray.
pub(super) fn radius_along(radius: f64, cos_zenith: f64, distance: f64) -> f64 {
    (radius * radius + distance * (distance + 2.0 * radius * cos_zenith)).sqrt()
}

/// Whether a ray from a point at `radius` meets the ground.
pub(super) fn meets_ground(radius: f64, cos_zenith: f64) -> bool {
    cos_zenith < 0.0 && radius * (1.0 - cos_zenith * cos_zenith).sqrt() < EARTH_RADIUS
}

/// Distance along a ray that meets the ground.
pub(super) fn distance_to_ground(radius: f64, cos_zenith: f64) -> f64 {
    let discriminant = radius * radius * (cos_zenith * cos_zenith - 1.0) + EARTH_RADIUS * EARTH_RADIUS;
    (-radius * cos_zenith - discriminant.max(0.0).sqrt()).max(0.0)
}

/// Distance to the top of the air along a ray that does not meet the ground.
pub(super) fn distance_to_space(radius: f64, cos_zenith: f64) -> f64 {
    let discriminant = radius * radius * (cos_zenith * cos_zenith - 1.0) + TOP_RADIUS * TOP_RADIUS;
    (-radius * cos_zenith + discriminant.max(0.0).sqrt()).max(0.0)
}

/// Distance to space straight up and along the ray that touches the ground.
fn distances_to_space(radius: f64) -> (f64, f64) {
    let above_horizon = (radius * radius - EARTH_RADIUS * EARTH_RADIUS).max(0.0).sqrt();
    let beyond_horizon = (TOP_RADIUS * TOP_RADIUS - EARTH_RADIUS * EARTH_RADIUS).sqrt();
    ((TOP_RADIUS - radius).max(0.0), above_horizon + beyond_horizon)
}

/// Phase function of molecules (Rayleigh), 1/sr.
pub(super) fn molecular_phase(cos_scattering: f64) -> f64 {
    3.0 / (16.0 * PI) * (1.0 + cos_scattering * cos_scattering)
}

/// Phase function of dust (Cornette & Shanks 1992), 1/sr.
pub(super) fn dust_phase(cos_scattering: f64) -> f64 {
    const G: f64 = DUST_ASYMMETRY;
    let distance = 1.0 + G * G - 2.0 * G * cos_scattering;
    let denominator = (2.0 + G * G) * distance * distance.sqrt();
    3.0 / (8.0 * PI) * (1.0 - G * G) * (1.0 + cos_scattering * cos_scattering) / denominator
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_up_the_optical_thickness_is_the_turbidity_times_that_of_molecules() {
        let thickness_at_560 = |turbidity: f64| {
            let atmosphere = Atmosphere::new(turbidity);
            let mut columns = atmosphere.columns_to_space(EARTH_RADIUS, 1.0);
            columns.ozone = 0.0;
            -atmosphere.transmittance(columns)[8].ln()
        };
        let molecules = thickness_at_560(1.0);
        assert!((molecules - 1.24062e-6 * 0.56_f64.powi(-4) * 8000.0).abs() < 1e-3 * molecules);
        let dust = thickness_at_560(3.0) - molecules;
        let expected = 2.0 * 1.24062e-6 * 0.55_f64.powi(-4) * 8000.0 * (0.56_f64 / 0.55).powf(-1.3);
        assert!((dust - expected).abs() < 1e-3 * expected, "{dust} {expected}");
    }

    #[test]
    fn tabulated_columns_are_those_of_the_integral() {
        let atmosphere = Atmosphere::new(2.0);
        for height in [0.0, 100.0, 3_000.0, 15_000.0] {
            for elevation in [0.5_f64, 2.0, 5.0, 20.0, 60.0, 90.0] {
                let (radius, cos_zenith) = (EARTH_RADIUS + height, elevation.to_radians().sin());
                let distance = distance_to_space(radius, cos_zenith);
                let fine = integrate_columns(radius, cos_zenith, distance, 5_000);
                let table = atmosphere.columns_to_space(radius, cos_zenith);
                let error = table.combine(fine, |a, b| (a - b).abs() / b.max(1.0));
                assert!(error.molecules < 0.02, "{height} {elevation} {table:?} {fine:?}");
                assert!(height > 5_000.0 || error.dust < 0.02, "{height} {elevation} {table:?} {fine:?}");
                assert!(error.ozone < 0.02, "{height} {elevation} {table:?} {fine:?}");
            }
        }
    }

    #[test]
    fn phase_functions_integrate_to_one() {
        for phase in [molecular_phase, dust_phase] {
            let count = 100_000;
            let mean: f64 =
                (0..count).map(|i| phase(-1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(count))).sum::<f64>()
                    / f64::from(count);
            assert!((4.0 * PI * mean - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn no_sun_shines_through_the_earth() {
        let atmosphere = Atmosphere::new(2.0);
        assert_eq!(atmosphere.sun_transmittance(EARTH_RADIUS + 10.0, -0.1), [0.0; COUNT]);
        assert!(atmosphere.sun_transmittance(EARTH_RADIUS + 50_000.0, -0.1)[15] > 0.1);
    }
}
