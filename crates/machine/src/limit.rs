//! How much memory may be taken in all, and who says so.

use std::fmt;

use crate::process::ResourceLimits;
use crate::{control_group, parse_size};

/// The variable of the environment that limits memory where no option does.
pub(crate) const VARIABLE: &str = "TYNDALL_MAX_MEMORY";

/// Who limits memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitedBy {
    /// The option `--max-memory`.
    Option,
    /// The variable `TYNDALL_MAX_MEMORY`.
    Variable,
    /// The machine, by what it has.
    Machine,
    /// The control group of a container or a job.
    ControlGroup,
    /// `ulimit -v`.
    AddressSpace,
    /// `ulimit -d`.
    Data,
}

impl fmt::Display for LimitedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Option => "--max-memory",
            Self::Variable => VARIABLE,
            Self::Machine => "all that this machine has",
            Self::ControlGroup => "the memory limit of the control group",
            Self::AddressSpace => "ulimit -v, some of it kept for threads",
            Self::Data => "ulimit -d",
        })
    }
}

/// A limit on memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Limit {
    pub bytes: u64,
    pub by: LimitedBy,
}

/// All limits that hold.
#[derive(Debug, Clone, Default)]
pub(crate) struct Limits {
    /// On what is taken for good: what was asked for, or else the least of machine and control group.
    pub memory: Option<Limit>,
    /// On address space, whether it is used or not.
    pub address_space: Option<Limit>,
    /// On writable address space.
    pub data: Option<Limit>,
}

impl Limits {
    /// Those of this process; `asked` is what the user said, with an option before the environment.
    ///
    /// # Errors
    /// If the environment says what is no size.
    pub(crate) fn find(asked: Option<u64>) -> Result<Self, String> {
        let variable = std::env::var_os(VARIABLE).filter(|value| !value.is_empty());
        let memory = match (asked, variable) {
            (Some(bytes), _) => Some(Limit { bytes, by: LimitedBy::Option }),
            (None, Some(text)) => {
                let bytes = parse_size(&text.to_string_lossy())
                    .map_err(|mend| format!("{VARIABLE}={}: {mend}", text.to_string_lossy()))?;
                Some(Limit { bytes, by: LimitedBy::Variable })
            }
            (None, None) => {
                let group =
                    control_group::memory_limit().map(|bytes| Limit { bytes, by: LimitedBy::ControlGroup });
                let machine = physical_memory().map(|bytes| Limit { bytes, by: LimitedBy::Machine });
                group.into_iter().chain(machine).min_by_key(|limit| limit.bytes)
            }
        };
        let ResourceLimits { address_space, data } = ResourceLimits::now();
        Ok(Self {
            memory,
            address_space: address_space.map(|bytes| Limit { bytes, by: LimitedBy::AddressSpace }),
            data: data.map(|bytes| Limit { bytes, by: LimitedBy::Data }),
        })
    }
}

/// Memory of the machine without swap space, bytes.
fn physical_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let rest = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    rest.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}
