//! The words of a pbrt-v4 scene file: numbers and directives, `"strings"`, brackets; `#` begins a comment.

use std::path::Path;
use std::sync::Arc;

use super::place::Place;
use crate::ImportError;

/// A word of a scene file.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token<'a> {
    /// A bare word: a directive, a number, `true`, `false`.
    Word(&'a [u8]),
    /// A string without its quotes.
    Text(String),
    /// `[`
    Open,
    /// `]`
    Close,
}

impl Token<'_> {
    /// The token for a message, shortened.
    pub(super) fn shown(&self) -> String {
        let shorten = |text: &str| -> String {
            let plain: String = text.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
            match plain.char_indices().nth(40) {
                Some((end, _)) => format!("{}…", &plain[..end]),
                None => plain,
            }
        };
        match self {
            Self::Word(word) => format!("`{}`", shorten(&String::from_utf8_lossy(word))),
            Self::Text(text) => format!("\"{}\"", shorten(text)),
            Self::Open => "`[`".to_owned(),
            Self::Close => "`]`".to_owned(),
        }
    }
}

/// Goes through the words of a file.
#[derive(Debug, Clone)]
pub(super) struct Tokens<'a> {
    bytes: &'a [u8],
    position: usize,
    line: usize,
    file: Arc<Path>,
}

impl<'a> Tokens<'a> {
    /// The words of `bytes`, which are the content of `file`.
    pub(super) fn new(bytes: &'a [u8], file: Arc<Path>) -> Self {
        Self { bytes, position: 0, line: 1, file }
    }

    /// The line of the word that comes next.
    pub(super) fn place(&mut self) -> Place {
        self.skip_blanks();
        Place { file: self.file.clone(), line: self.line }
    }

    /// The next word, which stays.
    pub(super) fn peek(&mut self) -> Result<Option<Token<'a>>, ImportError> {
        self.skip_blanks();
        let (position, line) = (self.position, self.line);
        let token = self.next();
        (self.position, self.line) = (position, line);
        token
    }

    /// The next word, if the file has one.
    pub(super) fn next(&mut self) -> Result<Option<Token<'a>>, ImportError> {
        self.skip_blanks();
        let Some(&first) = self.bytes.get(self.position) else { return Ok(None) };
        let start = self.position;
        self.position += 1;
        Ok(Some(match first {
            b'[' => Token::Open,
            b']' => Token::Close,
            b'"' => Token::Text(self.text()?),
            _ => {
                let rest = &self.bytes[start..];
                let length = rest.iter().position(|&byte| ends_word(byte)).unwrap_or(rest.len());
                self.position = start + length;
                Token::Word(&rest[..length])
            }
        }))
    }

    /// What follows an opening quote, up to the closing one.
    fn text(&mut self) -> Result<String, ImportError> {
        let place = Place { file: self.file.clone(), line: self.line };
        let mut text = Vec::new();
        loop {
            let Some(&byte) = self.bytes.get(self.position) else {
                return Err(place.error("the file ends within a string: close it with `\"`"));
            };
            self.position += 1;
            match byte {
                b'"' => return Ok(String::from_utf8_lossy(&text).into_owned()),
                b'\n' => return Err(place.error("the line ends within a string: close it with `\"`")),
                b'\\' => {
                    let escaped = self.bytes.get(self.position).copied();
                    self.position += 1;
                    text.push(match escaped {
                        Some(b'n') => b'\n',
                        Some(b't') => b'\t',
                        Some(b'r') => b'\r',
                        Some(b'b') => 8,
                        Some(b'f') => 12,
                        Some(byte @ (b'\\' | b'"' | b'\'')) => byte,
                        _ => return Err(place.error("an odd `\\` in a string: write `\\\\` for a backslash")),
                    });
                }
                byte => text.push(byte),
            }
        }
    }

    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.position) {
            match byte {
                b'\n' => self.line += 1,
                b' ' | b'\t' | b'\r' => {}
                b'#' => {
                    let rest = &self.bytes[self.position..];
                    self.position += rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
                    continue;
                }
                _ => return,
            }
            self.position += 1;
        }
    }
}

fn ends_word(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b'"' | b'[' | b']')
}

/// Greatest magnitude of a number: products of a few such numbers stay finite.
pub(super) const GREATEST: f64 = 1e30;

/// The number that a bare word is, if that is within [`GREATEST`].
pub(super) fn number(word: &[u8]) -> Option<f64> {
    // Rust also takes `inf`, `nan` and their like for numbers.
    let is_plain = word.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    let number: f64 = std::str::from_utf8(word).ok().filter(|_| is_plain)?.parse().ok()?;
    (number.abs() <= GREATEST).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<(Token<'_>, usize)> {
        let mut tokens = Tokens::new(text.as_bytes(), Arc::from(Path::new("a.pbrt")));
        let mut all = Vec::new();
        loop {
            let line = tokens.place().line;
            match tokens.next().unwrap() {
                Some(token) => all.push((token, line)),
                None => return all,
            }
        }
    }

    #[test]
    fn words_strings_and_brackets_stand_on_their_lines() {
        let found = tokens("Film \"rgb\" # a comment \"\n\"integer n\"[3]\r\nWorldBegin#x");
        let word = |text: &'static str| Token::Word(text.as_bytes());
        let text = |text: &str| Token::Text(text.to_owned());
        let expected = [
            (word("Film"), 1),
            (text("rgb"), 1),
            (text("integer n"), 2),
            (Token::Open, 2),
            (word("3"), 2),
            (Token::Close, 2),
            (word("WorldBegin#x"), 3),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn strings_have_escapes_and_an_end() {
        assert_eq!(tokens("\"a\\\\b \\\"c\\\"\""), [(Token::Text("a\\b \"c\"".into()), 1)]);
        for bad in ["\"a", "\"a\nb\"", "\"\\", "\"\\x\""] {
            let error = Tokens::new(bad.as_bytes(), Arc::from(Path::new("a.pbrt"))).next().unwrap_err();
            assert!(error.to_string().starts_with("a.pbrt:1: "), "{error}");
        }
    }

    #[test]
    fn only_numbers_to_compute_with_are_numbers() {
        for (word, value) in [("1", 1.0), ("-.5", -0.5), ("+2.", 2.0), ("1e-3", 1e-3), ("0012", 12.0)] {
            assert_eq!(number(word.as_bytes()), Some(value), "{word}");
        }
        for word in ["", "-", "inf", "NaN", "1e999", "1e31", "0x10", "1,5", "true", "e"] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
    }
}
