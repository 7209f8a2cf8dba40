//! Rays on which estimators are tried: profiles of the table of truths, and rays through grids and several media at once.

use serde_json::Value;
use tyndall_lanes::Random;
use tyndall_scene::{Exponential, Ray, Scene};
use tyndall_transport::Lookups;
use tyndall_transport::along_ray::{AlongRay, Bounding, Extent, Profile};

use super::grids::ray_through;
use crate::scenes::{scene_in, write_random_npy};

/// `truth/transmittance_estimators.json`.
pub fn table() -> Value {
    let text = include_str!("../../truth/transmittance_estimators.json");
    serde_json::from_str(text).expect("the table is JSON")
}

pub fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{row} has no number {key}"))
}

pub fn rows<'a>(table: &'a Value, name: &str) -> &'a [Value] {
    table[name].as_array().expect("the table has rows")
}

/// The bounds of the table: one majorant over the whole ray.
pub const WHOLE: Bounding = Bounding {
    extent: Extent::WholeRay,
    majorant_scale: 1.0,
    control: tyndall_transport::along_ray::Control::Minorant,
    control_scale: 1.0,
};

/// The profiles of the heterogeneous rows, in their order, with their lengths.
pub fn profiles() -> Vec<(Profile, f64)> {
    let lines = |knots: &[(f64, f64)]| Profile::PiecewiseLinear(knots.to_vec());
    let gaussian = |peak, centre, width| Profile::Gaussian { peak, centre, width };
    let sine = |mean, frequency| Profile::Sine { mean, frequency };
    vec![
        (lines(&[(0.0, 0.0), (1.0, 2.0)]), 1.0),
        (lines(&[(0.0, 0.5), (3.0, 1.5)]), 3.0),
        (lines(&[(0.0, 4.0), (2.0, 0.0)]), 2.0),
        (Profile::Exponential(Exponential { logarithm: f64::ln(3.0) - 0.4, rate: -0.16 }), 2.0),
        (gaussian(3.0, 1.0, 0.3), 2.0),
        (gaussian(10.0, 0.2, 0.1), 1.0),
        (gaussian(1.0, 2.0, 1.5), 4.0),
        (sine(1.0, 3.0), 1.0),
        (sine(4.0, 5.25), 2.0),
        (lines(&[(0.0, 12.0), (0.1, 12.0), (0.1, 0.0), (1.9, 0.0), (1.9, 1.0), (2.0, 1.0)]), 2.0),
        (lines(&[(0.0, 0.0), (1.0, 6.0), (2.0, 0.0)]), 2.0),
    ]
}

/// ∫ g(μt) over a profile by the midpoint rule, without the code that is tested.
pub fn integral(profile: &Profile, length: f64, g: impl Fn(f64) -> f64) -> f64 {
    let n = 40_000;
    let step = length / f64::from(n);
    (0..n).map(|i| g(profile.mu_t((f64::from(i) + 0.5) * step))).sum::<f64>() * step
}

/// A grid with and without filter, and both in an atmosphere with a box across them.
pub fn scenes() -> Vec<(&'static str, Scene)> {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [9, 7, 8], 9);
    let grid = |filter: &str| {
        format!(
            "[[volume]]
             file = \"random.npy\"
             filter = \"{filter}\"
             transform = {{ scale = [0.1, 0.15, 0.12], rotate = [10, 20, 30], translate = [0.1, 0.2, -0.3] }}
             mu_t = 3
             albedo = 0.5\n"
        )
    };
    let others = "[[volume]]
        box = { min = [0.3, 0.2, 0], max = [0.8, 1.1, 0.4] }
        mu_t = 0.8
        albedo = 0.5
        [[volume]]
        atmosphere = { bottom = -0.5, scale_height = 0.3 }
        mu_t = 1.5
        albedo = 0.5";
    let camera = "camera = { position = [0, 0, 5], target = [0, 0, 0] }\n";
    [
        ("a trilinear grid", grid("trilinear")),
        ("a grid of constant voxels", grid("nearest")),
        ("four media", [&grid("trilinear"), &grid("nearest"), others].concat()),
    ]
    .map(|(name, volumes)| (name, scene_in(folder.path(), &(camera.to_owned() + &volumes))))
    .into()
}

/// A ray through the first of the scene's volumes, along which something is seen and something hidden; and all media
/// that it meets.
pub fn along<'a>(scene: &'a Scene, random: &mut Random) -> (Ray, AlongRay<'a>) {
    loop {
        let ray = ray_through(&scene.volumes[0], random);
        let Some(along) = AlongRay::through(&scene.volumes, &ray, 8.0) else { continue };
        let transmittance = (-along.thickness(f64::INFINITY, &mut Lookups::default())).exp();
        if (0.02..0.97).contains(&transmittance) {
            return (ray, along);
        }
    }
}

/// Optical thickness at equal steps along a ray, by the midpoint rule: not the code that is tested.
pub struct Tabulated {
    start: f64,
    step: f64,
    /// τ at the steps' ends and μt at their middles.
    pub tau: Vec<f64>,
    pub mu_t: Vec<f64>,
}

impl Tabulated {
    pub fn new(along: &AlongRay, steps: u32) -> Self {
        let (start, end) = (along.start(), along.end());
        let step = (end - start) / f64::from(steps);
        let mut tau = vec![0.0];
        let mut mu_t = Vec::new();
        for i in 0..steps {
            let at = along.mu_t(start + (f64::from(i) + 0.5) * step, &mut Lookups::default());
            mu_t.push(at);
            tau.push(tau[i as usize] + at * step);
        }
        Self { start, step, tau, mu_t }
    }

    pub fn whole(&self) -> f64 {
        self.tau[self.tau.len() - 1]
    }

    /// τ from the start to `t`.
    pub fn tau_at(&self, t: f64) -> f64 {
        let steps = (t - self.start) / self.step;
        let i = (steps as usize).min(self.mu_t.len() - 1);
        self.tau[i] + self.mu_t[i] * self.step * (steps - i as f64)
    }

    /// ∫ μt T f dt.
    pub fn collisions(&self, f: impl Fn(f64) -> f64) -> f64 {
        let each = self.tau.windows(2).enumerate();
        each.map(|(i, tau)| {
            f(self.start + (i as f64 + 0.5) * self.step) * ((-tau[0]).exp() - (-tau[1]).exp())
        })
        .sum()
    }
}
