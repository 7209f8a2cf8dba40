//! What the sums say: means, and how sure they are.
//!
//! ```text
//! mean = Σx / n      standard error = sqrt(s² / n),  s² = (n Σx² − (Σx)²) / (n (n − 1))
//! ```
//!
//! n counts the samples that are in the sums: not those that were rejected (see [`Film`]).
//!
//! Samples of a pixel are independent, so the standard error is that of the mean; for a few dozen samples and more
//! an interval of ±1.96 of it covers the truth about 95 % of the time (central limit theorem). Of few it covers less, by
//! Student's t of normally distributed samples 93 % of 16, the fewest that `--error` believes, and 86 % of 4. What a pixel
//! has not met at all its samples cannot tell: see `heavy_tails`.

use serde::{Deserialize, Serialize};

use crate::film::Film;
use crate::fixed_point::{SUM_FRACTION_BITS, sample_variance, to_f64};
use crate::sums::{ALBEDO_FRACTION_BITS, DEPTH_FRACTION_BITS, NORMAL_FRACTION_BITS};

/// Weights of linear Rec.709 red, green and blue in luminance (ITU-R BT.709).
pub const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// A number and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The number.
    pub mean: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// A picture layer by name, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name in an EXR file, such as `R` or `StandardError.R`.
    pub name: String,
    /// Values, width times height of them.
    pub values: Vec<f32>,
}

impl Film {
    /// Mean radiance of pixel (`x`, `y`); 0 without samples.
    pub fn mean(&self, x: u32, y: u32) -> [f64; 3] {
        let index = self.index(x, y);
        self.pixel_mean(index, self.good_samples(index, self.sample_count(x, y)))
    }

    /// Standard error of the mean of pixel (`x`, `y`); infinite with fewer than two samples that were not rejected.
    pub fn standard_error(&self, x: u32, y: u32) -> [f64; 3] {
        let index = self.index(x, y);
        self.pixel_standard_error(index, self.good_samples(index, self.sample_count(x, y)))
    }

    /// Number of samples a pixel, those that were rejected among them; the mean of all pixels.
    pub fn mean_sample_count(&self) -> f64 {
        let mut total = 0.0;
        for y in 0..self.height {
            for x in 0..self.width {
                total += self.sample_count(x, y) as f64;
            }
        }
        total / self.sums.pixels.len() as f64
    }

    /// Mean of all pixels, and its standard error (pixels are independent).
    pub fn image_mean(&self) -> [Estimate; 3] {
        let (mut sum, mut variance) = ([0.0; 3], [0.0; 3]);
        self.for_each_pixel(|index, n| {
            let (mean, error) = (self.pixel_mean(index, n), self.pixel_standard_error(index, n));
            for c in 0..3 {
                sum[c] += mean[c];
                variance[c] += error[c] * error[c];
            }
        });
        let pixels = self.sums.pixels.len() as f64;
        [0, 1, 2].map(|c| Estimate { mean: sum[c] / pixels, standard_error: variance[c].sqrt() / pixels })
    }

