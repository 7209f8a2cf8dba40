//! What Tyndall takes of the machine it runs on: [memory] within a limit, [files] that have an end, and
//! files of its own that are [whole](write_atomically), and [time](seconds_on_cores). Beside it, what messages about files have in common: [sizes](shown_size) and
//! [text](one_line), and damage that libraries [trip over](contained).
//!
//! Whatever is about to take memory in proportion to its input asks [`memory::ask`] first, and whatever reads a file
//! opens it with [`files::open`].

#![forbid(unsafe_code)]

mod atomic_write;
mod contained;
mod control_group;
pub mod files;
mod limit;
pub mod memory;
mod one_line;
mod process;
mod size;

pub use atomic_write::{Unfinished, remove_leftovers, write_atomically};
pub use contained::contained;
pub use one_line::one_line;
pub use process::seconds_on_cores;
pub use size::{parse_size, shown_size};
