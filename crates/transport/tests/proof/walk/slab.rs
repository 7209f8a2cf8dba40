//! Reflectance and transmittance of slabs against adding-doubling: matched and with Fresnel faces; energy; threads.

use super::{Family, beam, henyey_greenstein, measure, options, photons, rows, slab};
use glam::DVec3;
use std::sync::atomic::AtomicBool;
use tyndall_optics::PhaseFunction;
use tyndall_transport::walk::{Goal, Incidence, Slab, WalkOptions};

#[test]
fn matched_slabs_reflect_and_transmit_what_adding_doubling_says() {
    let mut rare = Family::default();
    for (name, table, least) in [
        ("matched slabs", include_str!("../../truth/slab_matched.json"), 1 << 10),
        ("thick slabs", include_str!("../../truth/slab_thick.json"), 1 << 9),
    ] {
        let n = photons(least);
        let mut families = [Family::default(), Family::default()];
        for (number, row) in rows(table, "rows").iter().enumerate() {
            for (column, incidence) in [(3, beam(1.0)), (5, beam(0.5)), (7, Incidence::Diffuse)] {
                let slab = Slab { incidence, ..slab(row[1], row[0], henyey_greenstein(row[2])) };
                let fluxes = measure(&slab, (16 * number + column) as u64, n);
                let name = format!("{name}: albedo {} tau {} g {} column {column}", row[0], row[1], row[2]);
                let [reflectance, transmittance] = &mut families;
                reflectance.add_fraction(name.clone(), row[column], fluxes.reflectance, n, &mut rare);
                transmittance.add_fraction(name, row[column + 1], fluxes.transmittance, n, &mut rare);
            }
        }
        // Apart, as R and T come from the same photons.
        families.iter().for_each(|family| family.assert(name, true));
    }
    rare.assert("rare light", false);
}

#[test]
fn slabs_with_fresnel_faces_reflect_and_transmit_what_adding_doubling_says() {
    let n = photons(1 << 11);
    let mut rare = Family::default();
    let mut families = [Family::default(), Family::default()];
    for (number, row) in rows(include_str!("../../truth/slab_fresnel.json"), "rows").iter().enumerate() {
        for (column, incidence) in [(4, beam(1.0)), (6, Incidence::Diffuse)] {
            let slab = Slab {
                incidence,
                refractive_index: row[0],
                ..slab(row[2], row[1], henyey_greenstein(row[3]))
            };
            if column == 4 {
                assert!((slab.unscattered() - row[9]).abs() < 1e-6, "{row:?}: {}", slab.unscattered());
            }
            let fluxes = measure(&slab, (16 * number + column) as u64, n);
            let name = format!("n {} albedo {} tau {} g {} column {column}", row[0], row[1], row[2], row[3]);
            let [reflectance, transmittance] = &mut families;
            reflectance.add_fraction(name.clone(), row[column], fluxes.reflectance, n, &mut rare);
            transmittance.add_fraction(name, row[column + 1], fluxes.transmittance, n, &mut rare);
        }
    }
    families.iter().for_each(|family| family.assert("Fresnel slabs", true));
    rare.assert("rare light", false);
}

/// Light neither appears nor vanishes, also below a reflecting ground: R + A + (1 − ground albedo)·T = 1.
#[test]
fn light_is_conserved() {
    for ground_albedo in [0.0, 0.4, 1.0] {
        for refractive_index in [1.0, 1.33] {
            for albedo in [1.0, 0.8] {
                let slab =
                    Slab { ground_albedo, refractive_index, ..slab(1.5, albedo, henyey_greenstein(0.6)) };
                let fluxes = measure(&slab, 3, photons(1 << 14));
                let parts =
                    [fluxes.reflectance, fluxes.absorptance, fluxes.transmittance * (1.0 - ground_albedo)];
                let sum: f64 = parts.iter().map(|part| part.mean).sum();
                let error: f64 = parts.iter().map(|part| part.standard_error).sum();
                assert!((sum - 1.0).abs() < 3.0 * error + 1e-9, "{slab:?}: {sum} +- {error}");
            }
        }
    }
}

/// Over a ground of albedo a, light bounces between it and the layer: R = R₁ + T₁ a T* / (1 − a R*), with R* and T* for
/// diffuse light, which the ground sends back.
#[test]
fn a_lambertian_ground_adds_what_the_layer_lets_back() {
    // The row for g = 0.5 of the table.
    let (r, t, r_diffuse, t_diffuse) = (0.204_507_4, 0.523_273_4, 0.302_536, 0.392_165_7);
    for ground_albedo in [0.3, 1.0] {
        let slab = Slab { ground_albedo, ..slab(2.0, 0.9, henyey_greenstein(0.5)) };
        let fluxes = measure(&slab, 5, photons(1 << 15));
        let onto_ground = t / (1.0 - ground_albedo * r_diffuse);
        let mut family = Family::default();
        let reflected = r + ground_albedo * onto_ground * t_diffuse;
        family.add("reflectance".into(), reflected, 1e-6, fluxes.reflectance);
        family.add("transmittance".into(), onto_ground, 1e-6, fluxes.transmittance);
        family.assert("layer over ground", false);
    }
}

#[test]
fn threads_change_no_bit() {
    let slab = Slab { views: vec![DVec3::Y], ..slab(2.0, 0.9, henyey_greenstein(0.5)) };
    let run = |threads| {
        let options = WalkOptions { threads, ..options(9, 30_000) };
        slab.measure(&options, &AtomicBool::new(false))
    };
    assert_eq!(run(1), run(2));
    assert_eq!(run(1), run(5));
    assert_ne!(run(1), measure(&slab, 10, 30_000));
}

#[test]
fn a_run_ends_when_its_error_is_reached() {
    let slab = slab(2.0, 0.9, PhaseFunction::Isotropic);
    let goal = Goal { samples: u64::MAX, error: Some(0.01), time: None };
    let fluxes = slab.measure(&WalkOptions { goal, ..options(1, 0) }, &AtomicBool::new(false));
    for result in [fluxes.reflectance, fluxes.transmittance] {
        let relative = result.standard_error / result.mean;
        assert!(relative <= 0.01 && relative > 0.005, "{result:?}");
    }
}
