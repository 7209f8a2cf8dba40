//! What can be wrong with a scene: one line for each problem, with file, line, column, key and the mend.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

/// A text under its name, shared by the problems in it.
pub(crate) type SceneText = Arc<NamedSource<Arc<str>>>;

/// Why a scene cannot be read or built. Displays as one line; as a [`Diagnostic`] it shows the place in the
/// file.
#[derive(Debug, Clone)]
pub struct SceneError {
    problems: Vec<Problem>,
}

/// One thing that is wrong.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The scene file, the `--set` option or the other file that is wrong.
    pub file: String,
    /// Line and column in it, from 1; columns count characters.
    pub position: Option<(usize, usize)>,
    /// What is wrong, and the mend.
    pub message: String,
    source: Option<(SceneText, Range<usize>)>,
}

impl SceneError {
    /// A problem with a file as a whole, such as an image that cannot be read.
    pub fn file(file: &Path, message: impl Into<String>) -> Self {
        Self::from(Problem {
            file: one_line(file.display().to_string()),
            position: None,
            message: one_line(message),
            source: None,
        })
    }

    /// All problems; at least one.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// `Ok` if there is no problem.
    pub(crate) fn unless_empty(problems: Vec<Problem>) -> Result<(), Self> {
        if problems.is_empty() { Ok(()) } else { Err(Self { problems }) }
    }
}

impl Problem {
    /// A problem at the bytes `span` of a text.
    pub(crate) fn at(text: &SceneText, span: Range<usize>, message: impl Into<String>) -> Self {
        let before = text.inner().get(..span.start).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |end| end + 1);
        let line = before.matches('\n').count() + 1;
        let column = before[line_start..].chars().count() + 1;
        Self {
            file: one_line(text.name()),
            position: Some((line, column)),
            message: one_line(message),
            source: Some((Arc::clone(text), span)),
        }
    }

    /// A problem with a `--set` option, shown without a position: the option is one line.
    pub(crate) fn option(option: &str, message: impl Into<String>) -> Self {
        Self { file: one_line(option), position: None, message: one_line(message), source: None }
    }
}

/// Messages quote what the file says, which may hold line breaks as escapes and be of any length.
fn one_line(message: impl Into<String>) -> String {
    tyndall_machine::one_line(&message.into(), 1000)
}

impl From<Problem> for SceneError {
    fn from(problem: Problem) -> Self {
        Self { problems: vec![problem] }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some((line, column)) => write!(f, "{}:{line}:{column}: {}", self.file, self.message),
            None => write!(f, "{}: {}", self.file, self.message),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut problems = self.problems.iter();
        if let Some(first) = problems.next() {
            write!(f, "{first}")?;
        }
        match problems.len() {
            0 => Ok(()),
            1 => write!(f, " (and 1 more problem)"),
            more => write!(f, " (and {more} more problems)"),
        }
    }
}

impl std::error::Error for Problem {}
impl std::error::Error for SceneError {}

impl Diagnostic for Problem {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|(text, _)| text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (_, span) = self.source.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(Some("here".to_owned()), span.clone()))))
    }
}

impl Diagnostic for SceneError {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.problems.first()?.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.problems.first()?.labels()
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        Some(Box::new(self.problems.iter().skip(1).map(|problem| problem as &dyn Diagnostic)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SceneDocument;

    #[test]
    fn a_diagnostic_shows_each_place_in_its_own_text() {
        let text = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\nroll = 3\n[render]\nspp = 'many'\n";
        let error =
            SceneDocument::parse("scene.toml", text).and_then(|document| document.description()).unwrap_err();
        let shown = |diagnostic: &dyn Diagnostic| {
            let label = diagnostic.labels().unwrap().next().unwrap();
            text[label.offset()..label.offset() + label.len()].to_owned()
        };
        assert_eq!(shown(&error), "roll");
        let related: Vec<String> = error.related().unwrap().map(shown).collect();
        assert_eq!(related, ["'many'"]);
        assert!(error.source_code().is_some());
    }
}
