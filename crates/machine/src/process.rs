//! What the kernel says of this process in `/proc/self`: memory in use, the limits that `ulimit` sets, and time at work.
//!
//! Source: `proc_pid_status(5)`, `proc_pid_limits(5)`, `proc_pid_stat(5)`. On systems without `/proc` nothing is known.

/// Ticks a second of the times in `/proc`, the same on all Linux systems of today.
const TICKS: f64 = 100.0;

/// Seconds that this process has spent on all cores, to a hundredth of one, which other work on the machine disturbs less than
/// the clock; `None` where the system does not tell.
pub fn seconds_on_cores() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / TICKS)
}

/// Memory of the process, bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Usage {
    /// Address space, whether used or not: what `ulimit -v` limits.
    pub address_space: u64,
    /// Writable address space of its own, whether touched or not: what `ulimit -d` limits.
    pub data: u64,
    /// Pages that are really there.
    pub resident: u64,
}

impl Usage {
    /// That of this process at this time.
    pub(crate) fn now() -> Option<Self> {
        Self::parse(&std::fs::read_to_string("/proc/self/status").ok()?)
    }

    fn parse(status: &str) -> Option<Self> {
        let field = |name: &str| {
            let rest = status.lines().find_map(|line| line.strip_prefix(name))?;
            rest.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
        };
        Some(Self { address_space: field("VmSize:")?, data: field("VmData:")?, resident: field("VmRSS:")? })
    }
}

/// What `ulimit` allows, bytes; nothing where it is unlimited or not known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct ResourceLimits {
    /// `ulimit -v`.
    pub address_space: Option<u64>,
    /// `ulimit -d`.
    pub data: Option<u64>,
}

impl ResourceLimits {
    /// Those of this process.
    pub(crate) fn now() -> Self {
        Self::parse(&std::fs::read_to_string("/proc/self/limits").unwrap_or_default())
    }

    fn parse(limits: &str) -> Self {
        let soft = |name: &str| {
            let rest = limits.lines().find_map(|line| line.strip_prefix(name))?;
            rest.split_whitespace().next()?.parse().ok()
        };
        Self { address_space: soft("Max address space"), data: soft("Max data size") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usage_is_read_in_bytes() {
        let status = "Name:\tx\nVmPeak:\t 9 kB\nVmSize:\t    3760 kB\nVmRSS:\t 20 kB\nVmData:\t     292 kB\n";
        let usage = Usage { address_space: 3760 << 10, data: 292 << 10, resident: 20 << 10 };
        assert_eq!(Usage::parse(status), Some(usage));
        assert_eq!(Usage::parse(""), None);
    }

    #[test]
    fn limits_are_the_soft_ones() {
        let limits = "Limit  Soft Limit  Hard Limit  Units\n\
                      Max data size             unlimited            unlimited            bytes\n\
                      Max address space         1048576              2097152              bytes\n";
        assert_eq!(
            ResourceLimits::parse(limits),
            ResourceLimits { address_space: Some(1 << 20), data: None }
        );
        assert_eq!(ResourceLimits::parse(""), ResourceLimits::default());
    }
}
