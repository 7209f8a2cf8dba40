//! Light that most pixels have not seen yet.
//!
//! A pixel's standard error is told by its own samples. Where one path in a million carries a tenth of the light, nearly
//! all pixels have not met it: they are too dark by a tenth, agree well among each other, and state errors that are far
//! too small. The few that met it stand out, and as a whole the picture knows: with n samples a pixel, paths that each
//! sample takes with probability p and that bring V are in a share n·p of the pixels, each of which owes
//!
//! ```text
//! e = V / n       to its largest sample: its mean, less the mean of its other samples
//! ```
//!
//! and the mean of e over all pixels is p·V, which is what the others lack. So let a pixel *stand out* if one sample has
//! raised its mean by more than the relative error in question, and
//!
//! ```text
//! U = mean over the pixels of e/b, where a pixel stands out       bound = U + 2 √Σ(e/b)² / number of pixels
//! ```
//!
//! b is what is known of the light there: the mean of the 3x3 pixels around, each without its largest sample, or the median
//! of the picture if that is more. It keeps the edge of a bright lamp, which its neighbours know well, from standing for light
//! that the rest of the picture lacks, and a lamp in the picture from hiding light that is little beside it. The
//! second term is two standard errors of U, as few events tell it badly.
//!
//! Once a typical pixel has met such paths (n·p above 0.7), its own standard error is at least e/mean. So either nobody
//! stands out by more than the error in question, or that error is not reached yet, or U tells. What no pixel at all
//! has met cannot be known.

use serde::Serialize;

use crate::estimates::LUMINANCE;
use crate::film::Film;
use crate::fixed_point::{SUM_FRACTION_BITS, to_f64};

/// What most pixels have not seen yet, as far as the picture knows; see [`Film::unseen_light`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct UnseenLight {
    /// Pixels whose mean one sample has raised by more than the error in question.
    pub pixels: u64,
    /// What the other pixels lack, as a share of the light that they show.
    pub share: f64,
    /// The same, and two of its standard errors more.
    pub bound: f64,
}

/// Errors below this are taken as this where unseen light is to be told: less of it matters to nobody.
pub(crate) const LEAST_STATED_ERROR: f64 = 0.01;

/// Samples that an error estimate needs before it is believed: with fewer, pixels whose few samples happen to agree
/// pass for converged.
const LEAST_SAMPLES_FOR_ERROR: u64 = 16;

/// Luminance of a pixel, with and without its largest sample.
#[derive(Clone, Copy, Default)]
struct Pixel {
    mean: f64,
    rest: f64,
    /// Whether it counts: that it is lit, and met anything if any pixel did.
    counts: bool,
}

impl Film {
    /// How much light most pixels lack, if `error` is the relative error that is asked for or stated.
    pub fn unseen_light(&self, error: f64) -> UnseenLight {
        let pixels = self.luminances();
        let Some(typical) = median(pixels.iter().filter(|pixel| pixel.counts).map(|pixel| pixel.rest)) else {
            return UnseenLight::default();
        };
        let (mut count, mut outstanding, mut sum, mut squares) = (0u64, 0, 0.0, 0.0);
        for (index, pixel) in pixels.iter().enumerate().filter(|(_, pixel)| pixel.counts) {
            count += 1;
            let raised = pixel.mean - pixel.rest;
            if raised > error * pixel.mean {
                let share = raised / self.known_around(&pixels, index).max(typical);
                outstanding += 1;
                sum += share;
                squares += share * share;
            }
        }
        let count = count as f64;
        UnseenLight { pixels: outstanding, share: sum / count, bound: (sum + 2.0 * squares.sqrt()) / count }
    }

    /// The same for the median relative error that the film states, or 1 % if that is less; `None` while it states none.
    pub fn stated_unseen_light(&self) -> Option<UnseenLight> {
        let stated = self.median_relative_error().filter(|error| error.is_finite())?;
        Some(self.unseen_light(stated.max(LEAST_STATED_ERROR)))
    }

    /// The error to be held against one that is asked for: the [median](Self::median_relative_error), or what most pixels
    /// [lack](Self::unseen_light) if that is more than was asked for. `None` if the whole picture is black.
    pub fn error_against(&self, asked: f64) -> Option<f64> {
        let median = self.median_relative_error()?;
        let bound = if median <= asked { self.unseen_light(asked).bound } else { 0.0 };
        Some(if bound > asked { bound } else { median })
    }

    /// The same once every pixel holds the 16 samples that it takes to believe it; `None` before that, too.
    pub fn believed_error_against(&self, asked: f64) -> Option<f64> {
        if self.least_sample_count() < LEAST_SAMPLES_FOR_ERROR { None } else { self.error_against(asked) }
    }

