//! Lights: every sampler follows its density, every density integrates to one, and sampling is unbiased.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};
use tyndall_scene::description::{ImageFilter, ImageMapping};
use tyndall_scene::light::{
    ConstantLight, DistantLight, ImageLight, Light, LightImage, PointLight, SunLight,
    direction_to_equal_area, equal_area_to_direction, uv_to_direction,
};

/// PCG32 (O'Neill 2014) with a fixed seed.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        let mut next = || {
            let old = self.0;
            self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let shifted = (((old >> 18) ^ old) >> 27) as u32;
            shifted.rotate_right((old >> 59) as u32)
        };
        (f64::from(next()) * 4_294_967_296.0 + f64::from(next())) / 18_446_744_073_709_551_616.0
    }

    fn pair(&mut self) -> [f64; 2] {
        [self.uniform(), self.uniform()]
    }
}

/// A map of the unit square to directions, with the solid angle of its unit of area.
struct Chart {
    /// Place to direction and solid angle per area.
    direction: Box<dyn Fn(f64, f64) -> (DVec3, f64)>,
    /// Direction to place; none outside the chart.
    place: Box<dyn Fn(DVec3) -> Option<[f64; 2]>>,
    bins: [usize; 2],
}

/// The whole sphere, equirectangular, turned by `rotation` degrees as image lights are.
fn sphere(bins: [usize; 2], rotation: f64) -> Chart {
    let turn = DMat3::from_rotation_y(rotation.to_radians());
    Chart {
        direction: Box::new(move |s, t| (turn * uv_to_direction(s, t), 2.0 * PI * PI * (PI * t).sin())),
        place: Box::new(move |direction| {
            Some(
                tyndall_scene::light::direction_to_uv(turn.transpose() * direction)
                    .map(|at| at.min(1.0 - 1e-12)),
            )
        }),
        bins,
    }
}

/// The whole sphere, as pictures of equal areas have it.
fn square(bins: [usize; 2], orientation: DMat3) -> Chart {
    Chart {
        direction: Box::new(move |s, t| (orientation * equal_area_to_direction(s, t), 4.0 * PI)),
        place: Box::new(move |direction| {
            let place = direction_to_equal_area(orientation.transpose() * direction);
            Some(place.map(|at| at.min(1.0 - 1e-12)))
        }),
        bins,
    }
}

/// The cone of half angle `half_angle` (radians) about an axis.
fn cone(axis: DVec3, half_angle: f64, bins: [usize; 2]) -> Chart {
    let (across, other) = axis.any_orthonormal_pair();
    let depth = 2.0 * (0.5 * half_angle).sin().powi(2);
    Chart {
        direction: Box::new(move |s, t| {
            let below = t * depth;
            let sin = (below * (2.0 - below)).sqrt();
            let (sin_azimuth, cos_azimuth) = (TAU * s).sin_cos();
            let sideways = sin * (cos_azimuth * across + sin_azimuth * other);
            (axis * (1.0 - below) + sideways, TAU * depth)
        }),
        place: Box::new(move |direction| {
            let s = direction.dot(other).atan2(direction.dot(across)) / TAU;
            let t = 0.5 * (direction - axis).length_squared() / depth;
            (t < 1.0).then_some([s.rem_euclid(1.0).min(1.0 - 1e-12), t])
        }),
        bins,
    }
}

/// Integrals of the density over the bins of a chart.
fn bin_probabilities(light: &Light, chart: &Chart) -> Vec<f64> {
    const FINE: usize = 16;
    let [columns, rows] = chart.bins;
    let mut probabilities = vec![0.0; columns * rows];
    for row in 0..rows * FINE {
        for column in 0..columns * FINE {
            let s = (column as f64 + 0.5) / (columns * FINE) as f64;
            let t = (row as f64 + 0.5) / (rows * FINE) as f64;
            let (direction, solid_angle) = (chart.direction)(s, t);
            probabilities[row / FINE * columns + column / FINE] +=
                light.pdf(direction) * solid_angle / (columns * rows * FINE * FINE) as f64;
        }
    }
    probabilities
}

/// Probability of a χ² at least this large (Wilson & Hilferty 1931 and the normal tail).
fn chi_square_tail(statistic: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    let z = ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    // Abramowitz & Stegun 26.2.17.
    let t = 1.0 / (1.0 + 0.231_641_9 * z.abs());
    let polynomial = t
        * (0.319_381_53
            + t * (-0.356_563_782 + t * (1.781_477_937 + t * (-1.821_255_978 + t * 1.330_274_429))));
    let tail = (-0.5 * z * z).exp() / TAU.sqrt() * polynomial;
    if z > 0.0 { tail } else { 1.0 - tail }
}

