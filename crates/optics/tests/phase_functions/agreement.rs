//! What the faces of a phase function say of each other: value, sampling, mean cosine.

use glam::DVec3;
use tyndall_optics::PhaseFunction;
use tyndall_optics::phase_function::{Sggx, SggxKind};

use super::quadrature::{integral_over_cells, integrate, kinds, sggx_kinds};

fn is_table(phase: &PhaseFunction) -> bool {
    matches!(phase, PhaseFunction::Tabulated(_))
}

#[test]
fn phase_functions_integrate_to_one_with_the_stated_mean_cosine() {
    for phase in kinds().iter().chain(&sggx_kinds()).filter(|phase| !is_table(phase)) {
        let norm = integrate(phase, -1.0, 1.0, |_| 1.0);
        assert!((norm - 1.0).abs() < 1e-9, "{phase:?}: {norm}");
        let mean = integrate(phase, -1.0, 1.0, |cos| cos);
        assert!((mean - phase.mean_cosine()).abs() < 1e-9, "{phase:?}: {mean}");
    }
}

/// At each sampled cosine the cumulative distribution, by quadrature, gives u back, up to the ends of u.
#[test]
fn sampling_inverts_the_cumulative_distribution() {
    for phase in kinds().iter().chain(&sggx_kinds()) {
        if matches!(phase, PhaseFunction::Mixture(_)) || is_table(phase) {
            continue;
        }
        for u in [0.0, 1e-9, 1e-3, 0.1, 0.25, 0.5, 0.7, 0.9, 0.999, 1.0 - 1e-9] {
            let cos = phase.sample_cosine(u);
            let below = integrate(phase, -1.0, cos, |_| 1.0);
            assert!((below - u).abs() < 1e-9, "{phase:?} at {u}: {below}");
        }
    }
}

/// Every number that leaves is finite and in its range, whatever the parameters within theirs.
#[test]
fn extreme_parameters_and_angles_give_finite_values() {
    let mut phases = kinds();
    for g in [1.0 - 1e-9, -1.0 + 1e-9, f64::MIN_POSITIVE] {
        phases.push(PhaseFunction::HenyeyGreenstein { g });
        phases.push(PhaseFunction::Schlick { k: g });
        phases.push(PhaseFunction::Draine { g, alpha: 1e30 });
    }
    phases.push(PhaseFunction::Sggx(Sggx::new(SggxKind::Surface, DVec3::Y, 1e-6)));
    phases.push(PhaseFunction::Sggx(Sggx::new(SggxKind::Fibre, DVec3::Y, 1e-6)));
    for phase in &phases {
        for cos in [-1.0, -1.0 + 1e-16, -0.3, 0.0, 1.0 - 1e-16, 1.0, 1.0 + 1e-15] {
            let value = phase.value_at_cosine(cos);
            assert!(value.is_finite() && value >= 0.0, "{phase:?} at {cos}: {value}");
        }
        for u in [0.0, 1e-300, 0.5, 1.0 - f64::EPSILON / 2.0] {
            assert!((-1.0..=1.0).contains(&phase.sample_cosine(u)), "{phase:?} at {u}");
            for before in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::new(0.6, 0.0, -0.8)] {
                let after = phase.sample(before, [u, 1.0 - u]);
                assert!((after.length() - 1.0).abs() < 1e-12, "{phase:?}: {after}");
                assert!(phase.value(before, after).is_finite(), "{phase:?}: {after}");
            }
        }
        assert!(phase.mean_cosine().abs() <= 1.0, "{phase:?}");
    }
}

#[test]
fn sampled_directions_turn_by_the_sampled_angle() {
    let phase = PhaseFunction::HenyeyGreenstein { g: 0.7 };
    for before in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.6, -0.64, 0.48)] {
        for i in 0..50 {
            let u = [(f64::from(i) + 0.5) / 50.0, (f64::from(i) * 0.618_034).fract()];
            let after = phase.sample(before, u);
            assert!((after.length() - 1.0).abs() < 1e-12);
            assert!((after.dot(before) - phase.sample_cosine(u[0])).abs() < 1e-12);
        }
    }
}

/// σ(ω) f(ω → ω′) = σ(ω′) f(ω′ → ω), and the area is the same forth and back: paths may be traced from either end.
#[test]
fn sggx_is_reciprocal() {
    let directions = [DVec3::X, DVec3::new(0.6, -0.64, 0.48), DVec3::new(-0.48, 0.6, 0.64), DVec3::NEG_Y];
    for phase in sggx_kinds() {
        for before in directions {
            assert!((phase.projected_area(before) - phase.projected_area(-before)).abs() < 1e-15);
            for after in directions {
                let forth = phase.projected_area(before) * phase.value(before, after);
                let back = phase.projected_area(after) * phase.value(-after, -before);
                assert!(before == after || (forth - back).abs() < 1e-12 * forth, "{phase:?}");
            }
        }
    }
}

/// Deirmendjian's C.1 cloud: the stated mean cosine and Legendre moments.
#[test]
fn the_c1_cloud_has_the_published_moments() {
    let phase = super::quadrature::c1_cloud();
    let PhaseFunction::Tabulated(table) = &phase else { panic!("{phase:?}") };
    assert!((phase.mean_cosine() - 0.848_065).abs() < 1e-6);
    let truth: serde_json::Value =
        serde_json::from_str(include_str!("../truth/c1_legendre_moments.json")).unwrap();
    for (order, expected) in truth["legendre_moments_0_to_40"].as_array().unwrap().iter().enumerate() {
        let moment = integral_over_cells(table.cosines(), |cos| {
            std::f64::consts::TAU * phase.value_at_cosine(cos) * legendre(order, cos)
        });
        assert!((moment - expected.as_f64().unwrap()).abs() < 1e-6, "{order}: {moment}");
    }
}

fn legendre(order: usize, x: f64) -> f64 {
    let (mut below, mut here) = (0.0, 1.0);
    for n in 0..order {
        let n = n as f64;
        (below, here) = (here, ((2.0 * n + 1.0) * x * here - n * below) / (n + 1.0));
    }
    here
}
