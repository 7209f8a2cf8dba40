//! What is put in the place of a sound value: everything that a file can say there and that nobody means.

use toml::Value;

use crate::schema::{Node, kind};

/// Numbers that are absurd whatever they measure.
const NUMBERS: [f64; 17] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -1.0,
    -0.0,
    0.0,
    1e-310,
    1e-40,
    1e-30,
    1e-12,
    1e6,
    1e12,
    1e20,
    1e30,
    -1e30,
    1e31,
    1e300,
];

/// Values for the place of `value`.
pub fn bad_values(node: &Node<'_>, value: &Value) -> Vec<Value> {
    let mut bad = match kind(node.schema) {
        "number" => numbers(node),
        "integer" => integers(node),
        "string" => ["", " ", "no such thing", "two\nlines", "../../..", "\u{0}"].map(Value::from).to_vec(),
        "word" => vec!["".into(), "no such word".into()],
        "array" => arrays(value),
        _ => vec![],
    };
    bad.extend(wrong_kinds());
    bad.retain(|bad| bad != value);
    bad
}

fn numbers(node: &Node<'_>) -> Vec<Value> {
    let bound = |key: &str| node.schema.get(key).and_then(serde_json::Value::as_f64);
    let bounds = [bound("minimum"), bound("maximum"), bound("exclusiveMinimum"), bound("exclusiveMaximum")];
    let beside = |bound: f64| [bound, bound.next_down(), bound.next_up(), bound * (1.0 + 1e-7)];
    let mut numbers = NUMBERS.to_vec();
    for number in bounds.into_iter().flatten().flat_map(beside) {
        if !numbers.iter().any(|other| other.to_bits() == number.to_bits()) {
            numbers.push(number);
        }
    }
    numbers.into_iter().map(Value::from).collect()
}

fn integers(node: &Node<'_>) -> Vec<Value> {
    let bound = |key: &str| node.schema.get(key).and_then(serde_json::Value::as_i64);
    let mut integers = vec![0, 1, -1, i64::MAX, i64::MIN, 1 << 32];
    for bound in [bound("minimum"), bound("maximum")].into_iter().flatten() {
        integers.extend([bound, bound - 1, bound.saturating_add(1)]);
    }
    integers.sort_unstable();
    integers.dedup();
    integers.into_iter().map(Value::from).chain([Value::from(1.5), Value::from(f64::NAN)]).collect()
}

/// Shorter and longer ones; of numbers those that are all the same.
fn arrays(value: &Value) -> Vec<Value> {
    let Value::Array(items) = value else { return vec![] };
    let mut bad = vec![Value::Array(vec![])];
    if let Some((last, rest)) = items.split_last() {
        bad.push(rest.to_vec().into());
        bad.push([items.as_slice(), std::slice::from_ref(last)].concat().into());
        bad.push(vec![last.clone(); 300].into());
    }
    if items.iter().all(|item| matches!(item, Value::Float(_) | Value::Integer(_))) {
        let same = |number: f64| Value::Array(vec![number.into(); items.len()]);
        bad.extend([0.0, -0.0, 1.0, -1.0, f64::NAN, 1e-310, 1e-40, 1e-20, 1e20, 1e30, -1e30].map(same));
        bad.push(items.iter().rev().cloned().collect::<Vec<_>>().into());
    }
    bad
}

fn wrong_kinds() -> Vec<Value> {
    let table: toml::Table = [("no_such_key".to_owned(), Value::from(1))].into_iter().collect();
    let date = Value::Datetime("2026-01-02".parse().expect("a date"));
    vec!["text".into(), true.into(), 1.into(), Value::Table(table), vec![vec![Value::from(1)]].into(), date]
}
