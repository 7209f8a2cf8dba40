//! What a viewer sees in each direction: single scattering along the line of sight, and the ground through
//! the air.
//!
//! L = ∫ T (σm pm(ν) S + σd pd(ν) S + (σm + σd) Ψ) dt + T Lg, with the sun's transmittance S, the cosine ν
//! between line of sight and sun, and below the horizon the lit ground Lg = albedo / π · E. The strongly
//! forward phase function of dust is left out of the table and put back for each direction, so that a coarse
//! table (finest at the horizon) is enough.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::atmosphere::{
    Atmosphere, EARTH_RADIUS, densities, distance_to_ground, distance_to_space, dust_phase, molecular_phase,
    radius_along,
};
use super::multiple_scattering::MultipleScattering;
use super::spectrum::{self, COUNT, Spectrum, ToRgb};
use crate::description::SkyDescription;
use crate::light::{LightImage, uv_to_direction};

const AZIMUTHS: usize = 25;
const ELEVATIONS_OF_SKY: usize = 48;
const ELEVATIONS_OF_GROUND: usize = 16;
const STEPS: usize = 40;
/// Lines of sight to the ground are short or bright at their end.
const STEPS_TO_GROUND: usize = 16;
const IMAGE_SIZE: [usize; 2] = [1024, 512];
/// A viewer on the ground itself would have no air before the ground.
const LEAST_ALTITUDE: f64 = 1.0;

/// The clear sky over a viewer. Radiance in units of 31,831 cd/m².
#[derive(Debug, Clone)]
pub struct Sky {
    toward_sun: DVec3,
    /// Horizontal direction to the sun.
    sun_azimuth: DVec3,
    sun_irradiance: DVec3,
    /// Elevation of the horizon, radians; below 0 for a viewer above the ground.
    horizon: f64,
    sky: Vec<Sighted>,
    ground: Vec<Sighted>,
}

/// What is seen along a line of sight.
#[derive(Debug, Clone, Copy)]
struct Sighted {
    /// All radiance but what follows.
    radiance: DVec3,
    /// Sunlight scattered once by dust, over dust's phase function.
    dust: DVec3,
}

impl Sky {
    /// The sky of a description.
    pub fn new(description: &SkyDescription) -> Self {
        let toward_sun = description.toward_sun();
        let radius = EARTH_RADIUS + description.altitude.max(LEAST_ALTITUDE);
        let air = Air::new(description);

        let to_rgb = ToRgb::new();
        let scaled = |spectrum: &Spectrum| to_rgb.convert(spectrum) * description.intensity;
        let sun_irradiance = scaled(&air.atmosphere.sun_transmittance(radius, toward_sun.y));
        let horizon = -libm::acos((EARTH_RADIUS / radius).min(1.0));
        let sky_irradiance = air.sky_irradiance();
        let sky =
            air.table(radius, ELEVATIONS_OF_SKY, |t| horizon + (FRAC_PI_2 - horizon) * t * t, None, scaled);
        let to_nadir = |t: f64| horizon - (FRAC_PI_2 + horizon) * t * t;
        let ground = air.table(radius, ELEVATIONS_OF_GROUND, to_nadir, Some(&sky_irradiance), scaled);
        let sun_azimuth = DVec3::new(toward_sun.x, 0.0, toward_sun.z).normalize_or(DVec3::NEG_Z);
        Self { toward_sun, sun_azimuth, sun_irradiance, horizon, sky, ground }
    }

    /// Irradiance by the sun's disc on a surface that faces it; 0 when the sun is below the horizon.
    pub fn sun_irradiance(&self) -> DVec3 {
        self.sun_irradiance
    }

    /// Radiance from a direction (unit vector), the sun's disc left out.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        let elevation = libm::asin(direction.y.clamp(-1.0, 1.0));
        let horizontal = DVec3::new(direction.x, 0.0, direction.z).normalize_or(self.sun_azimuth);
        let azimuth = libm::acos(horizontal.dot(self.sun_azimuth).clamp(-1.0, 1.0));

