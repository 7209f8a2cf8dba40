//! Named values of a file or grid: a u32 count, then for each name, type, u32 length and bytes.
//!
//! They are kept as text. What only OpenVDB's own bookkeeping needs (types that begin with two underscores, as
//! the sizes for delayed loading) is left out. Source: OpenVDB, `MetaMap` and `Metadata`.

use super::cursor::{Cursor, Problem, damaged, quotable};
use crate::GridClass;

pub(super) const CLASS: &str = "class";
pub(super) const NAME: &str = "name";
pub(super) const HALF: &str = "is_saved_as_half_float";
pub(super) const LOCAL_SPACE: &str = "is_local_space";
/// The statistics that a writer adds begin with this.
pub(super) const FILE_PREFIX: &str = "file_";
/// Far more than anyone writes; bounds the memory that a hostile file can take.
const MOST_ENTRIES: u32 = 4096;
/// Bytes of a 4×4 matrix of f64: the longest of numbers.
const LONGEST_NUMBERS: usize = 128;

/// Reads all of them, in file order.
pub(super) fn read(cursor: &mut Cursor) -> Result<Vec<(String, String)>, Problem> {
    let count = cursor.u32("the number of metadata")?;
    if count > MOST_ENTRIES {
        return Err(damaged(format!("{count} metadata are claimed, at most {MOST_ENTRIES} are read")));
    }
    let mut entries = Vec::new();
    for _ in 0..count {
        let name = cursor.string("the name of a metadatum")?;
        let kind = cursor.string("the type of a metadatum")?;
        let len = cursor.u32("the length of a metadatum")? as usize;
        let bytes = cursor.take(len, "a metadatum")?;
        if !kind.starts_with("__") {
            entries.push((name, text(&kind, bytes)));
        }
    }
    Ok(entries)
}

/// What the metadata say the values mean.
pub(super) fn class(entries: &[(String, String)]) -> GridClass {
    let class = entries.iter().find(|(name, _)| name == CLASS).map_or("", |(_, class)| class);
    [GridClass::FogVolume, GridClass::LevelSet, GridClass::Staggered]
        .into_iter()
        .find(|candidate| class_name(*candidate) == class)
        .unwrap_or(GridClass::Unknown)
}

/// The word for a class in a file.
pub(super) fn class_name(class: GridClass) -> &'static str {
    match class {
        GridClass::Unknown => "unknown",
        GridClass::FogVolume => "fog volume",
        GridClass::LevelSet => "level set",
        GridClass::Staggered => "staggered",
    }
}

/// The value as text: the number, `true` or `false`, the string, or `[x, y, …]` of a vector or matrix.
fn text(kind: &str, bytes: &[u8]) -> String {
    let element = match kind {
        "string" => return String::from_utf8_lossy(bytes).into_owned(),
        "bool" => return if bytes.iter().any(|&byte| byte != 0) { "true" } else { "false" }.to_owned(),
        "int64" => "int64",
        "int32" | "vec2i" | "vec3i" | "vec4i" => "int32",
        "float" | "vec2s" | "vec3s" | "vec4s" | "mat4s" => "float",
        "double" | "vec2d" | "vec3d" | "vec4d" | "mat4d" => "double",
        _ => "",
    };
    let element = if bytes.len() <= LONGEST_NUMBERS { element } else { "" };
    let numbers: Vec<String> = match element {
        "int64" => bytes.as_chunks().0.iter().map(|&b| i64::from_le_bytes(b).to_string()).collect(),
        "int32" => bytes.as_chunks().0.iter().map(|&b| i32::from_le_bytes(b).to_string()).collect(),
        "float" => bytes.as_chunks().0.iter().map(|&b| format!("{:?}", f32::from_le_bytes(b))).collect(),
        "double" => bytes.as_chunks().0.iter().map(|&b| format!("{:?}", f64::from_le_bytes(b))).collect(),
        _ => return format!("({}, {} bytes)", quotable(kind), bytes.len()),
    };
    if kind.starts_with("vec") || kind.starts_with("mat") {
        format!("[{}]", numbers.join(", "))
    } else {
        numbers.join(", ")
    }
}
