//! Memory within a limit: whoever is about to take much of it asks first.
//!
//! A request is granted if it fits beside what the process has taken already, as the system tells (Linux). That counts
//! all of it, also what nobody asked for, and notices by itself what is given back. The limit is that of `--max-memory` or of
//! the environment variable `TYNDALL_MAX_MEMORY`, or else what the machine or the control group (of a container, of a job)
//! has; besides, those of `ulimit -v` and `ulimit -d` hold.
//!
//! Where the system does not tell (other than Linux), there is no limit by default, and one that is asked for holds
//! for each request alone.

use std::sync::OnceLock;

pub use crate::limit::LimitedBy;
use crate::limit::{Limit, Limits};
use crate::process::{ResourceLimits, Usage};
use crate::size::shown_size;

/// Requests below this are granted unasked: they are too many and too small to matter.
pub const SMALL: u64 = 1 << 20;
/// Address space that is left for all that does not ask …
const SPARE_ADDRESS_SPACE: u64 = 24 << 20;
/// … and for the stack of each thread that renders.
const THREAD_ADDRESS_SPACE: u64 = 3 << 20;

/// What limits this process, found once; an environment that cannot be understood refuses whatever is asked for.
static LIMITS: OnceLock<Result<Limits, String>> = OnceLock::new();
/// How many threads render at once, as a rule.
static THREADS: OnceLock<u64> = OnceLock::new();
/// What the process had taken when it was first looked.
static FIRST_USAGE: OnceLock<Option<Usage>> = OnceLock::new();

/// Why there is no memory. Displays as one line, without the name of what it is for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MemoryError {
    /// It would be more than the limit.
    #[error(
        "not enough memory for {what}: they take {}, {} are taken already, and the limit is {} ({by}); {}",
        shown_size(*.bytes), shown_size(*.taken), shown_size(*.limit), mend(*.by)
    )]
    Limit {
        /// What it is for, as a plural.
        what: String,
        /// Bytes that it would take.
        bytes: u64,
        /// Bytes that are taken already.
        taken: u64,
        /// Bytes that may be taken in all.
        limit: u64,
        /// Who says so.
        by: LimitedBy,
    },
    /// The environment says what is no size.
    #[error("{0}")]
    Environment(String),
}

impl From<MemoryError> for std::io::Error {
    fn from(error: MemoryError) -> Self {
        Self::new(std::io::ErrorKind::OutOfMemory, error)
    }
}

fn mend(by: LimitedBy) -> &'static str {
    match by {
        LimitedBy::Option => "raise it, or give something smaller",
        LimitedBy::Variable => "raise it or --max-memory, or give something smaller",
        LimitedBy::Machine => "use a machine with more, or give something smaller",
        LimitedBy::ControlGroup | LimitedBy::AddressSpace | LimitedBy::Data => {
            "raise that, or give something smaller"
        }
    }
}

/// Limits what the process may take in all, before anything asks; `None` leaves it to the environment.
///
/// # Errors
/// If the environment says what is no size.
pub fn set_limit(bytes: Option<u64>) -> Result<(), MemoryError> {
    FIRST_USAGE.get_or_init(Usage::now);
    let limits = LIMITS.get_or_init(|| Limits::find(bytes));
    limits.as_ref().map(|_| ()).map_err(|what| MemoryError::Environment(what.clone()))
}

/// Whether address space is limited (`ulimit -v`): what is reserved then counts as if it were used.
pub fn address_space_is_limited() -> bool {
    ResourceLimits::now().address_space.is_some()
}