/// Holds a sampler against its density: χ² over the chart's bins, and the sample's own pdf and radiance.
fn check_sampler(name: &str, light: &Light, chart: &Chart) {
    const COUNT: usize = 200_000;
    let probabilities = bin_probabilities(light, chart);
    let total: f64 = probabilities.iter().sum();
    assert!((total - 1.0).abs() < 1e-3, "{name}: the pdf integrates to {total}");

    let mut random = Random(7);
    let mut counts = vec![0_usize; probabilities.len()];
    for _ in 0..COUNT {
        let sample = light.sample(DVec3::ZERO, random.pair());
        assert!((sample.toward.length() - 1.0).abs() < 1e-9 && !sample.is_delta, "{name}: {sample:?}");
        assert!(sample.pdf > 0.0 && sample.distance == f64::INFINITY, "{name}: {sample:?}");
        if let Some([s, t]) = (chart.place)(sample.toward) {
            let [columns, rows] = chart.bins;
            counts[(t * rows as f64) as usize * columns + (s * columns as f64) as usize] += 1;
        }
    }
    // Bins with few expected counts are put together.
    let (mut statistic, mut used, mut rest) = (0.0, 0, (0.0, 0.0));
    let mut add = |expected: f64, observed: f64| {
        statistic += (observed - expected).powi(2) / expected;
        used += 1;
    };
    for (probability, count) in probabilities.iter().zip(&counts) {
        let expected = probability / total * COUNT as f64;
        if expected >= 5.0 {
            add(expected, *count as f64);
        } else {
            rest = (rest.0 + expected, rest.1 + *count as f64);
        }
    }
    if rest.0 > 0.0 {
        add(rest.0, rest.1);
    } else {
        assert!(rest.1 == 0.0, "{name}: {} samples where the pdf is 0", rest.1);
    }
    let tail = chi_square_tail(statistic, f64::from(used - 1));
    assert!(tail > 1e-4, "{name}: χ² = {statistic} with {used} bins, p = {tail}");
}

/// The mean of radiance over pdf is the integral of the radiance, which a fine sum over a chart gives as
/// well.
fn check_unbiased(name: &str, light: &Light, chart: &Chart, tolerance: f64) {
    const COUNT: usize = 400_000;
    let mut random = Random(11);
    // A test function that is not constant, so that the direction matters.
    let weight = |direction: DVec3| 1.0 + direction.dot(DVec3::new(0.3, 0.5, -0.4));
    let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
    for _ in 0..COUNT {
        let sample = light.sample(DVec3::ZERO, random.pair());
        let value = sample.radiance_over_pdf * weight(sample.toward);
        let looked_up = light.radiance(sample.toward) / sample.pdf * weight(sample.toward);
        assert!(
            (value - looked_up).length() <= 1e-6 * value.length().max(1e-12),
            "{name}: {value} {looked_up}"
        );
        sum += value;
        squares += value * value;
    }
    let mean = sum / COUNT as f64;
    let standard_error = ((squares / COUNT as f64 - mean * mean).max(DVec3::ZERO) / COUNT as f64).powf(0.5);

    // A multiple of the pictures' widths and heights: cells of the sum do not straddle texels.
    let fine = 1536;
    let mut integral = DVec3::ZERO;
    for row in 0..fine {
        for column in 0..fine {
            let place = |k: usize| (k as f64 + 0.5) / fine as f64;
            let (direction, solid_angle) = (chart.direction)(place(column), place(row));
            integral += light.radiance(direction) * (weight(direction) * solid_angle / (fine * fine) as f64);
        }
    }
    for channel in 0..3 {
        let difference = (mean[channel] - integral[channel]).abs();
        let allowed = 4.5 * standard_error[channel] + tolerance * integral[channel];
        assert!(difference <= allowed, "{name}: {mean} {integral} ± {standard_error}");
    }
}

/// A picture of random texels with black areas and one bright spot.
fn test_image(width: usize, height: usize) -> LightImage {
    let mut random = Random(3);
    let mut texels: Vec<[f32; 3]> = (0..width * height)
        .map(|index| {
            let is_black = index % width < width / 3 || index / width == 2;
            std::array::from_fn(|_| if is_black { 0.0 } else { random.uniform() as f32 })
        })
        .collect();
    texels[height / 2 * width + width / 2] = [200.0, 150.0, 100.0];
    LightImage::new(width, height, texels).unwrap()
}

#[test]
fn the_constant_light_is_sampled_as_its_pdf_says() {
    let light = Light::Constant(ConstantLight::new(DVec3::new(1.0, 2.0, 3.0)));
    check_sampler("constant", &light, &sphere([32, 16], 0.0));
    check_unbiased("constant", &light, &sphere([32, 16], 0.0), 1e-5);
}

