//! Next-event estimation: what the lights that only it finds bring to every path of the pool.

#![allow(clippy::needless_range_loop, reason = "all loops over lanes look alike, whatever arrays they touch")]

use super::pool::{Group, POOL};
use super::scene::{CHANNELS, FastSpectralScene, Phases};
use super::turn::phase_values;
use super::vertex::transmittance;
use super::way_out::{FAR, way_out};

/// p_λ/Σp f_λ T_λ E_λ of one light for each path, chosen by the uniform number `choice`.
#[inline(always)]
pub(super) fn connect(
    scene: &FastSpectralScene,
    position: &[Group; 3],
    direction: &[Group; 3],
    density: &[Group; CHANNELS],
    choice: &Group,
) -> [Group; CHANNELS] {
    let first = scene.lights[0];
    let (mut toward, mut is_point) = (first.toward.map(|x| [x; POOL]), [first.is_point; POOL]);
    let mut bright = first.brightness.map(|x| [x; POOL]);
    for (before, light) in scene.lights.iter().zip(&scene.lights[1..]) {
        for l in 0..POOL {
            let chosen = choice[l] >= before.cumulative;
            is_point[l] = if chosen { light.is_point } else { is_point[l] };
            for axis in 0..3 {
                toward[axis][l] = if chosen { light.toward[axis] } else { toward[axis][l] };
            }
            for c in 0..CHANNELS {
                bright[c][l] = if chosen { light.brightness[c] } else { bright[c][l] };
            }
        }
    }
    let (mut distance, mut falloff, mut cosine) = ([0.0; POOL], [0.0; POOL], [0.0; POOL]);
    for l in 0..POOL {
        let x = toward[0][l] - is_point[l] * position[0][l];
        let y = toward[1][l] - is_point[l] * position[1][l];
        let z = toward[2][l] - is_point[l] * position[2][l];
        let square = x * x + y * y + z * z;
        let inverse_square = if square > 1e-30 { 1.0 / square } else { 0.0 };
        let inverse = inverse_square.sqrt();
        (toward[0][l], toward[1][l], toward[2][l]) = (x * inverse, y * inverse, z * inverse);
        distance[l] = if is_point[l] > 0.0 { square * inverse } else { FAR };
        falloff[l] = if is_point[l] > 0.0 { inverse_square } else { 1.0 };
        cosine[l] = (direction[0][l] * x + direction[1][l] * y + direction[2][l] * z) * inverse;
    }
    let leave = way_out(scene, position, &toward);
    let mut length = [0.0; POOL];
    for l in 0..POOL {
        length[l] = if distance[l] < leave[l] { distance[l] } else { leave[l] };
    }
    let mut phase = phase_values(scene.g(0), &cosine);
    let mut direct = [[0.0; POOL]; CHANNELS];
    for c in 0..CHANNELS {
        if let (Phases::Each(g), 1..) = (scene.phases, c) {
            phase = phase_values(g[c], &cosine);
        }
        let transmitted = transmittance(scene.mu_t[c], &length);
        for l in 0..POOL {
            let arriving = transmitted[l] * bright[c][l] * falloff[l];
            direct[c][l] = density[c][l] * phase[l] * arriving;
        }
    }
    direct
}
