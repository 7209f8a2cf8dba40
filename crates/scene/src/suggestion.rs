//! The word that was probably meant.

/// `, did you mean …?`, or what there is to choose from.
pub(crate) fn did_you_mean<'a>(word: &str, choices: impl Iterator<Item = &'a str>) -> String {
    let choices: Vec<&str> = choices.collect();
    match nearest(word, choices.iter().copied()) {
        Some(choice) => format!(", did you mean `{choice}`?"),
        None if choices.is_empty() => String::new(),
        None => format!("; there is {}", list_of(choices)),
    }
}

/// The choice that differs least from `word`, in a third of the letters at most.
pub(crate) fn nearest<'a>(word: &str, choices: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    choices
        .map(|choice| (strsim::damerau_levenshtein(&word, &choice.to_lowercase()), choice))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, choice)| 3 * distance <= word.chars().count().max(choice.len()))
        .map(|(_, choice)| choice)
}

/// The words, quoted.
pub(crate) fn list_of<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}
