//! From three channels to a spectrum: c(λ) = r B_r(λ) + g B_g(λ) + b B_b(λ).
//!
//! The basis is non-negative and sums to 1 at every wavelength, so that a grey value becomes a constant and values from
//! 0 to 1 stay there; and under the white of [`cie::white`](crate::cie::white) each member has exactly the colour of
//! its own primary (to 2e-8), so that a spectrum made from RGB has that RGB again. That such a basis exists for Rec. 709 is an
//! observation of Mallett & Yuksel 2019, "Spectral primary decomposition for rendering with sRGB reflectance".
//!
//! The figures were found for this crate by quadratic programming: the least sum, over the three members, of squared
//! second differences and 1/1000 of squared first differences between nodes of 5 nm, under those constraints, with linear
//! interpolation between the nodes and sums over 1 nm for the colours.

use glam::DVec3;

use crate::cie::{FIRST_NM, LAST_NM};

const STEP_NM: f64 = 5.0;

/// B_r at 360, 365, … 830 nm.
#[rustfmt::skip]
const RED: [f64; 95] = [
    0.334013, 0.3143495, 0.2946664, 0.2749443, 0.2551641, 0.2353074, 0.2153566, 0.1952964, 0.1751151,
    0.1548102, 0.1343979, 0.1139281, 0.0935144, 0.0733835, 0.0539485, 0.0358847, 0.0201679, 0.0080762,
    0.0011225, 0.0, 0.0001916, 0.0002327, 0.000032, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0101349, 0.0459335, 0.1134856, 0.2114036,
    0.3328007, 0.4673206, 0.6031555, 0.7288502, 0.8348623, 0.9148369, 0.9665502, 0.9924781, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0,
];

/// B_b at 360, 365, … 830 nm; B_g is what is left to 1.
#[rustfmt::skip]
const BLUE: [f64; 95] = [
    0.665987, 0.6856505, 0.7053336, 0.7250557, 0.7448359, 0.7646926, 0.7846434, 0.8047036, 0.8248849,
    0.8451898, 0.8656021, 0.8860719, 0.9064856, 0.9266165, 0.9460515, 0.9641153, 0.9798321, 0.9919238,
    0.9988775, 0.998196, 0.9824752, 0.94679, 0.8892169, 0.8107361, 0.7150238, 0.6073846, 0.4940781,
    0.3816877, 0.2765723, 0.1843669, 0.1094854, 0.0546026, 0.0201329, 0.0037501, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0007762, 0.0087929, 0.0226479, 0.0358381, 0.0446109, 0.0474443,
    0.0445244, 0.0372064, 0.0274707, 0.0174334, 0.0089266, 0.0031536, 0.0004264, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 0.0, 0.0,
];

/// B_r, B_g, B_b at a wavelength in nm; beyond 360–830 nm those of the nearer end.
pub fn basis(wavelength_nm: f64) -> DVec3 {
    let place = (wavelength_nm.clamp(FIRST_NM, LAST_NM) - FIRST_NM) / STEP_NM;
    let index = (place as usize).min(RED.len() - 2);
    let within = place - index as f64;
    let between = |node: &[f64; 95]| node[index] + (node[index + 1] - node[index]) * within;
    let (red, blue) = (between(&RED), between(&BLUE));
    DVec3::new(red, (1.0 - red - blue).max(0.0), blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cie;

    #[test]
    fn the_basis_has_the_colours_of_the_primaries() {
        for (channel, primary) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let colour = cie::xyz_to_rgb(cie::xyz(|nm| cie::white(nm) * basis(nm)[channel]));
            assert!((colour - primary).abs().max_element() < 2e-8, "{channel}: {colour}");
        }
    }

    #[test]
    fn the_basis_is_a_partition_of_one() {
        for step in 0..=6000 {
            let basis = basis(300.0 + 0.1 * f64::from(step));
            assert!(basis.min_element() >= 0.0);
            assert!((basis.element_sum() - 1.0).abs() < 1e-15, "{basis}");
        }
    }
}