        let (table, span) = if elevation >= self.horizon {
            (&self.sky, FRAC_PI_2 - self.horizon)
        } else {
            (&self.ground, FRAC_PI_2 + self.horizon)
        };
        let elevations = table.len() / AZIMUTHS;
        let x = ((elevation - self.horizon).abs() / span).clamp(0.0, 1.0).sqrt() * (elevations - 1) as f64;
        let y = azimuth / PI * (AZIMUTHS - 1) as f64;
        let (i, j) = ((x as usize).min(elevations - 2), (y as usize).min(AZIMUTHS - 2));
        let (x, y) = (x - i as f64, y - j as f64);
        let interpolate = |of: fn(&Sighted) -> DVec3| {
            let at = |i: usize, j: usize| of(&table[i * AZIMUTHS + j]);
            at(i, j).lerp(at(i, j + 1), y).lerp(at(i + 1, j).lerp(at(i + 1, j + 1), y), x)
        };
        interpolate(|sighted| sighted.radiance)
            + dust_phase(direction.dot(self.toward_sun)) * interpolate(|sighted| sighted.dust)
    }

    /// The sky as an equirectangular picture.
    pub fn to_image(&self) -> LightImage {
        let [width, height] = IMAGE_SIZE;
        let mut texels = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let [u, v] =
                    [(column, width), (row, height)].map(|(at, count)| (at as f64 + 0.5) / count as f64);
                texels.push(self.radiance(uv_to_direction(u, v)).as_vec3().to_array());
            }
        }
        LightImage::mended(width, height, texels).0
    }
}

/// The lit air in a frame whose y is the viewer's vertical and whose x is the sun's azimuth.
struct Air {
    atmosphere: Atmosphere,
    multiple: MultipleScattering,
    sun: DVec3,
    ground_albedo: Spectrum,
}

impl Air {
    fn new(description: &SkyDescription) -> Self {
        let cos_zenith = description.toward_sun().y.clamp(-1.0, 1.0);
        let ground_albedo = spectrum::reflectance(description.ground_albedo.channels());
        let atmosphere = Atmosphere::new(description.turbidity);
        let multiple = MultipleScattering::new(&atmosphere, &ground_albedo, libm::acos(cos_zenith));
        let sun = DVec3::new((1.0 - cos_zenith * cos_zenith).sqrt(), cos_zenith, 0.0);
        Self { atmosphere, multiple, sun, ground_albedo }
    }

    /// What is seen at elevations by a parameter from 0 to 1, each at azimuths from the sun's to the opposite
    /// one.
    fn table(
        &self,
        radius: f64,
        elevations: usize,
        elevation_at: impl Fn(f64) -> f64,
        sky_irradiance: Option<&Spectrum>,
        to_rgb: impl Fn(&Spectrum) -> DVec3,
    ) -> Vec<Sighted> {
        let steps = if sky_irradiance.is_some() { STEPS_TO_GROUND } else { STEPS };
        let mut table = Vec::with_capacity(elevations * AZIMUTHS);
        for i in 0..elevations {
            let elevation = elevation_at(i as f64 / (elevations - 1) as f64);
            for j in 0..AZIMUTHS {
                let azimuth = PI * j as f64 / (AZIMUTHS - 1) as f64;
                let (radiance, dust) = self.line_of_sight(radius, elevation, azimuth, sky_irradiance, steps);
                table.push(Sighted { radiance: to_rgb(&radiance), dust: to_rgb(&dust) });
            }
        }
        table
    }

    /// Radiance along a line of sight without and only with the sunlight that dust scattered once, the latter
    /// over dust's phase function. With the sky's irradiance of the ground, the line ends there; without, in
    /// space.
    fn line_of_sight(
        &self,
        radius: f64,
        elevation: f64,
        azimuth: f64,
        sky_irradiance: Option<&Spectrum>,
        steps: usize,
    ) -> (Spectrum, Spectrum) {
        let (sin_elevation, cos_elevation) = libm::sincos(elevation);
        let direction =
            DVec3::new(cos_elevation * libm::cos(azimuth), sin_elevation, cos_elevation * libm::sin(azimuth));
        let origin = DVec3::new(0.0, radius, 0.0);
        let distance = match sky_irradiance {
            Some(_) => distance_to_ground(radius, sin_elevation),
            None => distance_to_space(radius, sin_elevation),
        };
        let molecular_phase = molecular_phase(direction.dot(self.sun));
        let mut radiance = [0.0; COUNT];
        let mut dust = [0.0; COUNT];
        let mut transmittance = [1.0; COUNT];
        let edge = |k: usize| distance * (k as f64 / steps as f64).powi(2);
        for step in 0..steps {
            let (near, far) = (edge(step), edge(step + 1));
            let (along, length) = (0.5 * (near + far), far - near);
            let here = radius_along(radius, sin_elevation, along);
            let coefficients = self.atmosphere.coefficients(densities(here - EARTH_RADIUS));
            let cos_sun = self.sun.dot(origin + direction * along) / here;
            let sun = self.atmosphere.sun_transmittance(here, cos_sun);
            let multiple = self.multiple.radiance(here - EARTH_RADIUS, libm::acos(cos_sun.clamp(-1.0, 1.0)));
            for i in 0..COUNT {
                let (molecules, dusts) =
                    (coefficients.molecular_scattering[i], coefficients.dust_scattering[i]);
                let through = libm::exp(-coefficients.extinction[i] * length);
                // ∫ T dt over the step with its extinction constant.
                let reached = transmittance[i] * (1.0 - through) / coefficients.extinction[i].max(1e-300);
                radiance[i] +=
                    reached * (molecules * molecular_phase * sun[i] + (molecules + dusts) * multiple[i]);
                dust[i] += reached * dusts * sun[i];
                transmittance[i] *= through;
            }
        }
        if let Some(sky_irradiance) = sky_irradiance {
            let cos_sun = self.sun.dot(origin + direction * distance) / EARTH_RADIUS;
            let sun = self.atmosphere.sun_transmittance(EARTH_RADIUS, cos_sun);
            for i in 0..COUNT {
                let irradiance = sun[i] * cos_sun.max(0.0) + sky_irradiance[i];
                radiance[i] += transmittance[i] * self.ground_albedo[i] / PI * irradiance;
            }
        }
        (radiance, dust)
    }