#[test]
fn image_lights_are_sampled_as_their_pdf_says() {
    for (filter, rotation) in
        [(ImageFilter::Nearest, 0.0), (ImageFilter::Bilinear, 90.0), (ImageFilter::Bilinear, -33.0)]
    {
        let name = format!("{filter:?} turned by {rotation}");
        let light = Light::Image(ImageLight::new(test_image(24, 16), filter, 2.0, rotation));
        check_sampler(&name, &light, &sphere([24, 16], rotation));
        check_unbiased(&name, &light, &sphere([24, 16], rotation), 2e-5);
    }
    for (width, height) in [(1, 1), (2, 1), (1, 5), (3, 2)] {
        let texels = vec![[1.0, 0.5, 0.25]; width * height];
        let image = LightImage::new(width, height, texels).unwrap();
        let light = Light::Image(ImageLight::new(image, ImageFilter::Bilinear, 1.0, 0.0));
        check_sampler(&format!("{width} x {height}"), &light, &sphere([width * 4, height * 4], 0.0));
    }
}

#[test]
fn pictures_of_equal_areas_are_sampled_as_their_pdf_says() {
    let mirror = DMat3::from_rotation_x(0.7) * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    for (filter, orientation) in [
        (ImageFilter::Nearest, mirror),
        (ImageFilter::Bilinear, mirror),
        (ImageFilter::Bilinear, DMat3::IDENTITY),
    ] {
        let name = format!("{filter:?} in {orientation}");
        let mapping = ImageMapping::EqualArea;
        let light = Light::Image(ImageLight::mapped(test_image(16, 16), mapping, filter, 2.0, orientation));
        check_sampler(&name, &light, &square([16, 16], orientation));
        check_unbiased(&name, &light, &square([16, 16], orientation), 2e-5);
    }
    let image = LightImage::new(1, 1, vec![[2.0; 3]]).unwrap();
    let mapping = ImageMapping::EqualArea;
    let light = Light::Image(ImageLight::mapped(image, mapping, ImageFilter::Bilinear, 1.0, mirror));
    check_sampler("1 x 1", &light, &square([8, 8], mirror));
    assert!((light.selection_weight(1.0) / (8.0 * PI * PI) - 1.0).abs() < 1e-12);
}

/// Across the edges of the square the filter goes on where the sphere does: radiance has no seams.
#[test]
fn pictures_of_equal_areas_have_no_seams() {
    let n = 32;
    // A smooth function of the direction, as the picture shows it.
    let shape = |direction: DVec3| 2.0 + direction.dot(DVec3::new(0.6, -0.5, 0.4));
    let place = |k: usize| (k as f64 + 0.5) / n as f64;
    let texel = |k: usize| [shape(equal_area_to_direction(place(k % n), place(k / n))) as f32; 3];
    let image = LightImage::new(n, n, (0..n * n).map(texel).collect()).unwrap();
    let (mapping, filter) = (ImageMapping::EqualArea, ImageFilter::Bilinear);
    let light = Light::Image(ImageLight::mapped(image, mapping, filter, 1.0, DMat3::IDENTITY));
    let mut random = Random(21);
    for _ in 0..20_000 {
        let [u, v] = random.pair();
        let direction = uv_to_direction(u, v);
        let difference = light.radiance(direction).x - shape(direction);
        assert!(difference.abs() < 0.05, "{direction}: {difference}");
    }
}

#[test]
fn no_radiance_has_pdf_zero() {
    let mut texels = vec![[0.0; 3]; 32 * 16];
    texels[5 * 32] = [0.0, 0.0, 1e-30];
    texels[9 * 32 + 31] = [1e30, 0.0, 0.0];
    texels[0] = [1.0, 0.0, 0.0];
    for filter in [ImageFilter::Nearest, ImageFilter::Bilinear] {
        let image = LightImage::new(32, 16, texels.clone()).unwrap();
        let light = Light::Image(ImageLight::new(image, filter, 1.0, 20.0));
        let mut random = Random(5);
        for _ in 0..200_000 {
            let [u, v] = random.pair();
            let direction = uv_to_direction(u, v);
            let has_radiance = light.radiance(direction).max_element() > 0.0;
            assert!(!has_radiance || light.pdf(direction) > 0.0, "{filter:?} {direction}");
        }
    }
}

