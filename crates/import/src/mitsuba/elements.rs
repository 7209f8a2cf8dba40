//! Elements that are values: `<float>`, `<rgb>`, `<spectrum>`, `<transform>` and so on.

use roxmltree::Node;

pub(super) use super::object::Value;
use super::text::{excerpt, number, numbers, spectrum, triple};
use super::transform::Transform;

/// What an element says.
pub(super) enum Read {
    Value(Value),
    /// A spectrum that stands in a file of this name.
    SpectrumFile(String),
    /// No element of this name is known.
    Unknown,
}

/// Reads an element; `attribute` gives attributes with parameters put in. Or the element that is wrong, and what is.
pub(super) fn value<'a, 'input>(
    node: Node<'a, 'input>,
    attribute: &mut impl FnMut(Node, &str) -> Option<String>,
) -> Result<Read, (Node<'a, 'input>, String)> {
    let tag = node.tag_name().name();
    if tag == "transform" {
        let mut transform = Transform::default();
        for child in node.children().filter(Node::is_element) {
            let names = ["value", "x", "y", "z", "angle", "origin", "target", "up"];
            let values = names.map(|name| attribute(child, name));
            let look_up =
                |name: &str| names.iter().position(|known| *known == name).and_then(|at| values[at].clone());
            transform = transform.then(child, look_up).map_err(|message| (child, message))?;
        }
        return Ok(Read::Value(Value::Transform(transform)));
    }
    let fault = |message: String| (node, message);
    let missing = || (node, format!("<{tag}> has no `value`: add it"));
    let given = attribute(node, "value");
    let value = match tag {
        "float" => Value::Float(number(&given.ok_or_else(missing)?).map_err(fault)?),
        "integer" => {
            let text = given.ok_or_else(missing)?;
            let parsed = text.trim().parse().map(Value::Integer);
            parsed.map_err(|_| fault(format!("`{}` is no integer", excerpt(&text))))?
        }
        "boolean" => {
            let text = given.ok_or_else(missing)?;
            match text.trim().to_ascii_lowercase().as_str() {
                "true" => Value::Boolean(true),
                "false" => Value::Boolean(false),
                _ => return Err(fault(format!("`{}` is neither true nor false", excerpt(&text)))),
            }
        }
        "string" => Value::Text(given.ok_or_else(missing)?),
        "vector" | "point" => match given {
            Some(text) => Value::Vector(triple(&text).map_err(fault)?),
            None => {
                let mut coordinate = |name: &str| {
                    let text = attribute(node, name);
                    let text = text.ok_or_else(|| fault(format!("<{tag}> has no `{name}`: add it")))?;
                    number(&text).map_err(fault)
                };
                Value::Vector([coordinate("x")?, coordinate("y")?, coordinate("z")?])
            }
        },
        "rgb" | "srgb" => Value::Rgb(triple(&given.ok_or_else(missing)?).map_err(fault)?),
        "spectrum" => match (given, attribute(node, "filename")) {
            (Some(text), None) => match numbers(&text).as_deref() {
                // In Mitsuba 0.x, of an RGB build.
                Ok([r, g, b]) => Value::Rgb([*r, *g, *b]),
                _ => spectrum(&text).map_err(fault)?,
            },
            (None, Some(file)) => return Ok(Read::SpectrumFile(file)),
            _ => return Err(fault("give <spectrum> either `value` or `filename`".into())),
        },
        "blackbody" => {
            return Err(fault(
                "write <spectrum type=\"blackbody\"> with a <float name=\"temperature\">".into(),
            ));
        }
        _ => return Ok(Read::Unknown),
    };
    Ok(Read::Value(value))
}

/// The name in Mitsuba 3 of a property of Mitsuba 0.x: `to_world` for `toWorld`.
pub(super) fn new_name(old: &str) -> String {
    let mut name = String::new();
    let mut before = ' ';
    for c in old.chars() {
        if c.is_ascii_uppercase() && before.is_ascii_lowercase() {
            name.push('_');
        }
        name.push(if before.is_ascii_alphabetic() { c.to_ascii_lowercase() } else { c });
        before = c;
    }
    name
}