    /// Irradiance of the ground by the sky alone.
    fn sky_irradiance(&self) -> Spectrum {
        const RINGS: usize = 12;
        const SECTORS: usize = 12;
        let mut irradiance = [0.0; COUNT];
        for ring in 0..RINGS {
            // Rings of equal ∫ cos θ dω: uniform in sin² of the zenith angle.
            let elevation = libm::asin((1.0 - (ring as f64 + 0.5) / RINGS as f64).sqrt());
            for sector in 0..SECTORS {
                let azimuth = PI * (sector as f64 + 0.5) / SECTORS as f64;
                let radius = EARTH_RADIUS + LEAST_ALTITUDE;
                let (radiance, dust) = self.line_of_sight(radius, elevation, azimuth, None, STEPS / 2);
                let cos_sun = libm::cos(elevation) * libm::cos(azimuth) * self.sun.x
                    + libm::sin(elevation) * self.sun.y;
                let phase = dust_phase(cos_sun);
                for i in 0..COUNT {
                    irradiance[i] += (radiance[i] + phase * dust[i]) * PI / (RINGS * SECTORS) as f64;
                }
            }
        }
        irradiance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_steps_along_the_line_of_sight_change_little() {
        for sun_elevation in [3.0, 40.0] {
            let description =
                SkyDescription { sun_elevation: Some(sun_elevation), ..SkyDescription::default() };
            let air = Air::new(&description);
            let radius = EARTH_RADIUS + description.altitude;
            let light_of_ground = air.sky_irradiance();
            for (elevation, ground, steps) in [
                (0.005, None, STEPS),
                (0.1, None, STEPS),
                (1.2, None, STEPS),
                (-0.01, Some(&light_of_ground), STEPS_TO_GROUND),
                (-0.3, Some(&light_of_ground), STEPS_TO_GROUND),
            ] {
                for azimuth in [0.0, 1.5, 3.0] {
                    let (coarse, coarse_dust) = air.line_of_sight(radius, elevation, azimuth, ground, steps);
                    let (fine, fine_dust) = air.line_of_sight(radius, elevation, azimuth, ground, 1_000);
                    for i in 0..COUNT {
                        let total = |radiance: &Spectrum, dust: &Spectrum| radiance[i] + 0.1 * dust[i];
                        let ratio = total(&coarse, &coarse_dust) / total(&fine, &fine_dust);
                        assert!(
                            (ratio - 1.0).abs() < 0.02,
                            "{sun_elevation} {elevation} {azimuth} {i}: {ratio}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn between_the_lines_of_the_table_the_sky_is_what_a_line_there_sees() {
        for sun_elevation in [3.0, 40.0] {
            let description = SkyDescription {
                sun_elevation: Some(sun_elevation),
                sun_azimuth: Some(0.0),
                ..Default::default()
            };
            let (sky, air, to_rgb) = (Sky::new(&description), Air::new(&description), ToRgb::new());
            let radius = EARTH_RADIUS + description.altitude;
            for i in 0..500 {
                let elevation = FRAC_PI_2 * (f64::from(i) / 500.0).powi(2);
                let azimuth = PI * (f64::from(i) * 0.618_034 % 1.0);
                let (radiance, dust) = air.line_of_sight(radius, elevation, azimuth, None, STEPS);
                // The sun is in the north (-z), azimuths count through east (+x).
                let (sin, cos) = elevation.sin_cos();
                let direction = DVec3::new(cos * azimuth.sin(), sin, -cos * azimuth.cos());
                let phase = dust_phase(direction.dot(description.toward_sun()));
                let expected = to_rgb.convert(&spectrum::each(|i| radiance[i] + phase * dust[i]));
                let error = (sky.radiance(direction) - expected).abs().max_element() / expected.max_element();
                assert!(error < 0.02, "{sun_elevation} {elevation} {azimuth}: {error}");
            }
        }
    }
}
