//! Distance sampling: collisions are drawn with density p(t) = μt(t) T(t), by different ways at different cost.
//!
//! Left the extinction along a ray, its transmittance, and p with histograms of three samplers; right the mean number
//! of lookups of a flight under majorants that are looser than they need be.

use tyndall_lanes::Random;
use tyndall_transport::along_ray::{Bounding, Extent, Profile};
use tyndall_transport::{AlongRay, DistanceSampler, Lookups, repeat_distance};

use crate::plot::{Anchor, Axes, COLOURS, Kind, Scale, Svg, legend};

/// Length of the ray.
pub const LENGTH: f64 = 4.0;
const BINS: usize = 24;
const FLIGHTS: u64 = 20_000;
const SAMPLERS: [DistanceSampler; 3] = [
    DistanceSampler::DeltaTracking,
    DistanceSampler::DecompositionTracking,
    DistanceSampler::RegularTracking,
];

/// Two clouds behind each other, and thin haze between.
pub fn profile() -> Profile {
    Profile::PiecewiseLinear(vec![
        (0.0, 0.1),
        (0.5, 0.1),
        (0.9, 1.3),
        (1.3, 1.0),
        (1.6, 0.2),
        (2.3, 0.2),
        (2.8, 2.0),
        (3.4, 1.6),
        (4.0, 0.1),
    ])
}

/// Draws the picture of the chapter.
pub fn draw() -> String {
    let profile = profile();
    let ray = AlongRay::with_profile(profile.clone(), LENGTH, 8);
    let mut svg = Svg::new(960.0, 400.0);
    svg.text("title", Anchor::Start, [70.0, 28.0], "Where a ray collides");
    let frame = [70.0, 44.0, 520.0, 340.0];
    let x = Scale::new(Kind::Linear, [0.0, LENGTH], [frame[0], frame[2]]);
    let axes = Axes::with_scales(frame, x, Scale::new(Kind::Linear, [0.0, 2.1], [frame[3], frame[1]]));
    axes.draw(&mut svg, "distance t", Some(0.5), "");
    let along = |value: &dyn Fn(f64) -> f64| {
        (0..=400).map(|k| LENGTH * f64::from(k) / 400.0).map(|t| (t, value(t))).collect::<Vec<_>>()
    };
    let transmittance = |t: f64| (-profile.thickness(0.0, t)).exp();
    axes.curve(&mut svg, COLOURS[4], along(&|t| profile.mu_t(t)).into_iter());
    axes.curve(&mut svg, COLOURS[5], along(&transmittance).into_iter());
    axes.curve(&mut svg, COLOURS[6], along(&|t| profile.mu_t(t) * transmittance(t)).into_iter());
    for (number, (sampler, colour)) in SAMPLERS.into_iter().zip(COLOURS).enumerate() {
        for (bin, share) in histogram(sampler, &ray).into_iter().enumerate() {
            let width = LENGTH / BINS as f64;
            let density = share / width;
            let error = (share * (1.0 - share) / FLIGHTS as f64).sqrt() / width;
            let t = width * (bin as f64 + 0.25 * (number as f64 + 1.0));
            axes.error_bar(&mut svg, colour, t, [density - error, density + error]);
            axes.dot(&mut svg, colour, true, (t, density));
        }
    }
    for (label, place) in [("μt", (2.42, 1.75)), ("T", (0.1, 1.04)), ("p = μt T", (1.42, 0.62))] {
        if let Some(place) = axes.place(place.0, place.1) {
            svg.text("", Anchor::Start, place, label);
        }
    }
    draw_cost(&mut svg);
    svg.finish()
}

/// Shares of the flights that collide in each bin.
fn histogram(sampler: DistanceSampler, ray: &AlongRay) -> Vec<f64> {
    let mut shares = vec![0.0; BINS];
    for n in 0..FLIGHTS {
        let flight = sampler.sample(ray, &mut Random::new(13, 0, n), &mut Lookups::default());
        if let Some(t) = flight.t {
            shares[((t / LENGTH * BINS as f64) as usize).min(BINS - 1)] += flight.weight / FLIGHTS as f64;
        }
    }
    shares
}

fn draw_cost(svg: &mut Svg) {
    svg.text("title", Anchor::Start, [600.0, 28.0], "What a flight costs");
    let frame = [600.0, 44.0, 930.0, 340.0];
    let x = Scale::new(Kind::Log, [1.0, 10.0], [frame[0], frame[2]]);
    let axes = Axes::with_scales(frame, x, Scale::new(Kind::Log, [1.0, 100.0], [frame[3], frame[1]]));
    axes.draw(svg, "majorant / greatest extinction", None, "lookups");
    for (sampler, colour) in SAMPLERS.into_iter().zip(COLOURS) {
        let cost = |scale: f64| {
            let bounding =
                Bounding { extent: Extent::WholeRay, majorant_scale: scale, ..Bounding::default() };
            let ray = AlongRay::with_profile(profile(), LENGTH, 8).with_bounding(bounding);
            (scale, repeat_distance(sampler, &ray, 4000, 13, |flight| flight.weight).lookups)
        };
        axes.curve(svg, colour, (0..=20).map(|k| cost(10_f64.powf(f64::from(k) / 20.0))));
    }
    legend(svg, [625.0, 75.0], SAMPLERS.iter().map(|sampler| sampler.name()));
}
