//! Turns: Henyey and Greenstein's phase function (1941), its values and directions drawn from it.

#![allow(clippy::needless_range_loop, reason = "all loops over lanes look alike, whatever arrays they touch")]

use super::pool::{Group, POOL};
use super::scene::{CHANNELS, FastSpectralScene, Phases};
use super::vertex::normalise;

/// Draws new directions from the phase functions of the paths' own channels.
#[inline(always)]
pub(super) fn turn(
    scene: &FastSpectralScene,
    direction: &mut [Group; 3],
    density: &mut [Group; CHANNELS],
    g: &Group,
    u: &[Group; 2],
) {
    let mut cosine = [0.0; POOL];
    for l in 0..POOL {
        let (g, u) = (g[l], u[0][l]);
        let is_isotropic = g == 0.0;
        let divisor = if is_isotropic { 1.0 } else { 2.0 * g };
        let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        let peaked = (1.0 + g * g - ratio * ratio) / divisor;
        let cos = if is_isotropic { 2.0 * u - 1.0 } else { peaked };
        let cos = if cos < 1.0 { cos } else { 1.0 };
        cosine[l] = if cos > -1.0 { cos } else { -1.0 };
    }
    let (mut across, mut aside) = ([0.0; POOL], [0.0; POOL]);
    for l in 0..POOL {
        let sine = (1.0 - cosine[l] * cosine[l]).sqrt();
        let (sin_phi, cos_phi) = tyndall_lanes::sin_cos_turns(u[1][l]);
        (across[l], aside[l]) = (sine * cos_phi, sine * sin_phi);
    }
    for l in 0..POOL {
        let (across, aside, ahead) = (across[l], aside[l], cosine[l]);
        // Two vectors at right angles to the direction (Duff et al. 2017, "Building an orthonormal basis, revisited").
        let (x, y, z) = (direction[0][l], direction[1][l], direction[2][l]);
        let sign = 1.0_f32.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        let nx = across * (1.0 + sign * x * x * a) + aside * b + ahead * x;
        let ny = across * sign * b + aside * (sign + y * y * a) + ahead * y;
        let nz = across * -sign * x - aside * y + ahead * z;
        // One Newton step of the inverse square root about 1 keeps thousands of turns at unit length.
        let unit = 1.5 - 0.5 * (nx * nx + ny * ny + nz * nz);
        (direction[0][l], direction[1][l], direction[2][l]) = (nx * unit, ny * unit, nz * unit);
    }
    if let Phases::Each(g) = scene.phases {
        for c in 0..CHANNELS {
            let phase = phase_values(g[c], &cosine);
            for l in 0..POOL {
                density[c][l] *= phase[l];
            }
        }
        normalise(density);
    }
}

/// Henyey and Greenstein's phase function, 1/sr. (1 − g)² + 2g(1 − cos) keeps its digits at the forward peak.
#[inline(always)]
pub(super) fn phase_values(g: f32, cosine: &Group) -> Group {
    const INVERSE_SPHERE: f32 = 0.25 * std::f32::consts::FRAC_1_PI;
    let mut values = [0.0; POOL];
    for l in 0..POOL {
        let denominator = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine[l]);
        values[l] = INVERSE_SPHERE * (1.0 - g * g) / (denominator * denominator.sqrt());
    }
    values
}
