//! A description as the scene file a person would have written: tables at the top, everything below in one
//! line.

use std::fmt::Write as _;

use toml::Value;

use crate::SceneDescription;

impl SceneDescription {
    /// The scene as a TOML file that reads back identically.
    pub fn to_toml(&self) -> String {
        self.to_toml_with_notes(&[])
    }

    /// The scene as a TOML file with comments: each note stands above the key whose path it names, such as
    /// `["volume", "0", "mu_t"]` or `["camera"]`.
    pub fn to_toml_with_notes(&self, notes: &[(Vec<String>, String)]) -> String {
        let root = match Value::try_from(self) {
            Ok(Value::Table(root)) => root,
            // The description has nothing that TOML lacks: no maps with odd keys, no integers past 63 bits.
            other => unreachable!("a scene description is a TOML table, not {other:?}"),
        };
        let mut printer = Printer { notes, text: String::new() };
        for (key, value) in root.iter().filter(|(_, value)| !is_section(value)) {
            printer.entry(&[key], value);
        }
        for (key, value) in &root {
            match value {
                Value::Table(table) => printer.section(&format!("[{key}]"), &[key], table),
                Value::Array(items) => {
                    for (index, item) in items.iter().enumerate() {
                        if let Value::Table(table) = item {
                            printer.section(&format!("[[{key}]]"), &[key, &index.to_string()], table);
                        }
                    }
                }
                _ => {}
            }
        }
        printer.text
    }
}

fn is_section(value: &Value) -> bool {
    match value {
        Value::Table(_) => true,
        Value::Array(items) => items.iter().any(Value::is_table),
        _ => false,
    }
}

struct Printer<'a> {
    notes: &'a [(Vec<String>, String)],
    text: String,
}

impl Printer<'_> {
    fn section(&mut self, header: &str, path: &[&str], table: &toml::Table) {
        if !self.text.is_empty() {
            self.text.push('\n');
        }
        self.note(path);
        self.text += header;
        self.text.push('\n');
        for (key, value) in table {
            self.entry(&[path, &[key]].concat(), value);
        }
    }

    fn entry(&mut self, path: &[&str], value: &Value) {
        self.note(path);
        let Some(key) = path.last() else { return };
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{key} = {}", inline(value));
    }

    fn note(&mut self, path: &[&str]) {
        for (_, note) in self.notes.iter().filter(|(noted, _)| noted.iter().eq(path)) {
            for line in note.lines() {
                let _ = writeln!(self.text, "# {line}");
            }
        }
    }
}

/// A value in one line.
fn inline(value: &Value) -> String {
    match value {
        Value::Float(number) => float(*number),
        Value::Array(items) => format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", ")),
        Value::Table(table) => {
            let entries: Vec<String> =
                table.iter().map(|(key, value)| format!("{key} = {}", inline(value))).collect();
            format!("{{ {} }}", entries.join(", "))
        }
        other => other.to_string(),
    }
}

/// The shortest digits that read back as the same number; whole numbers without `.0`, as people write them.
fn float(number: f64) -> String {
    let is_whole =
        number.fract() == 0.0 && number.abs() < 1e15 && !(number == 0.0 && number.is_sign_negative());
    if is_whole { format!("{number}") } else { format!("{number:?}") }
}
