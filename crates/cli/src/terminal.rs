//! What the command says: answers on standard output, notes and errors on standard error.
//!
//! Nobody need listen. A reader that has gone (`tyndall inspect cloud.vdb | head -1`) is no error, and a closed
//! standard error never costs a picture; `println!` and `eprintln!` would panic on both.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use miette::{Diagnostic, Report, miette};
use tyndall_scene::SceneError;
use tyndall_session::SessionError;

/// Writes an answer to standard output.
pub fn answer(text: impl Display) -> miette::Result<()> {
    let mut out = std::io::stdout().lock();
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(miette!("the standard output cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error.
pub fn tell(line: impl Display) {
    // There is nowhere else to complain.
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Writes why the command failed: one line for each problem, followed by its place in the scene file.
pub fn tell_error(report: &Report) {
    match (report.downcast_ref::<SceneError>(), report.downcast_ref::<SessionError>()) {
        (Some(error), _) | (_, Some(SessionError::Scene(error))) => tell_problems(error),
        (_, Some(SessionError::Unsupported(lines))) => lines.iter().for_each(|line| tell(error_line(line))),
        _ => tell(error_line(report)),
    }
}

fn tell_problems(error: &SceneError) {
    for problem in error.problems() {
        tell(error_line(problem));
        if let (Some((line, _)), Some(snippet)) = (problem.position, snippet(problem)) {
            let margin = line.to_string();
            let [text, marker] = snippet;
            tell(format!("  {margin} | {text}\n  {:width$} | {marker}", "", width = margin.len()));
        }
    }
}

fn error_line(error: impl Display) -> String {
    let text = error.to_string();
    format!("error: {}", text.split_whitespace().collect::<Vec<_>>().join(" "))
}

/// Longer lines are not written by people, and do not help them.
const LONGEST_LINE: usize = 160;

/// The line of a problem, and a line that marks its place in it.
fn snippet(problem: &dyn Diagnostic) -> Option<[String; 2]> {
    let label = problem.labels()?.next()?;
    // With a line of context on either side, as the line itself is only given from the label on without.
    let span = problem.source_code()?.read_span(label.inner(), 1, 1).ok()?;
    let text = std::str::from_utf8(span.data()).ok()?;
    let at = label.offset().checked_sub(span.span().offset())?;
    let line_start = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let line = text[line_start..].lines().next()?;
    let before = line.get(..at - line_start)?;
    if line.trim().is_empty() || line.chars().count() > LONGEST_LINE {
        return None;
    }
    let marked = line[before.len()..].char_indices().filter(|(at, _)| *at < label.len());
    let length = marked.count().max(1);
    let indent: String = before.chars().map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
    Some([line.to_owned(), format!("{indent}{}", "^".repeat(length))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_scene::SceneDocument;

    #[test]
    fn a_problem_is_one_line_whatever_its_message_holds() {
        assert_eq!(error_line("a.vdb: two\n  lines"), "error: a.vdb: two lines");
    }

    #[test]
    fn the_marker_stands_under_the_place_also_behind_wide_letters() {
        let text = "camera = { position = [0, 0, 5], target = [0, 0, 0], \"röll\" = 3, roll = 3 }\n";
        let document = SceneDocument::parse("scene.toml", text);
        let error = document.and_then(|document| document.description()).unwrap_err();
        let [line, marker] = snippet(&error.problems()[1]).unwrap();
        assert_eq!(format!("{line}\n"), text);
        assert_eq!(marker, format!("{}^^^^", " ".repeat(text.chars().count() - 11)));
    }
}
