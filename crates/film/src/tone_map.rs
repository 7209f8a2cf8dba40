//! From linear radiance to what a screen shows.
//!
//! The curve is that of the Khronos PBR Neutral tone mapper (Khronos Group 2024) without its toe: identical up to
//! 0.8, then compressed so that the brightest channel tends to 1 with a continuous slope, hue kept, and slowly
//! desaturated towards white as it gets brighter:
//!
//! ```text
//! p = max(r, g, b) > s = 0.8:   p' = 1 − (1 − s)² / (p + 1 − 2 s),   c' = mix(c p'/p, p', 1 − 1 / (1 + 0.15 (p − p')))
//! ```
//!
//! The toe subtracts the 4 % that smooth surfaces reflect, which a picture of a medium does not have. Grey stays
//! grey. The result is encoded by the sRGB curve (IEC 61966-2-1).

const COMPRESSION_START: f32 = 0.8;
const DESATURATION: f32 = 0.15;

/// Compresses a linear colour of any brightness into 0 to 1; negative parts and NaN become 0.
pub fn tone_map(colour: [f32; 3]) -> [f32; 3] {
    let colour = colour.map(|x| if x > 0.0 { x.min(f32::MAX / 4.0) } else { 0.0 });
    let peak = colour[0].max(colour[1]).max(colour[2]);
    if peak <= COMPRESSION_START {
        return colour;
    }
    let room = 1.0 - COMPRESSION_START;
    let new_peak = 1.0 - room * room / (peak + 1.0 - 2.0 * COMPRESSION_START);
    let white = 1.0 - 1.0 / (1.0 + DESATURATION * (peak - new_peak));
    colour.map(|x| {
        let scaled = x / peak * new_peak;
        (scaled + (new_peak - scaled) * white).min(1.0)
    })
}

/// The sRGB curve, 1.055 x^(1/2.4) − 0.055 above its straight foot, written so that 1 is exactly 1.
pub fn srgb_signal(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.0 - 1.055 * (1.0 - libm::powf(linear, 1.0 / 2.4)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_below_the_shoulder_are_shown_as_they_are() {
        assert_eq!(tone_map([0.1, 0.5, 0.8]), [0.1, 0.5, 0.8]);
    }

    #[test]
    fn grey_stays_grey_and_brighter_stays_brighter() {
        let mut last = 0.0;
        for step in 0..200 {
            let x = 1.1f32.powi(step - 60);
            let [r, g, b] = tone_map([x; 3]);
            assert!(r == g && g == b && r >= last && r <= 1.0, "{x}");
            last = r;
        }
        assert!(last > 0.999);
    }

    #[test]
    fn the_shoulder_begins_without_a_kink() {
        let h = 1e-3;
        let slope = (tone_map([0.8 + h; 3])[0] - 0.8) / h;
        assert!((slope - 1.0).abs() < 0.01, "{slope}");
    }

    #[test]
    fn the_order_of_channels_is_kept_and_the_very_bright_becomes_white() {
        let [r, g, b] = tone_map([3.0, 2.0, 1.0]);
        assert!(r > g && g > b);
        let [r, _, b] = tone_map([3e6, 2e6, 1e6]);
        assert!(r > 0.999 && b > 0.999);
    }

    #[test]
    fn nonsense_has_a_colour() {
        assert_eq!(tone_map([f32::NAN, -1.0, 0.0]), [0.0; 3]);
        assert!(tone_map([f32::INFINITY, f32::MAX, 0.0]).iter().all(|x| (0.0..=1.0).contains(x)));
    }

    #[test]
    fn the_signal_of_middle_grey_is_that_of_the_standard() {
        assert!((srgb_signal(0.214_041_14) - 0.5).abs() < 1e-5);
        assert_eq!((srgb_signal(0.0), srgb_signal(1.0)), (0.0, 1.0));
    }
}