    /// The share that one sample has in the light of the whole picture; `None` if that is black. Where it is not small,
    /// the error of the picture's mean is not that of a normal distribution.
    pub fn largest_sample_share(&self) -> Option<f64> {
        let (mut largest, mut total) = (0.0f64, 0.0);
        self.for_each_pixel(|index, n| {
            let n = n.max(1) as f64;
            largest = largest.max(self.largest_of(index) / n);
            total += self.luminance_sum(index) / n;
        });
        (total > 0.0).then(|| largest / total)
    }

    fn luminances(&self) -> Vec<Pixel> {
        let any_hit = self.any_hit();
        let mut pixels = Vec::with_capacity(self.sums.pixels.len());
        self.for_each_pixel(|index, n| {
            let sum = self.luminance_sum(index);
            let mean = sum / n.max(1) as f64;
            let rest = (sum - self.largest_of(index)).max(0.0) / n.saturating_sub(1).max(1) as f64;
            let counts = mean > 0.0 && (self.sums.pixels[index].hits > 0 || !any_hit);
            pixels.push(Pixel { mean, rest, counts });
        });
        pixels
    }

    /// Mean over the pixels around, and the pixel itself, without their largest samples.
    fn known_around(&self, pixels: &[Pixel], index: usize) -> f64 {
        let (width, height) = (self.width as usize, self.height as usize);
        let (x, y) = (index % width, index / width);
        let (mut sum, mut count) = (0.0, 0.0);
        for row in y.saturating_sub(1)..(y + 2).min(height) {
            for pixel in &pixels[row * width + x.saturating_sub(1)..row * width + (x + 2).min(width)] {
                sum += pixel.rest;
                count += 1.0;
            }
        }
        sum / count
    }

    fn luminance_sum(&self, index: usize) -> f64 {
        let sums = self.sums.pixels[index].radiance;
        (0..3).map(|c| LUMINANCE[c] * to_f64(sums[c], SUM_FRACTION_BITS)).sum()
    }

    fn largest_of(&self, index: usize) -> f64 {
        self.sums.largest.get(index).copied().unwrap_or(0.0).into()
    }
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmTile;
    use crate::sample::{Layers, Sample};

    const SIZE: [u32; 2] = [64, 36];

    /// A film whose samples are a function of the pixel and of two uniform numbers.
    fn film(n: u64, seed: u64, light: impl Fn([u32; 2], [f32; 2]) -> f32) -> Film {
        let mut film = Film::new(SIZE[0], SIZE[1], Layers::NONE).unwrap();
        add_samples(&mut film, n, seed, light);
        film
    }

