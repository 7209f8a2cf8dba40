//! What has to be told along with a picture: where its stated errors do not hold.

use crate::film::Film;

/// One line for each reason to doubt a picture, which is several films if it has more than three bands; none if there is
/// no such reason.
pub fn warnings<'a>(films: impl IntoIterator<Item = &'a Film>) -> Vec<String> {
    let (mut rejected, mut held) = (0, 0.0);
    for film in films {
        rejected += film.rejected();
        held += film.mean_sample_count() * f64::from(film.width()) * f64::from(film.height());
    }
    if rejected == 0 {
        return Vec::new();
    }
    vec![format!(
        "{rejected} samples ({}) were not finite or too large and are left out; the light that they stand for is \
         missing, so that the picture may be biased by it",
        percent(rejected as f64 / held)
    )]
}

/// A share with two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    // Two digits of 100 % or more are no longer two digits.
    let decimals = (1.0 - percent.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::FilmTile;
    use crate::sample::{Layers, Sample};

    fn film(samples: &[f32]) -> Film {
        let mut film = Film::new(1, 1, Layers::NONE).unwrap();
        let n = samples.len() as u64;
        film.open_range(0).unwrap();
        let mut tile = FilmTile::new(film.tile_rect(0), 0..n, Layers::NONE);
        samples.iter().for_each(|&x| tile.add(0, 0, &Sample { radiance: [x; 3], ..Sample::default() }));
        film.merge_tile(&tile);
        film.complete_through(n).unwrap();
        film
    }

    #[test]
    fn a_picture_without_rejected_samples_needs_no_warning() {
        assert_eq!(warnings([&film(&[1.0, 2.0])]), Vec::<String>::new());
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
