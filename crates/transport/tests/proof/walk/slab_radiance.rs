//! Radiance out of slabs by local estimates, against adding-doubling and van de Hulst's table 35.

use std::collections::BTreeMap;

use super::{Family, beam, henyey_greenstein, measure, photons, rows, slab, view};
use tyndall_optics::PhaseFunction;
use tyndall_transport::walk::Slab;

/// Measures each slab of a table once, in all the table's directions. Rows end with μ, the reflected and the
/// transmitted radiance; what stands before tells the slabs apart.
fn hold_against_table(name: &str, rows: &[Vec<f64>], make: impl Fn(&[f64]) -> Slab, n: u64) {
    let mut slabs: BTreeMap<String, Vec<&Vec<f64>>> = BTreeMap::new();
    for row in rows {
        slabs.entry(format!("{:?}", &row[..3])).or_default().push(row);
    }
    let mut families = [Family::default(), Family::default()];
    for (seed, (key, rows)) in slabs.into_iter().enumerate() {
        let up = rows.iter().map(|row| view(row[3]));
        let down = rows.iter().map(|row| view(-row[3]));
        let slab = Slab { views: up.chain(down).collect(), ..make(rows[0]) };
        let fluxes = measure(&slab, seed as u64, n);
        for (number, row) in rows.iter().enumerate() {
            let name = format!("{name} {key} mu {}", row[3]);
            for (side, family) in families.iter_mut().enumerate() {
                let truth = row[4 + side];
                // The table leaves the direction of the beam itself out.
                if !truth.is_nan() {
                    let radiance = fluxes.radiance[side * rows.len() + number];
                    // What less than some ten photons bring may be brought by none, whose spread is none either.
                    let unseen = if truth * (n as f64) < 10.0 { truth } else { 0.0 };
                    family.add(name.clone(), truth, unseen.max(1e-5 * truth), radiance);
                }
            }
        }
    }
    // The directions of one slab share photons, so that the family is no sample of the normal law.
    families.iter().for_each(|family| family.assert(name, false));
}

#[test]
fn radiance_under_normal_incidence_is_that_of_adding_doubling() {
    let rows = rows(include_str!("../../truth/slab_radiance.json"), "rows");
    let make = |row: &[f64]| slab(row[1], row[0], henyey_greenstein(row[2]));
    hold_against_table("HG", &rows, make, photons(1 << 13));
}

#[test]
fn radiance_under_oblique_incidence_is_that_of_adding_doubling() {
    let rows = rows(include_str!("../../truth/slab_radiance_isotropic.json"), "rows");
    let make =
        |row: &[f64]| Slab { incidence: beam(row[2]), ..slab(row[1], row[0], PhaseFunction::Isotropic) };
    hold_against_table("isotropic", &rows, make, photons(1 << 13));
}
