//! Random walks in an infinite medium, by the parts that all walks are made of: moments of the position, directions, the
//! fluence about a point source, escape from a ball.

use glam::{DAffine3, DVec3};
use tyndall_lanes::Random;
use tyndall_optics::PhaseFunction;
use tyndall_scene::{Density, Medium, Ray, Volume};
use tyndall_transport::{estimate_transmittance, sample_distance};

use super::{Family, henyey_greenstein, photons, rows};
use crate::fresh;
use crate::scenes::random_direction;
use crate::statistics::mean_and_error;
use tyndall_transport::walk::Estimate;

const TABLE: &str = include_str!("../../truth/infinite_medium.json");

fn medium(density: Density, radius: f64, phase_function: PhaseFunction) -> Volume {
    let medium = Medium::grey(1.0, 1.0, phase_function);
    let world_to_local = DAffine3::from_scale(DVec3::splat(radius)).inverse();
    Volume { name: "medium".into(), world_to_local, density, medium, fields: None }
}

fn fly(volume: &Volume, ray: &mut Ray, random: &mut Random) {
    let distance = sample_distance(volume, ray, (0.0, f64::INFINITY), random).expect("it is without end");
    ray.origin = ray.at(distance);
}

fn scatter(volume: &Volume, ray: &mut Ray, random: &mut Random) {
    let u = [random.f64(), random.f64()];
    ray.direction = volume.medium.phase_function.sample(ray.direction, u);
}

fn estimate(values: &[f64]) -> Estimate {
    let (mean, standard_error) = mean_and_error(values);
    Estimate { mean, standard_error }
}

#[test]
fn walks_go_as_far_as_their_asymmetry_says() {
    let n = photons(1 << 14);
    let mut family = Family::default();
    for (seed, row) in rows(TABLE, "random_walk").iter().enumerate() {
        let volume = medium(Density::Everywhere, 1.0, henyey_greenstein(row[0]));
        let (mut z, mut squares, mut cosines) = (vec![], vec![], vec![]);
        for photon in 0..n {
            let mut random = fresh::random(seed as u64, 0, photon);
            let mut ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };
            for collision in 0..row[1] as u32 {
                if collision > 0 {
                    scatter(&volume, &mut ray, &mut random);
                }
                fly(&volume, &mut ray, &mut random);
            }
            scatter(&volume, &mut ray, &mut random);
            z.push(ray.origin.z);
            squares.push(ray.origin.length_squared());
            cosines.push(ray.direction.z);
        }
        for (column, values) in [(2, z), (3, squares), (4, cosines)] {
            family.add(format!("column {column} of {row:?}"), row[column], 1e-9, estimate(&values));
        }
    }
    family.assert("random walks", false);
}

/// E₁: the power series up to 1, the continued fraction beyond (Abramowitz & Stegun 1964, 5.1.11 and 5.1.22).
fn exponential_integral(x: f64) -> f64 {
    const EULER: f64 = 0.577_215_664_901_532_9;
    if x <= 1.0 {
        let (mut term, mut sum) = (1.0, 0.0);
        for k in 1..30 {
            term *= -x / f64::from(k);
            sum -= term / f64::from(k);
        }
        return sum - EULER - x.ln();
    }
    let fraction = (1..=60).rev().fold(0.0, |below, k| {
        let k = f64::from(k);
        k / (1.0 + k / (x + below))
    });
    (-x).exp() / (x + fraction)
}

/// Every scattering at the distance ρ from the source sends light through the sphere of radius r about it, whose mean
/// fluence over the sphere is [E₁(|r − ρ|) − E₁(r + ρ)]/(8π r ρ).
#[test]
fn the_fluence_about_a_point_source_is_that_of_case_and_zweifel() {
    let volume = medium(Density::Everywhere, 1.0, PhaseFunction::Isotropic);
    let n = photons(1 << 12);
    let mut family = Family::default();
    let mut seed = 0;
    for rows in rows(TABLE, "fluence").chunk_by(|a, b| a[0] == b[0]) {
        seed += 1;
        let albedo = rows[0][0];
        let mut fluences = vec![vec![]; rows.len()];
        for photon in 0..n {
            let mut random = fresh::random(seed, 1, photon);
            let mut ray = Ray { origin: DVec3::ZERO, direction: random_direction(&mut random) };
            let mut sums: Vec<f64> = rows.iter().map(|row| row[3]).collect();
            loop {
                fly(&volume, &mut ray, &mut random);
                if random.f64() >= albedo {
                    break;
                }
                let from = ray.origin.length();
                for (sum, row) in sums.iter_mut().zip(rows) {
                    let seen =
                        exponential_integral((row[1] - from).abs()) - exponential_integral(row[1] + from);
                    *sum += seen / (8.0 * std::f64::consts::PI * row[1] * from);
                }
                scatter(&volume, &mut ray, &mut random);
            }
            fluences.iter_mut().zip(sums).for_each(|(all, sum)| all.push(sum));
        }
        for (row, values) in rows.iter().zip(&fluences) {
            family.add(format!("{row:?}"), row[2], 1e-6 * row[2], estimate(values));
        }
    }
    family.assert("fluence", false);
}

#[test]
fn light_born_in_an_absorbing_ball_escapes_as_often_as_case_de_hoffmann_and_placzek_say() {
    let mut family = Family::default();
    for row in rows(TABLE, "ball") {
        let ball = medium(Density::Sphere, row[0], PhaseFunction::Isotropic);
        let escapes: Vec<f64> = (0..photons(1 << 14))
            .map(|photon| {
                let mut random = fresh::random(2, 0, photon);
                let radius = row[0] * random.f64().cbrt();
                let origin = random_direction(&mut random) * radius;
                let ray = Ray { origin, direction: random_direction(&mut random) };
                estimate_transmittance(&ball, &ray, (0.0, f64::INFINITY), &mut random)
            })
            .collect();
        family.add(format!("{row:?}"), row[2], 1e-9, estimate(&escapes));
    }
    family.assert("balls", false);
}
