//! Slabs of air molecules and of cloud droplets: Rayleigh's and a tabulated phase function against adding-doubling.

use std::path::Path;

use tyndall_optics::PhaseFunction;
use tyndall_optics::phase_function::read_phase_table;
use tyndall_transport::walk::{Incidence, Slab};

use super::{Family, beam, measure, photons, rows, slab, view};

/// The scalar rows; polarised light, which has other values, is another matter.
#[test]
fn rayleigh_slabs_are_those_of_scalar_adding_doubling() {
    let table: serde_json::Value =
        serde_json::from_str(include_str!("../../truth/rayleigh_slab.json")).expect("the table is JSON");
    let n = photons(1 << 13);
    let mut family = Family::default();
    for (number, row) in table["rows"].as_array().expect("rows").iter().enumerate() {
        let at = |column: usize| row[column].as_f64().expect("a number");
        let radiance: Vec<[f64; 2]> = serde_json::from_value(row[6].clone()).expect("pairs");
        let views = radiance.iter().map(|[mu, _]| view(*mu)).collect();
        let normal = Slab { views, ..slab(at(1), at(0), PhaseFunction::Rayleigh) };
        let diffuse = Slab { incidence: Incidence::Diffuse, views: vec![], ..normal.clone() };
        let seed = 2 * number as u64;
        for (slab, column, seed) in [(&normal, 2, seed), (&diffuse, 4, seed + 1)] {
            let fluxes = measure(slab, seed, n);
            family.add(format!("R, column {column} of {row}"), at(column), 1e-7, fluxes.reflectance);
            family.add(format!("T, column {column} of {row}"), at(column + 1), 1e-7, fluxes.transmittance);
            for ([mu, truth], &result) in radiance.iter().zip(&fluxes.radiance) {
                family.add(format!("radiance at {mu} of {row}"), *truth, 1e-7, result);
            }
        }
    }
    family.assert("Rayleigh slabs", false);
}

const CLOUD_C1: &str = include_str!("../../truth/slab_c1_cloud.json");

fn cloud_c1() -> PhaseFunction {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../optics/tests/truth/c1_cloud.txt");
    read_phase_table(&file).expect("the table of the phase function").at(550.0)
}

#[test]
fn slabs_of_cloud_c1_are_those_of_adding_doubling() {
    let phase = cloud_c1();
    let n = photons(1 << 11);
    let (mut family, mut rare) = (Family::default(), Family::default());
    for (number, row) in rows(CLOUD_C1, "rows").iter().enumerate() {
        for (column, incidence) in [(2, beam(1.0)), (4, beam(0.5)), (6, Incidence::Diffuse)] {
            let slab = Slab { incidence, ..slab(row[1], row[0], phase.clone()) };
            let fluxes = measure(&slab, (8 * number + column) as u64, n);
            let name = format!("albedo {} tau {} column {column}", row[0], row[1]);
            family.add_fraction(name.clone(), row[column], fluxes.reflectance, n, &mut rare);
            family.add_fraction(name, row[column + 1], fluxes.transmittance, n, &mut rare);
        }
    }
    family.assert("slabs of cloud C.1", false);
    rare.assert("rare light", false);
}

/// The peak of this phase function, 10⁵ times its least value, leaves the local estimate to rare great contributions. Fewer
/// photons than these miss so many of them that mean and error are both too small; here the errors are some hundredths.
#[test]
fn thin_slabs_of_cloud_c1_have_the_radiance_of_adding_doubling() {
    let n = photons(1 << 18);
    let mut family = Family::default();
    for (number, row) in rows(CLOUD_C1, "radiance").iter().enumerate() {
        let [albedo, tau, mu, radiance] = row[..] else { panic!("four columns, not {row:?}") };
        // At grazing angles the errors would be a fifth.
        if tau > 1.0 || mu < 0.3 {
            continue;
        }
        let slab = Slab { views: vec![view(mu)], ..slab(tau, albedo, cloud_c1()) };
        let reflected = measure(&slab, 900 + number as u64, n).radiance[0];
        assert!(reflected.standard_error < 0.2 * radiance, "{reflected:?} says little of {radiance}");
        family.add(format!("albedo {albedo} tau {tau} mu {mu}"), radiance, 1e-3 * radiance, reflected);
    }
    family.assert("radiance of thin slabs of cloud C.1", false);
}
