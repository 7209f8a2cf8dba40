//! The `tyndall` command.
fn main() {}
