//! What is far denser than anybody means is rendered right: it reflects as a half-space does.
//!
//! Under even light of radiance 1 a half-space that scatters equally in all directions sends out 1 − √(1 − α) H(μ) at the
//! cosine μ to its normal, with Chandrasekhar's H-function, 1/H(μ) = √(1 − α) + α/2 ∫₀¹ μ′ H(μ′)/(μ + μ′) dμ′ (Chandrasekhar
//! 1960, "Radiative Transfer", section 38).

use tyndall_scene::description::Integrator;
use tyndall_session::{Goal, Input, Job, JobOptions};
use tyndall_transport::Control;

use crate::files::npy;

const ALBEDO: f64 = 0.9;

/// Standard errors by which a picture may be off; by chance one in 16,000 is.
const LEVEL: f64 = 4.0;

#[test]
fn dense_volumes_reflect_as_a_half_space_does() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    std::fs::write(folder.path().join("even.npy"), npy([8; 3], 1, |_| 1.0)).expect("a folder for files");
    let even = "box = { min = [-4, -4, -4], max = [4, 4, 4] }";
    let grid = "file = \"even.npy\", filter = \"nearest\", transform = { translate = [-4, -4, -4] }";
    let truth = 1.0 - (1.0 - ALBEDO).sqrt() * h(1.0);
    for (volume, mu_t) in [(even, 1e4), (even, 1e8), (even, 1e11), (grid, 50.0), (grid, 1e4), (grid, 1e6)] {
        for integrator in [Integrator::Fast, Integrator::Reference] {
            let text = format!(
                "camera = {{ position = [0, 0, 9], target = [0, 0, 0], vertical_fov = 5 }}\n\
                 film = {{ resolution = [8, 8] }}\n\
                 volume = [{{ {volume}, mu_t = {mu_t}, albedo = {ALBEDO} }}]\n\
                 light = [{{ type = \"constant\", radiance = 1 }}]"
            );
            let mut input = Input::from_text("dense.toml", &text, folder.path(), &[]).expect("a sound scene");
            input.description_mut().render.integrator = integrator;
            let mut job = Job::new(&input, &JobOptions::default()).expect("a scene that is built");
            let plan = Goal { spp: Some(64), ..Goal::default() }.plan(64);
            job.run(&plan, &Control::default(), |_| {}).expect("a picture");
            let mean = job.pictures()[0].film.image_mean()[1];
            let off = (mean.mean - truth) / mean.standard_error;
            assert!(off.abs() < LEVEL, "{volume}, mu_t = {mu_t}, {integrator:?}: {mean:?}, not {truth}");
        }
    }
}

/// H(μ), by iteration on the midpoints of many intervals.
fn h(mu: f64) -> f64 {
    const COUNT: usize = 200;
    let place = |i: usize| (i as f64 + 0.5) / COUNT as f64;
    let next = |mu: f64, h: &[f64]| {
        let integral: f64 = (0..COUNT).map(|i| place(i) * h[i] / (mu + place(i))).sum::<f64>() / COUNT as f64;
        1.0 / ((1.0 - ALBEDO).sqrt() + 0.5 * ALBEDO * integral)
    };
    let mut values = vec![1.0; COUNT];
    for _ in 0..100 {
        values = (0..COUNT).map(|i| next(place(i), &values)).collect();
    }
    next(mu, &values)
}
