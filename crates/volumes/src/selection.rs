//! Which grids of a file are wanted.

/// Which grids to read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum GridSelection {
    /// Every grid that can be read.
    All,
    /// The grids with these names. A name that several grids have selects all of them, `name[1]` the one that
    /// OpenVDB numbers 1.
    Names(Vec<String>),
}
