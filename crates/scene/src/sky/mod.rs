//! The clear sky of the Earth from first principles.
//!
//! A spherical Earth under air molecules, dust and ozone (`atmosphere`); sunlight scattered once is
//! integrated along each line of sight, sunlight scattered more often is taken as isotropic and summed as a
//! geometric series (`multiple_scattering`; Hillaire 2020, "A Scalable and Production Ready Sky and
//! Atmosphere Rendering Technique"). Everything is computed at 16 wavelengths and ends as linear Rec. 709
//! (`spectrum`). Refraction, polarisation and the moon are left out.
//!
//! # Unit
//! Radiance 1 is 100,000 lux / π = 31,831 cd/m²: the radiance of a white surface under the 100,000 lux that
//! stand for full sunlight in textbooks. At exposure 0 a white thing in the noon sun is therefore just white.
//!
//! # Cost
//! Below 0.2 s on one core for the tables and the picture of 1024 × 512 texels.

mod atmosphere;
mod multiple_scattering;
mod spectrum;
mod view;

pub use view::Sky;

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::Sky;
    use super::atmosphere::{Atmosphere, EARTH_RADIUS, distance_to_space, integrate_columns};
    use super::spectrum::ToRgb;
    use crate::description::SkyDescription;

    fn sky(sun_elevation: f64) -> (SkyDescription, Sky) {
        let description = SkyDescription { sun_elevation: Some(sun_elevation), ..SkyDescription::default() };
        let sky = Sky::new(&description);
        (description, sky)
    }

    fn luminance(rgb: DVec3) -> f64 {
        rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722))
    }

    /// Direction at an elevation and an azimuth from the sun's, degrees.
    fn beside_sun(description: &SkyDescription, elevation: f64, azimuth: f64) -> DVec3 {
        let (sin, cos) = elevation.to_radians().sin_cos();
        let sun = description.toward_sun();
        let forward = DVec3::new(sun.x, 0.0, sun.z).normalize();
        let right = forward.cross(DVec3::Y);
        let (sin_azimuth, cos_azimuth) = azimuth.to_radians().sin_cos();
        cos * (cos_azimuth * forward + sin_azimuth * right) + sin * DVec3::Y
    }

    #[test]
    fn the_sky_is_blue_overhead_and_brighter_and_whiter_at_the_horizon() {
        for elevation in [10.0, 30.0, 60.0] {
            let (description, sky) = sky(elevation);
            let zenith = sky.radiance(DVec3::Y);
            let horizon = sky.radiance(beside_sun(&description, 2.0, 90.0));
            assert!(zenith.z > 1.3 * zenith.y && zenith.y > 1.05 * zenith.x, "{elevation}: {zenith}");
            assert!(
                luminance(horizon) > 1.1 * luminance(sky.radiance(beside_sun(&description, 40.0, 135.0)))
            );
            assert!(horizon.z / horizon.x < zenith.z / zenith.x, "{elevation}: {horizon} {zenith}");
        }
    }

    #[test]
    fn a_clear_noon_has_the_light_that_is_measured() {
        // Clear days with the sun 60 degrees high: 85 to 105 klx direct, zenith sky of 2 to 8 kcd/m², and a
        // sky that gives 8 to 25 klx on the ground.
        let (_, sky) = sky(60.0);
        let to_lux = 100_000.0 / std::f64::consts::PI;
        let direct = luminance(sky.sun_irradiance()) * to_lux;
        assert!((85_000.0..105_000.0).contains(&direct), "{direct}");
        let zenith = luminance(sky.radiance(DVec3::Y)) * to_lux;
        assert!((2_000.0..8_000.0).contains(&zenith), "{zenith}");
        let diffuse = ground_illuminance(&sky) * to_lux;
        assert!((8_000.0..25_000.0).contains(&diffuse), "{diffuse}");
    }

    fn ground_illuminance(sky: &Sky) -> f64 {
        let image = sky.to_image();
        let (width, height) = (image.width() as f64, image.height() as f64);
        let mut sum = 0.0;
        for row in 0..image.height() / 2 {
            let polar = std::f64::consts::PI * (row as f64 + 0.5) / height;
            let weight = polar.sin() * polar.cos() * 2.0 * std::f64::consts::PI.powi(2) / (width * height);
            sum += (0..image.width()).map(|column| luminance(image.texel(column, row)) * weight).sum::<f64>();
        }
        sum
    }

    #[test]
    fn a_low_sun_is_warm_and_dim_and_a_set_sun_is_dark() {
        let (_, noon) = sky(60.0);
        let (_, evening) = sky(2.0);
        let (noon, low) = (noon.sun_irradiance(), evening.sun_irradiance());
        assert!(low.x / low.y > 2.0 * noon.x / noon.y, "{low} {noon}");
        assert!(luminance(low) < 0.1 * luminance(noon));
        let (_, night) = sky(-3.0);
        assert_eq!(night.sun_irradiance(), DVec3::ZERO);
        let zenith = night.radiance(DVec3::Y);
        assert!(luminance(zenith) > 0.0 && luminance(zenith) < 0.1 * luminance(evening.radiance(DVec3::Y)));
    }

    #[test]
    fn the_sun_is_weakened_as_beers_law_says() {
        for elevation in [5.0_f64, 30.0, 90.0] {
            let (description, sky) = sky(elevation);
            let (radius, cos_zenith) = (EARTH_RADIUS + description.altitude, elevation.to_radians().sin());
            let columns = integrate_columns(radius, cos_zenith, distance_to_space(radius, cos_zenith), 5_000);
            let beer = Atmosphere::new(description.turbidity).transmittance(columns);
            let expected = ToRgb::new().convert(&beer);
            let error = ((sky.sun_irradiance() - expected) / expected).abs().max_element();
            assert!(error < 0.03, "{elevation}: {} {expected}", sky.sun_irradiance());
        }
    }

    #[test]
    fn the_sky_is_symmetric_about_the_suns_azimuth() {
        let (description, sky) = sky(20.0);
        for elevation in [-20.0, 0.5, 10.0, 45.0, 80.0] {
            for azimuth in [1.0, 30.0, 90.0, 170.0] {
                let left = sky.radiance(beside_sun(&description, elevation, -azimuth));
                let right = sky.radiance(beside_sun(&description, elevation, azimuth));
                assert!(
                    (left - right).length() < 1e-9 * left.length(),
                    "{elevation} {azimuth} {left} {right}"
                );
            }
        }
    }

    #[test]
    fn the_ground_is_lit_by_sun_and_sky_and_seen_through_the_air() {
        let (description, sky) = sky(40.0);
        let sun_on_ground = sky.sun_irradiance() * description.toward_sun().y;
        let irradiance = luminance(sun_on_ground) + ground_illuminance(&sky);
        let expected = irradiance * description.ground_albedo.channels().x / std::f64::consts::PI;
        let seen = luminance(sky.radiance(DVec3::NEG_Y));
        assert!((seen / expected - 1.0).abs() < 0.05, "{seen} {expected}");
    }

    #[test]
    fn nothing_is_negative_or_not_finite_at_any_setting() {
        for (elevation, turbidity, altitude) in [
            (-6.0, 20.0, 0.0),
            (0.0, 1.0, 20_000.0),
            (90.0, 20.0, 0.0),
            (0.0, 2.0, 0.0),
            (90.0, 1.0, 20_000.0),
        ] {
            let description = SkyDescription {
                sun_elevation: Some(elevation),
                turbidity,
                altitude,
                ..SkyDescription::default()
            };
            let sky = Sky::new(&description);
            for i in 0..2_000 {
                let direction =
                    crate::light::uv_to_direction(f64::from(i) * 0.618_034 % 1.0, f64::from(i) / 2_000.0);
                let radiance = sky.radiance(direction);
                assert!(
                    radiance.is_finite() && radiance.min_element() >= 0.0,
                    "{description:?} {direction} {radiance}"
                );
                assert!(luminance(radiance) < 1_000.0, "{description:?} {direction} {radiance}");
            }
        }
    }
}
