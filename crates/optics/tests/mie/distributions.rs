//! Averages over size distributions.

use serde_json::Value;
use std::f64::consts::TAU;
use tyndall_optics::mie::{Amount, MieAverage, MieCache, Particles, SizeDistribution, SizeLaw, Sphere};
use tyndall_optics::{Material, RefractiveIndex, Substance};

fn truth() -> Value {
    serde_json::from_str(include_str!("../truth/mie_distributions.json")).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

fn average(row: &Value) -> MieAverage {
    let law = match row["distribution"].as_str().unwrap() {
        "gamma_cloud" | "gamma_fog" => {
            SizeLaw::Gamma { r_eff: number(row, "r_eff"), v_eff: number(row, "v_eff") }
        }
        "lognormal_haze" => SizeLaw::LogNormal { r_g: number(row, "r_g"), sigma_g: number(row, "sigma_g") },
        "deirmendjian_C1" => SizeLaw::ModifiedGamma {
            r_mode: number(row, "r_mode"),
            alpha: number(row, "alpha"),
            gamma: number(row, "gamma"),
        },
        other => panic!("unknown distribution {other}"),
    };
    let wavelength = 1000.0 * number(row, "wavelength_um");
    let m = Material::Water.table().at(wavelength).unwrap();
    MieAverage::new(m, wavelength, &SizeDistribution::from(law)).unwrap()
}

/// The table at cos θ, linear between its rows, as it is sampled.
fn interpolate(rows: &[(f64, f64)], cos: f64) -> f64 {
    let below = rows.partition_point(|row| row.0 > cos).clamp(1, rows.len() - 1);
    let [left, right] = [rows[below - 1], rows[below]];
    left.1 + (cos - left.0) / (right.0 - left.0) * (right.1 - left.1)
}

fn angles(truth: &Value) -> Vec<f64> {
    truth["angles_deg"].as_array().unwrap().iter().map(|angle| angle.as_f64().unwrap()).collect()
}

/// ∫ f_p dω and ∫ f_p cos θ dω of a table that is linear between its rows.
fn moments(rows: &[(f64, f64)]) -> [f64; 2] {
    let mut moments = [0.0; 2];
    for pair in rows.windows(2) {
        let [(right, above), (left, below)] = [pair[0], pair[1]];
        let width = TAU * (right - left);
        moments[0] += width * 0.5 * (above + below);
        moments[1] += width / 6.0 * (below * (2.0 * left + right) + above * (left + 2.0 * right));
    }
    moments
}

/// Rows of the table, of which the whole proof takes all.
fn rows(truth: &Value) -> Vec<(&Value, &Value)> {
    let rows = truth["averages"].as_array().unwrap().iter().zip(truth["phase"].as_array().unwrap());
    let is_full = std::env::var("TYNDALL_PROOF").is_ok_and(|value| value == "full");
    // The clouds at two wavelengths are one claim, and the dearest.
    rows.filter(|(row, _)| is_full || row["distribution"] != "gamma_cloud" || row["wavelength_um"] == 0.55)
        .collect()
}

#[test]
fn averages_of_water_droplets_agree_with_the_table() {
    let truth = truth();
    let angles = angles(&truth);
    for (row, phase) in rows(&truth) {
        let average = average(row);
        for (value, key) in [
            (average.q_ext, "Qext"),
            (average.q_sca, "Qsca"),
            (average.g, "g"),
            (average.albedo(), "albedo"),
            (average.c_ext(), "sigma_ext_per_particle_um2"),
            (average.c_ext() / average.volume, "ext_per_volume_fraction_per_um"),
        ] {
            let error = (value / number(row, key) - 1.0).abs();
            assert!(error < 1e-4, "{key} {value} differs by {error:e} in {row}");
        }
        // Absorption of transparent droplets happens in resonances, which no grid of sizes has all of.
        let absorbed = (1.0 - average.q_abs / average.q_ext / number(row, "one_minus_albedo")).abs();
        assert!(absorbed < 0.15, "1 − albedo differs by {absorbed} in {row}");
        let table = average.rows();
        for (angle, expected) in angles.iter().zip(phase["p_per_sr"].as_array().unwrap()) {
            let (value, expected) =
                (interpolate(&table, angle.to_radians().cos()), expected.as_f64().unwrap());
            let tolerance = if *angle >= 179.0 { 0.02 } else { 0.01 };
            let error = (value / expected - 1.0).abs();
            assert!(error < tolerance, "p {value} differs by {error} at {angle}° in {row}");
        }
        let [integral, first] = moments(&table);
        assert!(
            (integral - 1.0).abs() < 2e-4 && (first / integral - average.g).abs() < 1e-4,
            "{integral} {first} {row}"
        );
    }
}

/// The wavelength of the I3RC's table is not stated; its g and its peak tell that it is 0.7 µm.
#[test]
fn the_c1_cloud_at_700_nm_is_that_of_the_i3rc() {
    let c1 = SizeLaw::ModifiedGamma { r_mode: 4.0, alpha: 6.0, gamma: 1.0 };
    let average = MieAverage::new(RefractiveIndex { n: 1.33, k: 0.0 }, 700.0, &c1.into()).unwrap();
    let phase = average.phase_function().unwrap();
    assert!((average.g - 0.84806).abs() < 1e-4, "{}", average.g);
    for (cos, expected, tolerance) in [(1.0, 136.25, 0.002), (0.0, 0.00329, 0.02), (-1.0, 0.0517, 0.02)] {
        let value = phase.value_at_cosine(cos);
        assert!((value / expected - 1.0).abs() < tolerance, "{value} at {cos}, not {expected}");
    }
}

/// Extinction in 1/km of 1 particle/cm³, albedo and g of Hess, Koepke & Schult 1998 (OPAC), printed with three to four
/// digits, by a Mie code of their own. Radii end at 20 µm.
#[test]
fn aerosols_have_the_optical_properties_of_opac() {
    let rows = [
        (Material::Soot, 0.0118, 2.0, 400.0, [8.612e-7, 0.2672, 0.396]),
        (Material::Soot, 0.0118, 2.0, 550.0, [5.540e-7, 0.2088, 0.336]),
        (Material::Sulfate, 0.0695, 2.03, 550.0, [7.120e-5, 1.0, 0.717]),
        (Material::Sulfate, 0.0695, 2.03, 700.0, [5.449e-5, 1.0, 0.702]),
        (Material::WaterSoluble, 0.0212, 2.24, 400.0, [6.011e-6, 0.9685, 0.639]),
        (Material::WaterSoluble, 0.0212, 2.24, 700.0, [2.649e-6, 0.9522, 0.589]),
        (Material::SeaSalt, 0.209, 2.03, 550.0, [1.028e-3, 1.0, 0.691]),
        (Material::Dust, 0.39, 2.0, 400.0, [2.969e-3, 0.7336, 0.803]),
        (Material::Dust, 0.39, 2.0, 700.0, [3.260e-3, 0.9228, 0.708]),
        (Material::Insoluble, 0.471, 2.51, 550.0, [8.496e-3, 0.73, 0.831]),
    ];
    for (material, r_g, sigma_g, wavelength, expected) in rows {
        let distribution =
            SizeDistribution { law: SizeLaw::LogNormal { r_g, sigma_g }, r_min: 0.0, r_max: 20.0 };
        let amount = Amount::NumberDensity(1.0);
        let particles = Particles { substance: Substance::Material(material), distribution, amount };
        let optics = particles.at(wavelength, &MieCache::none()).unwrap();
        let extinction = optics.mu_s + optics.mu_a;
        let found = [1000.0 * extinction, optics.mu_s / extinction, optics.average.g];
        for ((value, expected), tolerance) in found.iter().zip(expected).zip([0.002, 0.001, 0.007]) {
            let error = (value / expected - 1.0).abs();
            assert!(error < tolerance, "{value} is not {expected} of {material:?} at {wavelength} nm");
        }
    }
}

/// μ = 3 Q LWC/(4 ρ r_eff): the extinction of a cloud whose droplets are great (Q near 2).
#[test]
fn a_cloud_of_a_known_water_content_has_the_coefficient_of_its_effective_radius() {
    let water = Substance::Constant(RefractiveIndex { n: 1.33, k: 1e-4 });
    let distribution = SizeLaw::Gamma { r_eff: 3.0, v_eff: 0.1 }.into();
    let mass = Amount::Mass { concentration: 0.3, density: 1.0 };
    let at = |amount| {
        Particles { substance: water.clone(), distribution, amount }.at(550.0, &MieCache::none()).unwrap()
    };
    let cloud = at(mass);
    let extinction = cloud.mu_s + cloud.mu_a;
    let expected = 0.75 * cloud.average.q_ext * 0.3e-6 / 3e-6;
    assert!((extinction / expected - 1.0).abs() < 1e-6, "{extinction} {expected}");
    let by_volume = at(Amount::VolumeFraction(0.3e-6));
    let by_number = at(Amount::NumberDensity(1e-6 * mass.per_cubic_metre(cloud.average.volume)));
    for other in [by_volume, by_number] {
        assert!(
            (other.mu_s / cloud.mu_s - 1.0).abs() < 1e-12 && (other.mu_a / cloud.mu_a - 1.0).abs() < 1e-12
        );
    }
}

/// Steep, cut and single sizes against the mean over many explicit spheres, by the midpoint rule.
#[test]
fn cut_and_steep_distributions_are_integrated_within_their_limits() {
    let m = RefractiveIndex { n: 1.5, k: 0.01 };
    let wave_number = TAU / 0.55;
    let cases = [
        SizeDistribution { law: SizeLaw::PowerLaw { exponent: 4.0 }, r_min: 0.1, r_max: 5.0 },
        SizeDistribution { law: SizeLaw::LogNormal { r_g: 0.5, sigma_g: 2.5 }, r_min: 0.3, r_max: 2.0 },
        SizeLaw::LogNormal { r_g: 0.5, sigma_g: 1.01 }.into(),
        SizeLaw::Gamma { r_eff: 0.5, v_eff: 0.45 }.into(),
    ];
    for distribution in cases {
        let average = MieAverage::new(m, 550.0, &distribution).unwrap();
        let density = |r: f64| match distribution.law {
            SizeLaw::PowerLaw { exponent } => r.powf(-exponent),
            SizeLaw::LogNormal { r_g, sigma_g } => {
                (-0.5 * ((r / r_g).ln() / f64::ln(sigma_g)).powi(2)).exp() / r
            }
            SizeLaw::Gamma { r_eff, v_eff } => r.powf(1.0 / v_eff - 3.0) * (-r / (r_eff * v_eff)).exp(),
            _ => unreachable!(),
        };
        let (low, high) = (distribution.r_min.max(1e-4).ln(), distribution.r_max.min(12.0).ln());
        let steps = 20_000;
        let (mut area, mut extinction) = (0.0, 0.0);
        for i in 0..steps {
            let r = (low + (high - low) * (f64::from(i) + 0.5) / f64::from(steps)).exp();
            let sphere = Sphere::new(m, wave_number * r).unwrap();
            let weight = density(r) * r * r * r;
            area += weight;
            extinction += weight * sphere.q_ext;
        }
        let error = (average.q_ext * area / extinction - 1.0).abs();
        assert!(error < 3e-4, "{error:e} for {distribution:?}");
    }
    let single = MieAverage::new(m, 550.0, &SizeLaw::Single { r: 0.55 }.into()).unwrap();
    let sphere = Sphere::new(m, TAU).unwrap();
    assert_eq!((single.q_ext, single.q_sca, single.g), (sphere.q_ext, sphere.q_sca, sphere.g));
    let phase = single.phase_function().unwrap();
    assert!((phase.value_at_cosine(0.3) / sphere.phase_function(0.3) - 1.0).abs() < 1e-3);
    assert!((phase.mean_cosine() - single.g).abs() < 1e-4);
}

#[test]
fn impossible_distributions_are_refused_with_the_key_and_the_mend() {
    let refusal = |law: SizeLaw, r_min, r_max| {
        let distribution = SizeDistribution { law, r_min, r_max };
        MieAverage::new(RefractiveIndex { n: 1.33, k: 0.0 }, 550.0, &distribution).unwrap_err().to_string()
    };
    let infinite = f64::INFINITY;
    let gamma = |r_eff, v_eff| SizeLaw::Gamma { r_eff, v_eff };
    for (message, part) in [
        (refusal(gamma(f64::NAN, 0.1), 0.0, infinite), "`r_eff` of the size distribution is NaN"),
        (refusal(gamma(10.0, 0.5), 0.0, infinite), "`v_eff` of the size distribution is 0.5"),
        (refusal(gamma(10.0, 0.1), 5.0, 4.0), "less than `r_max`"),
        (refusal(gamma(10.0, 0.1), 1e4, infinite), "no particles between"),
        (refusal(SizeLaw::LogNormal { r_g: 0.2, sigma_g: 1.0 }, 0.0, infinite), "`sigma_g`"),
        (refusal(SizeLaw::LogNormal { r_g: 100.0, sigma_g: 5.0 }, 0.0, infinite), "size parameter"),
        (refusal(SizeLaw::PowerLaw { exponent: 3.0 }, 0.0, 1.0), "`r_min`"),
        (refusal(SizeLaw::PowerLaw { exponent: 3.0 }, 0.1, infinite), "`r_max`"),
        (refusal(SizeLaw::ModifiedGamma { r_mode: 4.0, alpha: 0.0, gamma: 1.0 }, 0.0, infinite), "`alpha`"),
        (refusal(SizeLaw::Single { r: -1.0 }, 0.0, infinite), "`r`"),
    ] {
        assert!(message.contains(part), "{message}");
    }
}
