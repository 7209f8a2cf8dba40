//! From what a user gives to a finished picture: the one loop that every face of Tyndall runs.
//!
//! [`Input`] is whatever can be rendered, opened as a description. A [`Job`] is that scene built, with an empty picture; it
//! renders pass after pass towards a [`Goal`], and tells after each of them. [`Output`]s are the files that a picture goes
//! to, a [`Checkpoint`] the one that an interrupted render goes on from.
//!
//! ```
//! use tyndall_session::{Goal, Input, Job, JobOptions};
//! use tyndall_transport::{Control, Outcome};
//!
//! let text = r#"
//!     camera = { position = [0, 0, 5], target = [0, 0, 0] }
//!     film = { resolution = [8, 8] }
//!     volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 1 }]
//!     light = [{ type = "constant", radiance = 1 }]
//! "#;
//! let input = Input::from_text("ball.toml", text, "", &[])?;
//! let mut job = Job::new(&input, &JobOptions::default())?;
//! let plan = Goal { spp: Some(4), ..Goal::default() }.plan(input.description().render.spp);
//! let outcome = job.run(&plan, &Control::default(), |_| {})?;
//! assert_eq!(outcome, Outcome::Complete);
//! assert_eq!(job.pictures()[0].film.complete().count(), 4);
//! # Ok::<(), tyndall_session::SessionError>(())
//! ```
//!
//! It knows no terminal: no options of a command line, no signals, no printing.

#![forbid(unsafe_code)]

mod bare_volume;
mod checkpoint;
mod clock;
mod error;
mod foreign;
mod frames;
mod goal;
mod input;
mod job;
mod output;
mod picture;
mod readings;
mod readings_report;
mod volume_file;
mod writable;

pub use checkpoint::Checkpoint;
pub use error::SessionError;
pub use foreign::{ImportOptions, WrittenFiles, is_foreign};
pub use frames::{Frames, at_frame, file_at_frame, holds_frame};
pub use goal::{Goal, Plan};
pub use input::{Input, InputOptions, ReadyScene};
pub use job::{Job, JobOptions, is_rendered};
pub use output::{Output, write_all};
pub use picture::colours;
pub use readings::{Reading, read_meters};
pub use readings_report::readings_report;
pub use volume_file::{RawVolume, check_input, read_volume};
pub use writable::{check_no_input, check_not_same, check_writable};