#[test]
fn the_total_of_an_image_is_the_sum_of_radiance_times_solid_angle() {
    let image = test_image(64, 32);
    let mut total = DVec3::ZERO;
    for row in 0..32 {
        let edge = |k: usize| (PI * k as f64 / 32.0).cos();
        let solid_angle = TAU / 64.0 * (edge(row) - edge(row + 1));
        total += (0..64).map(|column| image.texel(column, row)).sum::<DVec3>() * solid_angle;
    }
    let light = Light::Image(ImageLight::new(image, ImageFilter::Nearest, 1.0, 0.0));
    let expected = total.element_sum() / 3.0 * PI * 4.0;
    assert!((light.selection_weight(2.0) / expected - 1.0).abs() < 1e-12);

    // For a grey picture without a filter importance sampling is perfect: each sample is the total itself.
    let grey: Vec<[f32; 3]> = (0..8 * 4).map(|i| [(1 + i % 7) as f32; 3]).collect();
    let light =
        Light::Image(ImageLight::new(LightImage::new(8, 4, grey).unwrap(), ImageFilter::Nearest, 1.0, 0.0));
    let total = light.selection_weight(1.0) / PI;
    let mut random = Random(9);
    for _ in 0..1_000 {
        let sample = light.sample(DVec3::ZERO, random.pair());
        assert!((sample.radiance_over_pdf.x / total - 1.0).abs() < 1e-6, "{sample:?} {total}");
    }
}

#[test]
fn a_black_image_gives_no_light_and_no_nan() {
    let image = LightImage::new(4, 2, vec![[0.0; 3]; 8]).unwrap();
    let light = Light::Image(ImageLight::new(image, ImageFilter::Bilinear, 1.0, 0.0));
    check_sampler("black", &light, &sphere([8, 8], 0.0));
    assert_eq!(light.sample(DVec3::ZERO, [0.3, 0.4]).radiance_over_pdf, DVec3::ZERO);
    assert_eq!(light.selection_weight(1.0), 0.0);
}

#[test]
fn an_image_turned_by_90_degrees_shows_north_in_the_west() {
    let mut texels = vec![[0.0; 3]; 8 * 4];
    for row in 0..4 {
        for column in 3..5 {
            texels[row * 8 + column] = [1.0; 3];
        }
    }
    let image = LightImage::new(8, 4, texels).unwrap();
    let light = ImageLight::new(image, ImageFilter::Nearest, 1.0, 90.0);
    let light = Light::Image(light);
    assert_eq!(light.radiance(DVec3::NEG_X), DVec3::ONE);
    assert_eq!(light.radiance(DVec3::NEG_Z), DVec3::ZERO);
    assert_eq!(light.radiance(DVec3::X), DVec3::ZERO);
}

#[test]
fn the_sun_is_sampled_as_its_pdf_says_and_gives_its_irradiance() {
    let toward = DVec3::new(0.3, 0.8, -0.2).normalize();
    let irradiance = DVec3::new(3.0, 2.5, 2.0);
    for diameter in [0.533_f64, 10.0, 90.0] {
        let light = Light::Sun(SunLight::new(toward, irradiance, diameter));
        let chart = cone(toward, 0.5 * diameter.to_radians(), [16, 8]);
        check_sampler(&format!("sun of {diameter}"), &light, &chart);
        check_unbiased(&format!("sun of {diameter}"), &light, &chart, 1e-5);
        let mut random = Random(13);
        let mut mean = DVec3::ZERO;
        for _ in 0..100_000 {
            let sample = light.sample(DVec3::ZERO, random.pair());
            mean += sample.radiance_over_pdf * sample.toward.dot(toward) / 1e5;
        }
        assert!(((mean - irradiance) / irradiance).abs().max_element() < 2e-3, "{diameter}: {mean}");
        assert_eq!(light.radiance(-toward), DVec3::ZERO);
        assert_eq!(light.pdf(-toward), 0.0);
    }
}

#[test]
fn delta_lights_give_their_irradiance_and_are_found_by_sampling_only() {
    let distant = Light::Distant(DistantLight::new(DVec3::new(0.0, -2.0, 0.0), DVec3::splat(3.0)));
    let sample = distant.sample(DVec3::ONE, [0.1, 0.2]);
    assert_eq!(
        (sample.toward, sample.radiance_over_pdf, sample.is_delta),
        (DVec3::Y, DVec3::splat(3.0), true)
    );

    let point = Light::Point(PointLight::new(DVec3::new(0.0, 0.0, 4.0), DVec3::splat(8.0)));
    let sample = point.sample(DVec3::new(0.0, 0.0, 2.0), [0.1, 0.2]);
    assert_eq!((sample.toward, sample.distance), (DVec3::Z, 2.0));
    assert_eq!((sample.radiance_over_pdf, sample.is_delta), (DVec3::splat(2.0), true));
    assert_eq!(point.sample(DVec3::new(0.0, 0.0, 4.0), [0.1, 0.2]).radiance_over_pdf, DVec3::ZERO);

    for light in [distant, point] {
        assert_eq!((light.radiance(DVec3::Y), light.pdf(DVec3::Y)), (DVec3::ZERO, 0.0));
    }
}
