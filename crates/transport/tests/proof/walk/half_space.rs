//! Half-spaces: Chandrasekhar's H functions for isotropic scattering, adding-doubling for Henyey-Greenstein's.

use super::{Family, beam, henyey_greenstein, measure, photons, rows, slab, view};
use tyndall_optics::PhaseFunction;
use tyndall_transport::walk::{Estimate, Incidence, Slab};

const TABLE: &str = include_str!("../../truth/semi_infinite_isotropic.json");

fn half_space(albedo: f64, phase_function: PhaseFunction) -> Slab {
    slab(f64::INFINITY, albedo, phase_function)
}

#[test]
fn half_spaces_reflect_what_h_functions_say() {
    let n = photons(1 << 12);
    let mut family = Family::default();
    for (number, row) in rows(TABLE, "albedo_rows").iter().enumerate() {
        for (column, incidence) in [(1, beam(1.0)), (2, beam(0.5)), (3, Incidence::Diffuse)] {
            let slab = Slab { incidence, ..half_space(row[0], PhaseFunction::Isotropic) };
            let fluxes = measure(&slab, (4 * number + column) as u64, n);
            assert_eq!(fluxes.transmittance, Estimate::exact(0.0));
            let name = format!("albedo {} column {column}", row[0]);
            family.add(name, row[column], 1e-6, fluxes.reflectance);
        }
    }
    family.assert("isotropic half-spaces", false);
}

#[test]
fn half_spaces_of_any_asymmetry_reflect_what_adding_doubling_says() {
    let n = photons(1 << 11);
    let mut family = Family::default();
    let mut rare = Family::default();
    for (number, row) in rows(include_str!("../../truth/semi_infinite_hg.json"), "rows").iter().enumerate() {
        for (column, incidence) in [(2, beam(1.0)), (3, beam(0.5)), (4, Incidence::Diffuse)] {
            let slab = Slab { incidence, ..half_space(row[0], henyey_greenstein(row[1])) };
            let fluxes = measure(&slab, (8 * number + column) as u64, n);
            let name = format!("albedo {} g {} column {column}", row[0], row[1]);
            family.add_fraction(name, row[column], fluxes.reflectance, n, &mut rare);
        }
    }
    family.assert("Henyey-Greenstein half-spaces", false);
    rare.assert("rare light", false);
}

/// All albedos of the table, 1 among them, where the walk is cut short.
#[test]
fn radiance_out_of_half_spaces_is_that_of_h_functions() {
    let all = rows(TABLE, "radiance_rows");
    let n = photons(1 << 10);
    let mut family = Family::default();
    let mut seed = 0;
    for rows in all.chunk_by(|a, b| a[..2] == b[..2]) {
        seed += 1;
        let views = rows.iter().map(|row| view(row[2])).collect();
        let slab =
            Slab { incidence: beam(rows[0][1]), views, ..half_space(rows[0][0], PhaseFunction::Isotropic) };
        let fluxes = measure(&slab, seed, n);
        for (row, &radiance) in rows.iter().zip(&fluxes.radiance) {
            family.add(format!("{row:?}"), row[3], 1e-8 * row[3], radiance);
        }
    }
    family.assert("radiance of half-spaces", false);
}

/// Nothing is absorbed, so all comes back, however long the way: photons that were lost on the way would show.
#[test]
fn a_half_space_that_absorbs_nothing_reflects_everything() {
    for g in [-0.5, 0.0, 0.9] {
        let fluxes = measure(&half_space(1.0, henyey_greenstein(g)), 1, photons(1 << 9));
        assert_eq!(fluxes.reflectance, Estimate::exact(1.0), "{g}");
    }
}

/// With an absorption below the limit from which walks are lifted out of the depth, the reflectance is that of the
/// diffusion limit, R = 1 − H(1)·√(1 − albedo) for isotropic scattering: 1 − 2.9078·10⁻⁴ at 1 − albedo = 10⁻⁸.
#[test]
fn what_is_absorbed_deep_down_is_not_forgotten() {
    let absorption = 1e-8_f64;
    let slab = half_space(1.0 - absorption, PhaseFunction::Isotropic);
    let fluxes = measure(&slab, 1, photons(1 << 13));
    let expected = 2.907_810_5 * absorption.sqrt();
    let mut family = Family::default();
    family.add("reflectance".into(), 1.0 - expected, 1e-8, fluxes.reflectance);
    family.add("absorptance".into(), expected, 1e-8, fluxes.absorptance);
    family.assert("a half-space that absorbs next to nothing", false);
    assert!(fluxes.reflectance.standard_error < 0.1 * expected, "{fluxes:?}");
}