    fn add_samples(film: &mut Film, n: u64, seed: u64, light: impl Fn([u32; 2], [f32; 2]) -> f32) {
        let start = film.complete().count();
        let mut state = seed << 32 | start;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        };
        film.open_range(start).unwrap();
        for number in 0..film.tile_count() {
            let rect = film.tile_rect(number);
            let mut tile = FilmTile::new(rect, start..start + n, Layers::NONE);
            for y in rect.y..rect.y + rect.height {
                for x in rect.x..rect.x + rect.width {
                    for _ in 0..n {
                        let radiance = [light([x, y], [next(), next()]); 3];
                        tile.add(x, y, &Sample { radiance, hit: true, ..Sample::default() });
                    }
                }
            }
            film.merge_tile(&tile);
        }
        film.complete_through(start + n).unwrap();
    }

    /// Uniform noise about 1, and a path of probability `p` that brings `share` beside it.
    fn with_rare_path(n: u64, seed: u64, p: f32, share: f32) -> Film {
        film(n, seed, |_, [u, v]| 0.5 + u + if v < p { share / p } else { 0.0 })
    }

    #[test]
    fn a_rare_path_is_told_without_bias_while_hardly_a_pixel_has_met_it() {
        let films: Vec<Film> = (0..20).map(|seed| with_rare_path(32, seed, 1e-3, 0.3)).collect();
        let shares: Vec<f64> = films.iter().map(|film| film.unseen_light(0.1).share).collect();
        let mean = shares.iter().sum::<f64>() / 20.0;
        // 74 events a picture: 20 pictures tell it to 2.6 %. The mean of the pixels around holds some twice-met ones.
        assert!((mean - 0.3).abs() < 0.03, "{mean}");
        let median = films[0].median_relative_error().unwrap();
        assert!(median < 0.06, "the median alone says {median}");
        assert!(films.iter().all(|film| film.error_against(0.06).unwrap() > 0.2));
    }

    #[test]
    fn a_render_that_waits_for_unseen_light_ends_with_the_error_it_says() {
        // Where the typical pixel is right to the stated error in the picture of each seed, and where a third of all
        // pixels at most is off by more than that, as of normally distributed ones (31.7 %).
        let (mut off, mut all) = (0, 0);
        for seed in 0..20 {
            let (p, share, asked) = (0.02, 0.4, 0.2);
            let light = |_: [u32; 2], [u, v]: [f32; 2]| 0.5 + u + if v < p { share / p } else { 0.0 };
            let mut film = Film::new(SIZE[0], SIZE[1], Layers::NONE).unwrap();
            add_samples(&mut film, 16, seed, light);
            while film.error_against(asked).unwrap() > asked {
                let more = film.complete().count() / 4;
                add_samples(&mut film, more, seed, light);
            }
            let truth = 1.0 + f64::from(share);
            let mut errors: Vec<f64> =
                film.mean_image().iter().map(|mean| (f64::from(mean[0]) / truth - 1.0).abs()).collect();
            errors.sort_by(f64::total_cmp);
            assert!(errors[errors.len() / 2] < asked, "{seed}: {}", errors[errors.len() / 2]);
            off += errors.iter().filter(|&&error| error > asked).count();
            all += errors.len();
            let [mean, ..] = film.image_mean();
            assert!((mean.mean - truth).abs() < 4.0 * mean.standard_error, "{seed}: {mean:?}");
        }
        assert!(off as f64 <= 0.33 * all as f64, "{off} of {all}");
    }

    #[test]
    fn the_bound_holds_what_is_missing_if_few_pixels_tell() {
        // 1.5 events are expected: nobody knows of the path in 22 % of the pictures, and that cannot be helped.
        let films = (0..200).map(|seed| with_rare_path(16, seed, 4e-5, 0.3));
        let (mut knowing, mut covered) = (0, 0);
        for film in films {
            let unseen = film.unseen_light(0.1);
            knowing += u32::from(unseen.pixels > 0);
            covered += u32::from(unseen.bound >= 0.3);
        }
        // Chance leaves one event in a third of the pictures, which tells 0.2 with a bound of 0.6.
        assert!(knowing > 130 && covered == knowing, "{covered} of {knowing}");
    }

    #[test]
    fn light_that_all_pixels_have_met_is_no_longer_unseen() {
        // Every pixel has met it about eight times, and its own error tells.
        let film = with_rare_path(256, 1, 0.03, 0.3);
        let median = film.median_relative_error().unwrap();
        assert_eq!(film.unseen_light(median), UnseenLight::default());
        assert_eq!(film.error_against(median), Some(median));
    }

    #[test]
    fn plain_noise_hides_nothing() {
        // Exponential noise, at few samples and at many.
        for n in [16, 100, 400] {
            let film = film(n, n, |_, [u, _]| -(1.0 - u).ln());
            let median = film.median_relative_error().unwrap();
            let unseen = film.unseen_light(median);
            assert!(unseen.bound < 0.25 * median, "{n}: {unseen:?} {median}");
        }
    }

    #[test]
    fn the_edge_of_a_bright_lamp_is_no_light_that_others_lack() {
        // A lamp of 300 pixels, 1000 times as bright as the rest; its edge covers a hundredth of the pixels it cuts.
        let is_lamp = |[x, y]: [u32; 2]| (20..40).contains(&x) && (10..25).contains(&y);
        let is_edge = |[x, y]: [u32; 2]| x == 40 && (10..25).contains(&y);
        let film = film(64, 3, |at, [u, v]| match (is_lamp(at), is_edge(at)) {
            (true, _) => 1000.0,
            (_, true) if v < 0.01 => 1000.0,
            _ => 0.5 + u,
        });
        let unseen = film.unseen_light(0.05);
        assert!(unseen.pixels > 2 && unseen.bound < 0.001, "{unseen:?}");
    }

    #[test]
    fn a_bright_lamp_does_not_hide_what_the_rest_lacks() {
        let light = |[x, _]: [u32; 2], [u, v]: [f32; 2]| match x {
            0..5 => 1e5,
            _ => 0.5 + u + if v < 1e-3 { 300.0 } else { 0.0 },
        };
        assert!(film(32, 5, light).unseen_light(0.1).share > 0.2);
    }

    #[test]
    fn black_pictures_say_nothing_and_few_lit_pixels_say_that_all_is_unknown() {
        let black = film(16, 1, |_, _| 0.0);
        assert_eq!((black.error_against(0.1), black.largest_sample_share()), (None, None));
        assert_eq!(black.unseen_light(0.1), UnseenLight::default());
        let sparse = film(16, 1, |_, [u, _]| f32::from(u < 1e-3));
        assert!(sparse.unseen_light(0.1).bound >= 1.0 && sparse.error_against(0.1).unwrap() > 0.9);
    }

    #[test]
    fn the_largest_sample_has_its_share_of_all_light() {
        let film = film(16, 1, |[x, y], [_, v]| if [x, y] == [3, 4] && v < 0.5 { 2304.0 } else { 1.0 });
        let events = film.mean(3, 4)[0] * 16.0 / 2303.0;
        let truth = 2304.0 / (16.0 * 2304.0 + 2303.0 * events.floor());
        assert!((film.largest_sample_share().unwrap() - truth).abs() < 1e-6, "{events}");
    }
}
