//! Where the standard errors of tallies do not say how far off a value may be.

use super::tally::Tallies;

/// One line for each reason to doubt values that are the tallies with the numbers and names given.
pub fn doubts<'a>(tallies: &Tallies, values: impl IntoIterator<Item = (usize, &'a str)>) -> Vec<String> {
    let mut doubts = Vec::new();
    let photons = tallies.photons();
    if tallies.rejected() > 0 {
        doubts.push(format!(
            "{} of {photons} photons brought what is not finite or too large and are left out; the values may be biased \
             by it",
            tallies.rejected()
        ));
    }
    let (mut any, mut any_met) = (false, false);
    for (tally, name) in values {
        any = true;
        any_met |= tallies.is_met(tally);
        if !tallies.is_error_known(tally) {
            doubts.push(format!(
                "{name}: one photon makes {:.0} % of its variance, so that its standard error is known badly and may be \
                 too small; more photons will tell (--samples)",
                100.0 * tallies.largest_share(tally)
            ));
        }
    }
    // One colour alone may well be missing from all lights.
    if any && !any_met && photons > 0 {
        doubts.push(format!(
            "none of {photons} photons has met any light; what fewer than one in so many meet is not known"
        ));
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::super::tally::Scores;
    use super::*;

    #[test]
    fn each_doubt_names_its_value_and_none_is_raised_without_a_reason() {
        let (mut tallies, mut scores) = (Tallies::new(3), Scores::new(3));
        for photon in 0..100 {
            scores.add(0, f64::from(photon % 7));
            scores.add(1, if photon == 3 { 1.0 } else { 0.0 });
            tallies.take(&mut scores);
        }
        assert_eq!(doubts(&tallies, [(0, "red")]), Vec::<String>::new());
        let lines = doubts(&tallies, [(0, "red"), (1, "green"), (2, "blue")]);
        assert!(lines.len() == 1 && lines[0].starts_with("green: one photon makes 99 %"), "{lines:?}");
        assert!(doubts(&tallies, [(2, "blue")])[0].starts_with("none of 100 photons"));
        scores.add(0, f64::NAN);
        tallies.take(&mut scores);
        assert!(doubts(&tallies, [])[0].starts_with("1 of 101 photons"));
    }
}
