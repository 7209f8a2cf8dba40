//! Text of files as part of a message.

/// A text in one line of at most so many letters: what a damaged or hostile file says may be of any length and hold line breaks.
///
/// ```
/// assert_eq!(tyndall_machine::one_line("a\nlong name", 6), "a long…");
/// ```
pub fn one_line(text: &str, longest: usize) -> String {
    let mut line: String = text.chars().take(longest).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(longest).is_some() {
        line.push('…');
    }
    line
}
