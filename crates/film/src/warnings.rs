//! What has to be told along with a picture: where its stated errors do not hold.

use crate::film::Film;
use crate::heavy_tails::LEAST_STATED_ERROR;

/// A sample with a greater share in a picture's light makes its mean uncertain in a way that its error does not tell.
const GREAT_SHARE: f64 = 0.05;

/// One line for each reason to doubt a picture, which is several films if it has more than three bands; none if there is
/// no such reason.
pub fn warnings<'a>(films: impl IntoIterator<Item = &'a Film> + Clone) -> Vec<String> {
    let worst = films.clone().into_iter().filter_map(heavy_tail);
    let heavy_tail = worst.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, line)| line);
    let empty = films.clone().into_iter().find_map(empty_pixels);
    rejected_samples(films).into_iter().chain(empty).chain(heavy_tail).collect()
}

/// A part of an adaptive picture may hold samples of some pixels alone.
fn empty_pixels(film: &Film) -> Option<String> {
    if film.rates().is_none() || film.complete().count() == 0 {
        return None;
    }
    let pixels = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
    let empty = pixels.filter(|&(x, y)| film.sample_count(x, y) == 0).count();
    (empty > 0).then(|| {
        format!(
            "{empty} pixels have no sample in this part of an adaptive picture and are black; merge it with the other parts"
        )
    })
}

fn rejected_samples<'a>(films: impl IntoIterator<Item = &'a Film>) -> Option<String> {
    let (mut rejected, mut held) = (0, 0.0);
    for film in films {
        rejected += film.rejected();
        held += film.mean_sample_count() * f64::from(film.width()) * f64::from(film.height());
    }
    (rejected > 0).then(|| {
        format!(
            "{rejected} samples ({}) were not finite or too large and are left out; the light that they stand for is \
             missing, so that the picture may be biased by it",
            percent(rejected as f64 / held)
        )
    })
}

/// Of fewer samples a pixel each is much of it, and nothing is said.
const LEAST_SAMPLES: f64 = 16.0;

/// What single samples make of a film, if that is more than its errors tell; and how much it is.
fn heavy_tail(film: &Film) -> Option<(f64, String)> {
    if film.mean_sample_count() < LEAST_SAMPLES {
        return None;
    }
    let stated = film.median_relative_error().filter(|error| error.is_finite())?;
    let unseen = film.stated_unseen_light()?;
    if unseen.bound > stated.max(LEAST_STATED_ERROR) {
        let lacking = if unseen.bound.is_finite() {
            format!("about {} of the light, up to {}", percent(unseen.share), percent(unseen.bound))
        } else {
            "most of the light".to_owned()
        };
        let line = format!(
            "{} pixels owe more than {} of their light to one sample: the others have not seen it yet, lack {lacking}, \
             and state errors that are too small; more samples will tell (--spp, or --error, which waits for that)",
            unseen.pixels,
            percent(stated.max(LEAST_STATED_ERROR)),
        );
        return Some((unseen.bound, line));
    }
    // Of few samples each is a great part.
    let samples = film.mean_sample_count() * f64::from(film.width()) * f64::from(film.height());
    let largest = film.largest_sample_share().filter(|&share| share > GREAT_SHARE.max(10.0 / samples))?;
    let line = format!(
        "one sample makes {} of the picture's light: the error of its mean is known badly; more samples will tell (--spp)",
        percent(largest)
    );
    Some((largest, line))
}

/// A share with two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    // Two digits of 100 % or more are no longer two digits.
    let decimals = (1.0 - libm::log10(percent.abs()).floor()).clamp(0.0, 9.0) as usize;
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmTile;
    use crate::sample::{Layers, Sample};

    /// A film whose pixels, 16 at most, all have the same samples, but for the first one, whose last sample is `last`.
    fn film_with(last: f32, pixels: u32, samples: &[f32]) -> Film {
        let mut film = Film::new(pixels, 1, Layers::NONE).unwrap();
        let n = samples.len() as u64;
        film.open_range(0).unwrap();
        let mut tile = FilmTile::new(film.tile_rect(0), 0..n, Layers::NONE);
        for x in 0..pixels {
            for (i, &own) in (1..).zip(samples) {
                let light = if x == 0 && i == n { last } else { own };
                tile.add(x, 0, &Sample { radiance: [light; 3], ..Sample::default() });
            }
        }
        film.merge_tile(&tile);
        film.complete_through(n).unwrap();
        film
    }

    fn film(samples: &[f32]) -> Film {
        film_with(samples[samples.len() - 1], 1, samples)
    }

    #[test]
    fn a_picture_of_plain_noise_needs_no_warning() {
        let noise = [1.0, 2.0, 3.0, 1.5, 2.5, 2.2, 1.3, 2.9, 1.0, 2.0, 3.0, 1.5, 2.5, 2.2, 1.3, 2.9];
        assert_eq!(warnings([&film_with(2.9, 16, &noise)]), Vec::<String>::new());
        assert_eq!(warnings([&film(&[0.0, 0.0])]), Vec::<String>::new());
    }

    #[test]
    fn light_that_one_pixel_alone_has_seen_is_told() {
        let lines = warnings([&film_with(100.0, 16, &[0.9, 1.1].repeat(16))]);
        assert!(
            lines.len() == 1 && lines[0].contains("1 pixels owe more than 1.8 % of their light"),
            "{lines:?}"
        );
    }

    #[test]
    fn a_sample_that_makes_much_of_the_picture_is_told_where_pixels_are_noisy_anyway() {
        let noise = [0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 10.0, 0.0];
        let lines = warnings([&film_with(40.0, 8, &noise.repeat(2))]);
        assert!(lines.len() == 1 && lines[0].contains("one sample makes"), "{lines:?}");
        assert_eq!(warnings([&film_with(40.0, 8, &noise)]), Vec::<String>::new(), "too few to tell");
    }

    #[test]
    fn rejected_samples_are_told_with_their_share_of_all_films() {
        let lines = warnings([&film(&[1.0, f32::NAN, 2.0, 3.0]), &film(&[1.0; 4])]);
        assert!(lines.len() == 1 && lines[0].starts_with("1 samples (12 %) were not finite"), "{lines:?}");
    }

    #[test]
    fn shares_have_two_digits() {
        for (share, text) in [(1.0, "100 %"), (0.5, "50 %"), (0.034, "3.4 %"), (0.00012, "0.012 %")] {
            assert_eq!(percent(share), text);
        }
    }
}
