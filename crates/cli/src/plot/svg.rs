//! An SVG 1.1 document that grows shape by shape. Places are in pixels from the upper left corner.

use std::fmt::Write as _;

/// A sheet to draw on.
pub struct Svg {
    size: [f64; 2],
    text: String,
}

/// Which end of a text stands at its place.
#[derive(Clone, Copy)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// Looks of the shapes, by class; the rest of a chart's code says what things are, not how they look.
const STYLE: &str = "\
text{font:13px system-ui,sans-serif;fill:#222}.small{font-size:11px;fill:#555}.tiny{font-size:8px;fill:#555}.title{font-size:15px;font-weight:600}\
.frame{fill:none;stroke:#444}.grid{fill:none;stroke:#ddd}.tick{stroke:#444}\
.curve{fill:none;stroke-width:1.7;stroke-linejoin:round}";

impl Svg {
    /// A white sheet of this size in pixels.
    pub fn new(width: f64, height: f64) -> Svg {
        Svg { size: [width, height], text: String::new() }
    }

    /// Makes the sheet as high as this.
    pub fn set_height(&mut self, height: f64) {
        self.size[1] = height;
    }

    fn push(&mut self, shape: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(shape);
    }

    /// A straight line.
    pub fn line(&mut self, class: &str, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
        self.push(format_args!("<path class=\"{class}\" d=\"M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}\"/>\n"));
    }

    /// A rectangle between two corners.
    pub fn rectangle(&mut self, class: &str, [left, top]: [f64; 2], [right, bottom]: [f64; 2]) {
        let (width, height) = (right - left, bottom - top);
        self.push(format_args!(
            "<rect class=\"{class}\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/>\n"
        ));
    }

    /// A circle.
    pub fn circle(&mut self, class: &str, [x, y]: [f64; 2], radius: f64) {
        self.push(format_args!(
            "<circle class=\"{class}\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\"/>\n"
        ));
    }

    /// A rectangle filled with a colour.
    pub fn bar(&mut self, colour: &str, [left, top]: [f64; 2], [right, bottom]: [f64; 2]) {
        let (width, height) = (right - left, bottom - top);
        self.push(format_args!(
            "<rect fill=\"{colour}\" x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/>\n"
        ));
    }

    /// A dot of a colour; with a white middle if it is not `filled`.
    pub fn dot(&mut self, colour: &str, filled: bool, [x, y]: [f64; 2], radius: f64) {
        let fill = if filled { colour } else { "#fff" };
        self.push(format_args!(
            "<circle fill=\"{fill}\" stroke=\"{colour}\" cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\"/>\n"
        ));
    }

    /// A curve through points, with a gap at each `None`.
    pub fn curve(&mut self, colour: &str, points: impl IntoIterator<Item = Option<[f64; 2]>>) {
        self.styled_curve(colour, "", points);
    }

    /// The same with more attributes of SVG, such as `stroke-dasharray="2 3"`.
    pub fn styled_curve(
        &mut self,
        colour: &str,
        attributes: &str,
        points: impl IntoIterator<Item = Option<[f64; 2]>>,
    ) {
        let mut path = String::new();
        let mut pen = 'M';
        for point in points {
            match point {
                Some([x, y]) => {
                    let _ = write!(path, "{pen}{x:.2} {y:.2}");
                    pen = 'L';
                }
                None => pen = 'M',
            }
        }
        let space = if attributes.is_empty() { "" } else { " " };
        self.push(format_args!(
            "<path class=\"curve\" stroke=\"{colour}\"{space}{attributes} d=\"{path}\"/>\n"
        ));
    }

    /// A line of text, with the exponents of powers of ten raised: `10^-3`.
    pub fn text(&mut self, class: &str, anchor: Anchor, [x, y]: [f64; 2], text: &str) {
        self.turned_text(class, anchor, [x, y], 0.0, text);
    }

    /// The same, turned by degrees about its place.
    pub fn turned_text(&mut self, class: &str, anchor: Anchor, [x, y]: [f64; 2], degrees: f64, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let turn = if degrees == 0.0 {
            String::new()
        } else {
            format!(" transform=\"rotate({degrees} {x:.2} {y:.2})\"")
        };
        let content = marked_up(text);
        self.push(format_args!(
            "<text class=\"{class}\" text-anchor=\"{anchor}\" x=\"{x:.2}\" y=\"{y:.2}\"{turn}>{content}</text>\n"
        ));
    }

    /// The document.
    pub fn finish(self) -> String {
        let [width, height] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\">\n<style>{STYLE}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
             {}</svg>\n",
            self.text
        )
    }
}

/// The text with what means something in XML or HTML escaped.
pub fn escaped(text: &str) -> String {
    let mut content = String::new();
    escape(&mut content, text);
    content
}

/// Escapes what means something in XML, drops what XML cannot hold, and raises exponents.
fn marked_up(text: &str) -> String {
    let mut content = String::new();
    let mut parts = text.split("10^");
    escape(&mut content, parts.next().unwrap_or_default());
    for part in parts {
        let end = part.find(|c: char| !c.is_ascii_digit() && c != '-').unwrap_or(part.len());
        content.push_str("10<tspan dy=\"-5\" font-size=\"80%\">");
        escape(&mut content, &part[..end]);
        content.push_str("</tspan>");
        if end < part.len() {
            content.push_str("<tspan dy=\"5\">");
            escape(&mut content, &part[end..]);
            content.push_str("</tspan>");
        }
    }
    content
}

fn escape(content: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '<' => content.push_str("&lt;"),
            '>' => content.push_str("&gt;"),
            '&' => content.push_str("&amp;"),
            '"' => content.push_str("&quot;"),
            c if c.is_control() => content.push(' '),
            c => content.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_exponents_are_raised() {
        let mut svg = Svg::new(10.0, 10.0);
        svg.text("small", Anchor::Start, [0.0, 0.0], "a<b>&\"\n 10^-3 x");
        let text = svg.finish();
        assert!(text.contains("a&lt;b&gt;&amp;&quot;  10<tspan"), "{text}");
        assert!(text.contains(">-3</tspan><tspan dy=\"5\"> x</tspan></text>"), "{text}");
    }

    #[test]
    fn a_curve_has_gaps_where_there_is_no_point() {
        let mut svg = Svg::new(10.0, 10.0);
        svg.curve("#000", [Some([0.0, 1.0]), Some([1.0, 1.0]), None, Some([2.0, 0.5])]);
        assert!(svg.finish().contains("d=\"M0.00 1.00L1.00 1.00M2.00 0.50\""));
    }
}