/// Asks for `bytes` of memory, before they are taken; `what` they are for is a plural, such as `512 bricks`.
///
/// ```
/// let error = tyndall_machine::memory::ask(u64::MAX, || "all atoms".into());
/// # if cfg!(target_os = "linux") {
/// assert!(error.unwrap_err().to_string().starts_with("not enough memory for all atoms: they take "));
/// # }
/// ```
///
/// # Errors
/// If they would be too many, with what is taken already.
pub fn ask(bytes: u64, what: impl FnOnce() -> String) -> Result<(), MemoryError> {
    if bytes < SMALL {
        return Ok(());
    }
    let first = FIRST_USAGE.get_or_init(Usage::now);
    let limits = LIMITS.get_or_init(|| Limits::find(None));
    let limits = limits.as_ref().map_err(|what| MemoryError::Environment(what.clone()))?;
    match exceeded(bytes, limits, first.unwrap_or_default(), Usage::now().unwrap_or_default()) {
        None => Ok(()),
        Some((taken, Limit { bytes: limit, by })) => {
            Err(MemoryError::Limit { what: what(), bytes, taken, limit, by })
        }
    }
}

/// Asks for `count` things of `bytes` each; more than can be counted are too many as well.
///
/// # Errors
/// As [`ask`].
pub fn ask_for(count: usize, bytes: usize, what: impl FnOnce() -> String) -> Result<(), MemoryError> {
    ask((count as u64).saturating_mul(bytes as u64), what)
}

/// The limit that `bytes` more would pass, and what is taken of it already.
///
/// What was mapped but not touched when the process began (a Python process may have much of that) is not counted; what is
/// mapped later is, as it will be touched.
fn exceeded(bytes: u64, limits: &Limits, first: Usage, now: Usage) -> Option<(u64, Limit)> {
    let grown = now.data.saturating_sub(first.data);
    let taken = now.resident.max(first.resident.saturating_add(grown));
    let threads = THREADS.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from) as u64);
    let spare = SPARE_ADDRESS_SPACE + threads * THREAD_ADDRESS_SPACE;
    let address_space = now.address_space.saturating_add(spare);
    [(taken, limits.memory), (address_space, limits.address_space), (now.data, limits.data)]
        .into_iter()
        .filter_map(|(taken, limit)| Some((taken, limit?)))
        .find(|(taken, limit)| taken.saturating_add(bytes) > limit.bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIRST: Usage = Usage { address_space: 900, data: 500, resident: 100 };

    fn limits(memory: u64) -> Limits {
        Limits { memory: Some(Limit { bytes: memory, by: LimitedBy::Option }), ..Limits::default() }
    }

    #[test]
    fn what_is_mapped_later_counts_whether_it_is_touched_or_not() {
        let now = Usage { address_space: 1300, data: 800, resident: 150 };
        assert_eq!(exceeded(600, &limits(1000), FIRST, now), None);
        assert_eq!(exceeded(601, &limits(1000), FIRST, now).map(|(taken, _)| taken), Some(400));
        let touched = Usage { resident: 450, ..now };
        assert_eq!(exceeded(600, &limits(1000), FIRST, touched).map(|(taken, _)| taken), Some(450));
        let given_back = Usage { data: 500, ..now };
        assert_eq!(exceeded(800, &limits(1000), FIRST, given_back), None);
    }

    #[test]
    fn address_space_has_a_limit_of_its_own() {
        let by = LimitedBy::AddressSpace;
        let address_space = Some(Limit { bytes: 1 << 40, by });
        let limits = Limits { address_space, ..limits(u64::MAX) };
        assert_eq!(exceeded(1 << 39, &limits, FIRST, FIRST), None);
        let beyond = (1 << 40) - SPARE_ADDRESS_SPACE;
        assert_eq!(exceeded(beyond, &limits, FIRST, FIRST).map(|(_, limit)| limit.by), Some(by));
        assert!(exceeded(u64::MAX, &limits, FIRST, FIRST).is_some());
    }

    #[test]
    fn a_refusal_tells_the_sum_and_the_mend() {
        let error = MemoryError::Limit {
            what: "1024 x 1024 x 1024 voxels of 4 bytes".into(),
            bytes: 1 << 32,
            taken: 3_100_000_000,
            limit: 6_000_000_000,
            by: LimitedBy::Option,
        };
        let expected = "not enough memory for 1024 x 1024 x 1024 voxels of 4 bytes: they take 4.3 GB, 3.1 GB are taken \
                        already, and the limit is 6.0 GB (--max-memory); raise it, or give something smaller";
        assert_eq!(error.to_string(), expected);
    }
}
