//! Light scattered twice and more often, taken as isotropic.
//!
//! Hillaire 2020, section 5.5: with L₂ the mean over all directions of sunlight scattered once
//! (isotropically) or reflected by the ground, and f the mean over all directions of ∫ σs T dt, the fraction
//! of an isotropic unit radiance that comes back, every further order is f times the one before, so that the
//! radiance in the scattering integral is Ψ = L₂ (1 + f + f² + …) = L₂ / (1 - f).

use std::f64::consts::PI;

use glam::DVec3;

use super::atmosphere::{
    ATMOSPHERE_HEIGHT, Amounts, Atmosphere, EARTH_RADIUS, densities, distance_to_ground, distance_to_space,
    meets_ground, radius_along,
};
use super::spectrum::{self, COUNT, Spectrum};

const HEIGHTS: usize = 12;
const SUNS: usize = 15;
const DIRECTIONS: usize = 48;
const STEPS: usize = 16;
/// The sun's height changes along a line of sight by the Earth's curvature: up to 10 degrees to the end of
/// the air, and the points that lines of sight meet are no farther.
const SUN_RANGE: f64 = 11.0 * PI / 180.0;

/// Ψ by height and by the sun's zenith angle in a range about that at the viewer.
pub(super) struct MultipleScattering {
    least_zenith_angle: f64,
    radiance: Vec<Spectrum>,
}

impl MultipleScattering {
    /// Tables for a sun at `zenith_angle` (radians) as the viewer sees it.
    pub(super) fn new(atmosphere: &Atmosphere, ground_albedo: &Spectrum, zenith_angle: f64) -> Self {
        let least_zenith_angle = zenith_angle - SUN_RANGE;
        let mut radiance = Vec::with_capacity(HEIGHTS * SUNS);
        for i in 0..HEIGHTS {
            let height = ATMOSPHERE_HEIGHT * (i as f64 / (HEIGHTS - 1) as f64).powi(2);
            for j in 0..SUNS {
                let angle = least_zenith_angle + 2.0 * SUN_RANGE * j as f64 / (SUNS - 1) as f64;
                radiance.push(series(atmosphere, ground_albedo, EARTH_RADIUS + height, angle));
            }
        }
        Self { least_zenith_angle, radiance }
    }

    /// Ψ at a height (m), the sun at a zenith angle (radians), in units of solar irradiance.
    pub(super) fn radiance(&self, height: f64, zenith_angle: f64) -> Spectrum {
        let x = (height / ATMOSPHERE_HEIGHT).clamp(0.0, 1.0).sqrt() * (HEIGHTS - 1) as f64;
        let y = ((zenith_angle - self.least_zenith_angle) / (2.0 * SUN_RANGE)).clamp(0.0, 1.0)
            * (SUNS - 1) as f64;
        let (i, j) = ((x as usize).min(HEIGHTS - 2), (y as usize).min(SUNS - 2));
        let (x, y) = (x - i as f64, y - j as f64);
        let corners = [
            (i, j, (1.0 - x) * (1.0 - y)),
            (i, j + 1, (1.0 - x) * y),
            (i + 1, j, x * (1.0 - y)),
            (i + 1, j + 1, x * y),
        ];
        let mut sum = [0.0; COUNT];
        for (i, j, weight) in corners {
            for (sum, value) in sum.iter_mut().zip(&self.radiance[i * SUNS + j]) {
                *sum += weight * value;
            }
        }
        sum
    }
}

fn series(atmosphere: &Atmosphere, ground_albedo: &Spectrum, radius: f64, sun_zenith_angle: f64) -> Spectrum {
    let (sin, cos) = libm::sincos(sun_zenith_angle);
    let toward_sun = DVec3::new(sin, cos, 0.0);
    let mut second_order = [0.0; COUNT];
    let mut returned = [0.0; COUNT];
    for k in 0..DIRECTIONS {
        // A Fibonacci lattice covers the sphere evenly.
        let y = 1.0 - 2.0 * (k as f64 + 0.5) / DIRECTIONS as f64;
        let azimuth = PI * (1.0 + 5.0_f64.sqrt()) * k as f64;
        let horizontal = (1.0 - y * y).sqrt();
        let direction = DVec3::new(horizontal * libm::cos(azimuth), y, horizontal * libm::sin(azimuth));
        add_line(atmosphere, ground_albedo, radius, toward_sun, direction, &mut second_order, &mut returned);
    }
    spectrum::each(|i| second_order[i] / DIRECTIONS as f64 / (1.0 - returned[i] / DIRECTIONS as f64))
}

fn add_line(
    atmosphere: &Atmosphere,
    ground_albedo: &Spectrum,
    radius: f64,
    toward_sun: DVec3,
    direction: DVec3,
    second_order: &mut Spectrum,
    returned: &mut Spectrum,
) {
    let origin = DVec3::new(0.0, radius, 0.0);
    let ends_at_ground = meets_ground(radius, direction.y);
    let distance = if ends_at_ground {
        distance_to_ground(radius, direction.y)
    } else {
        distance_to_space(radius, direction.y)
    };
    let mut columns = Amounts::default();
    let edge = |k: usize| distance * (k as f64 / STEPS as f64).powi(2);
    for step in 0..STEPS {
        let (near, far) = (edge(step), edge(step + 1));
        let (along, length) = (0.5 * (near + far), far - near);
        let here = radius_along(radius, direction.y, along);
        let amounts = densities(here - EARTH_RADIUS);
        let coefficients = atmosphere.coefficients(amounts);
        let transmittance = atmosphere.transmittance(columns.plus(amounts, 0.5 * length));
        columns = columns.plus(amounts, length);
        let cos_sun = toward_sun.dot(origin + direction * along) / here;
        let sun = atmosphere.sun_transmittance(here, cos_sun);
        for i in 0..COUNT {
            let scattering = coefficients.molecular_scattering[i] + coefficients.dust_scattering[i];
            let scattered = transmittance[i] * scattering * length;
            returned[i] += scattered;
            second_order[i] += scattered * sun[i] / (4.0 * PI);
        }
    }
    if ends_at_ground {
        let cos_sun = toward_sun.dot(origin + direction * distance) / EARTH_RADIUS;
        if cos_sun > 0.0 {
            let transmittance = atmosphere.transmittance(columns);
            let sun = atmosphere.sun_transmittance(EARTH_RADIUS, cos_sun);
            for i in 0..COUNT {
                second_order[i] += transmittance[i] * sun[i] * cos_sun * ground_albedo[i] / PI;
            }
        }
    }
}
