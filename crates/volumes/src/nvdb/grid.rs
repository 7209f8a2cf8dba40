//! One NanoVDB grid: the 672-byte head of a grid's buffer, then its tree.
//!
//! The head, by byte offset: magic 0, checksum 8, version 16, flags 20, index and count 24, size 32, name 40
//! (256 bytes), map 296, world box 560, voxel size 608, class 632, type 636, blind data 640 and 648. The map holds,
//! after its single-precision half of 88 bytes, a row-major 3×3 matrix (72 bytes), its inverse and the translation in
//! double precision. World = matrix · index + translation.

use glam::{DAffine3, DMat3, DVec3};

use crate::fault::Fault;
use crate::little_endian::{bytes_at, f64_at, i64_at, u32_at, u64_at};
use crate::{Grid, GridClass};

use super::layout::{GRID_HEAD, ValueType};
use super::values::read_values;
use super::{MAGIC_0, MAGIC_1, Version};

/// Flag: the name is longer than the head has room for and stands in the blind data.
const LONG_NAME: u32 = 1;
/// Class of the blind data that holds the name.
const GRID_NAME: u32 = 3;
/// Bytes of the description of one piece of blind data.
const BLIND_HEAD: usize = 288;

/// The grid that fills `buffer`; `name` as the file's own table has it, if there is one.
pub(super) fn read_grid(buffer: &[u8], name: Option<&str>, codec: &str) -> Result<Grid, Fault> {
    let head = bytes_at(buffer, 0, GRID_HEAD, "the head of the grid")?;
    let magic = u64_at(head, 0);
    if magic != MAGIC_0 && magic != MAGIC_1 {
        return Err(Fault::damaged("corrupt: a grid does not begin with a NanoVDB magic number"));
    }
    let version = Version(u32_at(head, 16));
    version.check()?;
    let type_number = u32_at(head, 636);
    let value_type = ValueType::from_number(type_number)?;
    Ok(Grid {
        name: match name {
            Some(name) => name.to_owned(),
            None => own_name(buffer, head)?,
        },
        class: match u32_at(head, 632) {
            1 => GridClass::LevelSet,
            2 => GridClass::FogVolume,
            3 => GridClass::Staggered,
            _ => GridClass::Unknown,
        },
        index_to_world: index_to_world(head)?,
        saved_as_half: false,
        codec: codec.to_owned(),
        metadata: vec![
            ("nanovdb_version".to_owned(), version.to_string()),
            ("nanovdb_type".to_owned(), format!("{value_type:?}")),
        ],
        values: read_values(buffer, value_type)?,
    })
}

/// The name in the grid's head, or in its blind data when it is too long for the head.
pub(super) fn own_name(buffer: &[u8], head: &[u8]) -> Result<String, Fault> {
    if u32_at(head, 20) & LONG_NAME != 0 {
        let first = usize::try_from(i64_at(head, 640)).unwrap_or(usize::MAX);
        for n in 0..u32_at(head, 648) as usize {
            let at = n.saturating_mul(BLIND_HEAD).saturating_add(first);
            let blind = bytes_at(buffer, at, BLIND_HEAD, "the blind data")?;
            if u32_at(blind, 24) == GRID_NAME {
                // Relative to its own description, in spite of what early headers say.
                let text = at.checked_add_signed(i64_at(blind, 0) as isize).unwrap_or(usize::MAX);
                let len = usize::try_from(u64_at(blind, 8)).unwrap_or(usize::MAX);
                return Ok(text_until_nul(bytes_at(buffer, text, len, "the name of the grid")?));
            }
        }
    }
    Ok(text_until_nul(&head[40..296]))
}

/// The text before the first zero byte.
pub(super) fn text_until_nul(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}

fn index_to_world(head: &[u8]) -> Result<DAffine3, Fault> {
    let matrix: [f64; 9] = std::array::from_fn(|n| f64_at(head, 384 + 8 * n));
    let translation = DVec3::from_array(std::array::from_fn(|n| f64_at(head, 528 + 8 * n)));
    let map = DAffine3::from_mat3_translation(DMat3::from_cols_array(&matrix).transpose(), translation);
    match map.is_finite() && map.matrix3.determinant() != 0.0 {
        true => Ok(map),
        false => Err(Fault::damaged("corrupt: the map from index to world space is singular or not finite")),
    }
}