    /// Median over the pixels of standard error / |mean| of luminance; `None` if the whole picture is black.
    ///
    /// The error of luminance Y is taken as Σ w·SE over the channels, which is exact where the channels vary
    /// together (as they do where a medium is grey) and otherwise too large. Black pixels have no relative error
    /// and are left out. So are the pixels that no path met a medium or surface in, as long as any did: sky behind a
    /// cloud is known at once and would hide the noise of the rest. Pixels all of whose samples were rejected count as
    /// wholly unknown. Infinite while most pixels have fewer than two samples.
    pub fn median_relative_error(&self) -> Option<f64> {
        let mut lit = false;
        let mut errors = Vec::new();
        let any_hit = self.any_hit();
        self.for_each_pixel(|index, n| {
            if n == 0 && self.rejected_of(index) > 0 {
                errors.push(f64::INFINITY);
                return;
            }
            if any_hit && self.sums.pixels[index].hits == 0 {
                return;
            }
            let (mean, error) = (self.pixel_mean(index, n), self.pixel_standard_error(index, n));
            let luminance = (0..3).map(|c| LUMINANCE[c] * mean[c]).sum::<f64>().abs();
            let error: f64 = (0..3).map(|c| LUMINANCE[c] * error[c]).sum();
            lit |= luminance > 0.0;
            if luminance > 0.0 {
                errors.push(error / luminance);
            }
        });
        if errors.is_empty() {
            return lit.then_some(0.0);
        }
        let middle = errors.len() / 2;
        Some(*errors.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Mean radiance of all pixels, row by row, for a picture.
    pub fn mean_image(&self) -> Vec<[f32; 3]> {
        let mut image = Vec::with_capacity(self.sums.pixels.len());
        self.for_each_pixel(|index, n| image.push(self.pixel_mean(index, n).map(|x| x as f32)));
        image
    }

    /// All layers under the names they have in an EXR file.
    ///
    /// `R G B` mean radiance; `A` coverage plus shadow; `Transmittance` = 1 − coverage; `StandardError.*`; `SampleCount`
    /// those that these are over; and as far as they are kept, `Depth.Z` mean distance to the first collision or surface (+∞ where there was none),
    /// `Albedo.*` and `Normal.*` their means there (the normal of a collision counts as 0, and the mean is no unit
    /// vector), the mean radiance that media emit or scatter, `Emission.*`, `Single.*`, `Multiple.*`, `ObjectId.Id` the
    /// greatest number of the objects seen (exact up to 2^24), `ShadowCatcher.A` the opacity of shadows, and `Effort` the
    /// random numbers that a sample took.
    ///
    /// Coverage is the fraction of camera paths that met a medium or a surface other than a shadow catcher. With C the
    /// reflected luminance of the camera rays that end on catchers,
    ///
    /// ```text
    /// shadow opacity = 1 − Σ C / Σ C without shadows, in [0, 1]      A = coverage + shadow opacity · rays on catchers / n
    /// ```
    ///
    /// so that the picture over a photograph, R + (1 − A) · photograph, darkens the photograph where shadows fall.
    pub fn channels(&self) -> Vec<Channel> {
        let mut channels = Vec::new();
        let sums = &self.sums;
        self.push_colour(&mut channels, "", |i, n| self.pixel_mean(i, n));
        self.push_colour(&mut channels, "StandardError.", |i, n| self.pixel_standard_error(i, n));
        self.push(&mut channels, "A", |i, n| self.alpha(i, n));
        self.push(&mut channels, "Transmittance", |i, n| 1.0 - self.coverage(i, n));
        self.push(&mut channels, "SampleCount", |_, n| n as f64);
        if self.layers.depth {
            self.push(&mut channels, "Depth.Z", |i, _| match sums.pixels[i].hits {
                0 => f64::INFINITY,
                hits => sums.depth.get(i).map_or(0.0, |&d| to_f64(d, DEPTH_FRACTION_BITS)) / hits as f64,
            });
        }
        if self.layers.albedo {
            self.push_colour(&mut channels, "Albedo.", |i, _| {
                let hits = sums.pixels[i].hits.max(1) as f64;
                let albedo = sums.albedo.get(i).copied().unwrap_or_default();
                albedo.map(|a| to_f64(a.into(), ALBEDO_FRACTION_BITS) / hits)
            });
        }
        for (keep, name, plane) in [
            (self.layers.emission, "Emission.", &sums.emission),
            (self.layers.single, "Single.", &sums.single),
            (self.layers.multiple, "Multiple.", &sums.multiple),
        ] {
            if keep {
                self.push_colour(&mut channels, name, |i, n| {
                    mean_of(plane.get(i).copied().unwrap_or_default(), n)
                });
            }
        }
        if self.layers.normal {
            self.push_triple(&mut channels, "Normal.", ["X", "Y", "Z"], |i, _| {
                let hits = sums.pixels[i].hits.max(1) as f64;
                let normal = sums.normal.get(i).copied().unwrap_or_default();
                normal.map(|x| to_f64((x as i64).into(), NORMAL_FRACTION_BITS) / hits)
            });
        }
        if self.layers.object_id {
            self.push(&mut channels, "ObjectId.Id", |i, _| sums.object.get(i).copied().unwrap_or(0).into());
        }
        if self.layers.shadow_catcher {
            self.push(&mut channels, "ShadowCatcher.A", |i, _| self.shadow_opacity(i));
        }
        if self.layers.effort {
            self.push(&mut channels, "Effort", |i, n| self.effort(i, n));
        }
        channels
    }

    /// Random numbers that a sample of the pixel took, on average.
    pub(crate) fn effort(&self, index: usize, n: u64) -> f64 {
        self.sums.effort.get(index).map_or(0.0, |&effort| effort as f64) / n.max(1) as f64
    }

    fn push(&self, channels: &mut Vec<Channel>, name: &str, value: impl Fn(usize, u64) -> f64) {
        let mut values = Vec::with_capacity(self.sums.pixels.len());
        self.for_each_pixel(|index, n| values.push(value(index, n) as f32));
        channels.push(Channel { name: name.to_owned(), values });
    }

    fn push_colour(&self, channels: &mut Vec<Channel>, layer: &str, value: impl Fn(usize, u64) -> [f64; 3]) {
        self.push_triple(channels, layer, ["R", "G", "B"], value);
    }

    fn push_triple(
        &self,
        channels: &mut Vec<Channel>,
        layer: &str,
        names: [&str; 3],
        value: impl Fn(usize, u64) -> [f64; 3],
    ) {
        let mut values = [(); 3].map(|()| Vec::with_capacity(self.sums.pixels.len()));
        self.for_each_pixel(|index, n| {
            for (plane, x) in values.iter_mut().zip(value(index, n)) {
                plane.push(x as f32);
            }
        });
        for (values, name) in values.into_iter().zip(names) {
            channels.push(Channel { name: format!("{layer}{name}"), values });
        }
    }

    pub(crate) fn index(&self, x: u32, y: u32) -> usize {
        assert!(x < self.width && y < self.height, "({x}, {y}) is no pixel of the film");
        y as usize * self.width as usize + x as usize
    }

    /// Whether any camera path met anything.
    pub(crate) fn any_hit(&self) -> bool {
        self.sums.pixels.iter().any(|pixel| pixel.hits > 0)
    }

    fn rejected_of(&self, index: usize) -> u64 {
        self.sums.rejected.get(index).copied().unwrap_or(0).into()
    }

    /// How many of `held` samples are in the sums of the pixel. A file may claim more rejected ones than there are.
    fn good_samples(&self, index: usize, held: u64) -> u64 {
        held.saturating_sub(self.rejected_of(index))
    }

    /// Calls `visit(index, number of samples in its sums)` for every pixel, row by row.
    pub(crate) fn for_each_pixel(&self, mut visit: impl FnMut(usize, u64)) {
        let mut index = 0;
        for y in 0..self.height {
            for x in 0..self.width {
                visit(index, self.good_samples(index, self.sample_count(x, y)));
                index += 1;
            }
        }
    }

    pub(crate) fn pixel_mean(&self, index: usize, n: u64) -> [f64; 3] {
        mean_of(self.sums.pixels[index].radiance, n)
    }

    pub(crate) fn pixel_standard_error(&self, index: usize, n: u64) -> [f64; 3] {
        let pixel = &self.sums.pixels[index];
        [0, 1, 2].map(|c| (sample_variance(n, pixel.radiance[c], pixel.squares[c]) / n.max(1) as f64).sqrt())
    }

    fn coverage(&self, index: usize, n: u64) -> f64 {
        self.sums.pixels[index].hits as f64 / n.max(1) as f64
    }

    fn alpha(&self, index: usize, n: u64) -> f64 {
        let on_catcher = self.sums.catcher.get(index).map_or(0, |sums| sums.rays) as f64 / n.max(1) as f64;
        self.coverage(index, n) + on_catcher * self.shadow_opacity(index)
    }

    /// 0 where no ray ended on a catcher, or on none that anything could light.
    fn shadow_opacity(&self, index: usize) -> f64 {
        let Some(sums) = self.sums.catcher.get(index) else { return 0.0 };
        let [lit, unshadowed] = sums.light.map(|sum| to_f64(sum, SUM_FRACTION_BITS));
        if unshadowed > 0.0 { (1.0 - lit / unshadowed).clamp(0.0, 1.0) } else { 0.0 }
    }
}

fn mean_of(sums: [i128; 3], n: u64) -> [f64; 3] {
    sums.map(|sum| to_f64(sum, SUM_FRACTION_BITS) / n.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmTile;
    use crate::sample::{Layers, Sample};

    /// A film one pixel high whose pixels get the samples given.
    fn film(pixels: &[&[Sample]]) -> Film {
        let layers = Layers { effort: true, ..Layers::ALL };
        let mut film = Film::new(pixels.len() as u32, 1, layers).unwrap();
        let n = pixels[0].len() as u64;
        film.open_range(0).unwrap();
        let mut tile = FilmTile::new(film.tile_rect(0), 0..n, layers);
        for (x, samples) in pixels.iter().enumerate() {
            samples.iter().for_each(|sample| tile.add(x as u32, 0, sample));
        }
        film.merge_tile(&tile);
        film.complete_through(n).unwrap();
        film
    }

    fn grey(x: f32) -> Sample {
        Sample { radiance: [x; 3], ..Sample::default() }
    }

    fn value(film: &Film, name: &str) -> f32 {
        film.channels().into_iter().find(|c| c.name == name).map_or(f32::NAN, |c| c.values[0])
    }

    #[test]
    fn mean_and_standard_error_are_those_of_the_textbook() {
        let film = film(&[&[1.0, 2.0, 3.0, 4.0].map(grey)]);
        assert_eq!(film.mean(0, 0), [2.5; 3]);
        let expected = (5.0f64 / 3.0 / 4.0).sqrt();
        assert!((film.standard_error(0, 0)[0] - expected).abs() < 1e-15);
    }

    #[test]
    fn rejected_samples_are_left_out_of_every_mean_and_error() {
        let grey = |x: f32| Sample { hit: true, depth: x, single: [x; 3], ..grey(x) };
        let spoilt = [1.0, f32::NAN, 2.0, 3.0, f32::INFINITY, 4.0, -9e9].map(grey);
        let (with, without) = (film(&[&spoilt]), film(&[&[1.0, 2.0, 3.0, 4.0].map(grey)]));
        assert_eq!((with.rejected(), with.mean_sample_count()), (3, 7.0));
        assert_eq!(with.channels(), without.channels());
        assert_eq!(with.image_mean(), without.image_mean());
        assert_eq!(with.median_relative_error(), without.median_relative_error());
    }

    #[test]
    fn a_pixel_all_of_whose_samples_were_rejected_is_black_and_wholly_unknown() {
        let film = film(&[&[f32::NAN; 4].map(grey)]);
        assert_eq!((film.mean(0, 0), film.standard_error(0, 0)), ([0.0; 3], [f64::INFINITY; 3]));
        assert_eq!(film.median_relative_error(), Some(f64::INFINITY));
        assert_eq!(film.image_mean()[0].standard_error, f64::INFINITY);
        let finite = |x: &f32| x.is_finite();
        let of_light = |c: &Channel| !c.name.starts_with("StandardError") && c.name != "Depth.Z";
        assert!(film.channels().iter().filter(|c| of_light(c)).all(|c| c.values.iter().all(finite)));
    }

    #[test]
    fn a_faint_signal_on_a_bright_ground_keeps_its_error() {
        // (Σx)² and n Σx² agree in their first 15 digits here.
        let film = film(&[&[1.0e6, 1.0e6 + 0.0625].map(grey)]);
        assert!((film.standard_error(0, 0)[1] - 0.03125).abs() < 1e-15);
    }

    #[test]
    fn layers_are_averaged_over_what_they_are_about() {
        let hit = Sample {
            radiance: [3.0; 3],
            hit: true,
            depth: 10.0,
            albedo: [0.5, 0.75, 1.0],
            normal: [0.0, -1.0, 0.0],
            object: 7,
            catcher: [0.0; 2],
            emission: [1.0; 3],
            single: [0.5; 3],
            multiple: [1.5; 3],
            effort: 12,
        };
        let other = Sample { depth: 20.0, normal: [0.0; 3], object: 16_777_213, ..hit };
        let film = film(&[&[hit, other, grey(1.0), grey(1.0)]]);
        for (name, expected) in [
            ("R", 2.0),
            ("A", 0.5),
            ("Transmittance", 0.5),
            ("SampleCount", 4.0),
            ("Depth.Z", 15.0),
            ("Albedo.R", 0.5),
            ("Albedo.B", 1.0),
            ("Emission.G", 0.5),
            ("Single.G", 0.25),
            ("Multiple.G", 0.75),
            ("Normal.X", 0.0),
            ("Normal.Y", -0.5),
            ("ObjectId.Id", 16_777_213.0),
            ("ShadowCatcher.A", 0.0),
            ("Effort", 6.0),
        ] {
            assert_eq!(value(&film, name), expected, "{name}");
        }
    }

    #[test]
    fn shadows_on_catchers_are_opaque_by_the_light_they_take_away() {
        let on_catcher = |catcher| Sample { object: 3, catcher, ..Sample::default() };
        let hit = Sample { hit: true, object: 2, catcher: [9.0; 2], ..Sample::default() };
        // Half of the samples on the catcher, which in sum is lit by a quarter of its light; one draws no light at all.
        let shadow = [[0.25, 0.5], [0.25, 1.5], [0.0, 0.0], [0.0, 0.0]].map(on_catcher);
        let pixels = [shadow[0], shadow[1], shadow[2], shadow[3], hit, hit, grey(1.0), grey(1.0)];
        let film = film(&[&pixels]);
        assert_eq!(value(&film, "ShadowCatcher.A"), 0.75);
        assert_eq!(value(&film, "A"), 0.25 + 0.5 * 0.75);
        assert_eq!((value(&film, "Transmittance"), value(&film, "ObjectId.Id")), (0.75, 3.0));
        // Noise may find more light with shadows than without; a catcher in the dark has none to lose.
        for catcher in [[2.0, 1.0], [0.0, 0.0]] {
            let film = super::tests::film(&[&[on_catcher(catcher)]]);
            assert_eq!((value(&film, "ShadowCatcher.A"), value(&film, "A")), (0.0, 0.0));
        }
    }

    #[test]
    fn where_no_path_met_a_medium_the_depth_is_infinite() {
        let film = film(&[&[grey(1.0), grey(1.0)]]);
        assert_eq!(value(&film, "Depth.Z"), f32::INFINITY);
        assert_eq!((value(&film, "A"), value(&film, "Albedo.R")), (0.0, 0.0));
    }

    #[test]
    fn the_median_relative_error_leaves_out_black_pixels_and_plain_background() {
        let (black, exact) = ([0.0; 4].map(grey), [1.0; 4].map(grey));
        let noisy = [1.0, 2.0, 3.0, 4.0].map(|x| Sample { hit: true, ..grey(x) });
        let expected = (5.0f64 / 3.0 / 4.0).sqrt() / 2.5;
        let error = film(&[&black, &exact, &noisy, &exact, &exact]).median_relative_error().unwrap();
        assert!((error - expected).abs() < 1e-12);
        assert_eq!(film(&[&black]).median_relative_error(), None);
        assert_eq!(film(&[&exact]).median_relative_error(), Some(0.0));
        assert_eq!(film(&[&[grey(1.0)]]).median_relative_error(), Some(f64::INFINITY));
    }

    #[test]
    fn the_mean_of_the_image_has_the_error_of_independent_pixels() {
        let noisy = [1.0, 2.0, 3.0, 4.0].map(grey);
        let film = film(&[&noisy, &[0.0; 4].map(grey)]);
        let [red, ..] = film.image_mean();
        assert_eq!(red.mean, 1.25);
        assert!((red.standard_error - (5.0f64 / 12.0).sqrt() / 2.0).abs() < 1e-15);
    }

    #[test]
    fn stated_intervals_cover_the_truth_as_often_as_they_say() {
        // 4000 pixels of 64 uniform numbers: 95 % intervals must cover 1/2 in 95 % of them, up to 3.5 sigma of
        // the binomial and the small loss of Student's t at 63 degrees of freedom (0.5 %).
        let mut state = 1u64;
        let mut covered = 0;
        for _ in 0..4000 {
            let samples: Vec<Sample> = (0..64)
                .map(|_| {
                    state =
                        state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    grey((state >> 40) as f32 / (1 << 24) as f32)
                })
                .collect();
            let film = film(&[&samples]);
            let (mean, error) = (film.mean(0, 0)[0], film.standard_error(0, 0)[0]);
            covered += u32::from((mean - 0.5).abs() < 1.96 * error);
        }
        let fraction = f64::from(covered) / 4000.0;
        assert!((fraction - 0.945).abs() < 0.013, "{fraction}");
    }
}
