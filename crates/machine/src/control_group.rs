//! The memory limit of the control group (Linux) that this process runs in, such as that of a container or of a job.
//!
//! `/proc/self/cgroup` tells the group, as `0::/path` in version 2 and as `N:memory:/path` in version 1;
//! `/proc/self/mountinfo` tells where the tree of groups is mounted, and from which group down. A group has no more than the
//! groups that it is nested in: the least limit of all of them holds. Source: `cgroups(7)`, `proc_pid_mountinfo(5)`.

use std::path::{Path, PathBuf};

/// The least limit in bytes, if there is any.
pub(crate) fn memory_limit() -> Option<u64> {
    least_limit(|path| std::fs::read_to_string(path).ok())
}

/// The same with the files that `read` gives.
fn least_limit(read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
    let groups = read(Path::new("/proc/self/cgroup"))?;
    let mounts = read(Path::new("/proc/self/mountinfo"))?;
    // Version 1 writes "unlimited" as the greatest number of whole pages.
    mounts
        .lines()
        .filter_map(Mount::parse)
        .flat_map(|mount| mount.limit_files(&groups))
        .filter_map(|file| read(&file)?.trim().parse().ok())
        .filter(|&bytes: &u64| bytes < i64::MAX as u64 / 2)
        .min()
}

/// A version of control groups.
#[derive(Debug, Clone, Copy)]
enum Version {
    One,
    Two,
}

impl Version {
    /// The group that a line of `/proc/self/cgroup` tells, if it is about memory in this version.
    fn group(self, line: &str) -> Option<&str> {
        let mut parts = line.splitn(3, ':');
        let (number, controllers, group) = (parts.next()?, parts.next()?, parts.next()?);
        let is_it = match self {
            Self::One => controllers.split(',').any(|controller| controller == "memory"),
            Self::Two => number == "0" && controllers.is_empty(),
        };
        is_it.then_some(group)
    }

    fn limit_file(self) -> &'static str {
        match self {
            Self::One => "memory.limit_in_bytes",
            Self::Two => "memory.max",
        }
    }
}

/// A tree of groups that is mounted.
struct Mount {
    version: Version,
    /// The group that is mounted.
    root: PathBuf,
    /// Where.
    point: PathBuf,
}

impl Mount {
    /// Reads `id parent major:minor root point options … - type source options`.
    fn parse(line: &str) -> Option<Self> {
        let (mount, system) = line.split_once(" - ")?;
        let mut system = system.split(' ');
        let version = match system.next()? {
            "cgroup2" => Version::Two,
            "cgroup" if system.nth(1)?.split(',').any(|option| option == "memory") => Version::One,
            _ => return None,
        };
        let mut fields = mount.split(' ').skip(3);
        Some(Self { version, root: fields.next()?.into(), point: fields.next()?.into() })
    }

    /// The limits of the process's group, told by the lines `groups`, and of those around it.
    fn limit_files(&self, groups: &str) -> Vec<PathBuf> {
        let group = groups.lines().find_map(|line| self.version.group(line)).unwrap_or("/");
        // In a namespace of its own the group may lie outside of what is mounted; then that is all there is to see.
        let inner = Path::new(group).strip_prefix(&self.root).unwrap_or(Path::new(""));
        inner.ancestors().map(|level| self.point.join(level).join(self.version.limit_file())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The limit on a machine with these files.
    fn limit(files: &[(&str, &str)]) -> Option<u64> {
        least_limit(|path| {
            let found = files.iter().find(|(name, _)| Path::new(name) == path);
            found.map(|(_, content)| (*content).to_owned())
        })
    }

    #[test]
    fn the_least_of_nested_groups_of_version_2_holds() {
        let files = |outer, inner| {
            limit(&[
                ("/proc/self/cgroup", "0::/user.slice/job\n"),
                ("/proc/self/mountinfo", "31 23 0:28 / /sys/fs/cgroup rw shared:4 - cgroup2 cgroup2 rw\n"),
                ("/sys/fs/cgroup/user.slice/memory.max", outer),
                ("/sys/fs/cgroup/user.slice/job/memory.max", inner),
            ])
        };
        assert_eq!(files("4096000\n", "8192000\n"), Some(4_096_000));
        assert_eq!(files("max\n", "8192000\n"), Some(8_192_000));
        assert_eq!(files("max\n", "max\n"), None);
    }

    #[test]
    fn a_container_of_version_1_sees_its_own_group_as_the_root() {
        let files = |mounted: &str, bytes| {
            let mounts = format!("35 31 0:32 {mounted} /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n");
            limit(&[
                ("/proc/self/cgroup", "5:cpu:/a\n4:cpuset,memory:/docker/abc\n0::/\n"),
                ("/proc/self/mountinfo", &mounts),
                ("/sys/fs/cgroup/memory/memory.limit_in_bytes", bytes),
                ("/sys/fs/cgroup/memory/docker/abc/memory.limit_in_bytes", "1000000"),
            ])
        };
        assert_eq!(files("/docker/abc", "2000000\n"), Some(2_000_000));
        assert_eq!(files("/elsewhere", "2000000\n"), Some(2_000_000));
        assert_eq!(files("/", "9223372036854771712\n"), Some(1_000_000));
    }

    #[test]
    fn without_groups_there_is_no_limit() {
        assert_eq!(limit(&[]), None);
        assert_eq!(limit(&[("/proc/self/cgroup", "nonsense"), ("/proc/self/mountinfo", "- cgroup2")]), None);
    }
}
