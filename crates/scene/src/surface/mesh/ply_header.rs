//! The header of a .ply file: text lines up to `end_header` that say what elements follow, and of which properties.
//!
//! Format: Greg Turk, "The PLY Polygon File Format" (1994).

/// How the numbers of the body are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Text, separated by white space.
    Ascii,
    /// Binary, least byte first.
    LittleEndian,
    /// Binary, greatest byte first.
    BigEndian,
}

/// Type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Number {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of a binary one.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// One number, or a list of numbers, of an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    /// What it is called.
    pub name: String,
    /// Type of its number or numbers.
    pub number: Number,
    /// Type of the length, if it is a list.
    pub length: Option<Number>,
}

/// A table of the body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    /// What it is called: `vertex`, `face`.
    pub name: String,
    /// Number of rows.
    pub count: usize,
    /// The columns.
    pub properties: Vec<Property>,
}

impl Element {
    /// Number of the column of one of these names that is, or is not, of lists.
    pub fn find(&self, names: &[&str], is_list: bool) -> Option<usize> {
        self.properties.iter().position(|property| {
            property.length.is_some() == is_list && names.contains(&property.name.as_str())
        })
    }

    /// The least number of bytes that a row takes.
    pub fn least_size(&self, encoding: Encoding) -> usize {
        let of = |property: &Property| match encoding {
            // A digit, and what separates it from the next.
            Encoding::Ascii => 2,
            _ => property.length.unwrap_or(property.number).size(),
        };
        self.properties.iter().map(of).sum()
    }
}

/// What a file says of its body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    /// How numbers are written.
    pub encoding: Encoding,
    /// The tables, in order.
    pub elements: Vec<Element>,
    /// Bytes of the header.
    pub length: usize,
}

/// More text than this before `end_header` is something else.
const GREATEST_HEADER: usize = 1 << 20;

impl Header {
    /// Reads the header at the start of a file.
    ///
    /// # Errors
    /// One line that names the line of the header.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut lines = Lines { bytes: &bytes[..bytes.len().min(GREATEST_HEADER)], at: 0, number: 0 };
        if lines.next() != Some("ply") {
            return Err("is not a PLY file: its first line is not `ply`".into());
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        while let Some(line) = lines.next() {
            let number = lines.number;
            let wrong = |what: &str| format!("line {number} of the header {what}: `{}`", line.trim());
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words.as_slice() {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", word, _version] => {
                    encoding = Some(match *word {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::LittleEndian,
                        "binary_big_endian" => Encoding::BigEndian,
                        _ => return Err(wrong("names an unknown format")),
                    });
                }
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| wrong("has no number of elements"))?;
                    elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
                }
                ["property", types @ .., name] => {
                    let property = match types {
                        ["list", length, number] => {
                            Number::parse(length).zip(Number::parse(number)).map(|(length, number)| {
                                Property { name: (*name).to_owned(), number, length: Some(length) }
                            })
                        }
                        [number] => Number::parse(number).map(|number| Property {
                            name: (*name).to_owned(),
                            number,
                            length: None,
                        }),
                        _ => None,
                    };
                    let property = property.ok_or_else(|| wrong("has a property of an unknown type"))?;
                    let element = elements.last_mut().ok_or_else(|| wrong("belongs to no element"))?;
                    element.properties.push(property);
                }
                ["end_header"] => {
                    let encoding = encoding.ok_or("the header lacks the line `format`")?;
                    return Ok(Self { encoding, elements, length: lines.at });
                }
                _ => return Err(wrong("is not understood")),
            }
        }
        Err("is cut off, or no PLY file: the header has no line `end_header`".into())
    }
}

/// The lines of a text, which end with a line feed, a carriage return, or both.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'))?;
        let is_pair = rest[length..].starts_with(b"\r\n");
        self.at += length + if is_pair { 2 } else { 1 };
        self.number += 1;
        // Comments may be in any encoding; what counts is ASCII.
        Some(std::str::from_utf8(&rest[..length]).unwrap_or("comment"))
    }
}
