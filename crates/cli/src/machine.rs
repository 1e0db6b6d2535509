//! The memory of the machine, which is the default of `--max-memory`.

use std::path::Path;

/// Bytes that the process may have: of the machine's memory what its control group leaves it.
/// `None` where that is not told.
pub(crate) fn memory() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    memory_by(&read)
}

/// [`memory`] where `read` gives the content of a file.
fn memory_by(read: &dyn Fn(&str) -> Option<String>) -> Option<u64> {
    let physical = read("/proc/meminfo").as_deref().and_then(physical);
    let groups = read("/proc/self/cgroup").unwrap_or_default();
    let limits =
        groups.lines().flat_map(group_files).filter_map(|file| read(&file)?.trim().parse().ok());
    limits.chain(physical).min()
}

/// `MemTotal` in bytes.
fn physical(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The files that may limit the memory of a control group, `NUMBER:CONTROLLERS:PATH`: its own, and
/// those of the groups round it. Version 2 has no controllers in that line.
fn group_files(line: &str) -> Vec<String> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { return Vec::new() };
    let (root, file) = match controllers {
        "" => ("/sys/fs/cgroup", "memory.max"),
        _ if controllers.split(',').any(|name| name == "memory") => {
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return Vec::new(),
    };
    let groups = Path::new(path)
        .ancestors()
        .map(|group| group.to_string_lossy().trim_matches('/').to_owned());
    groups
        .map(|group| {
            if group.is_empty() {
                format!("{root}/{file}")
            } else {
                format!("{root}/{group}/{file}")
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The memory of a machine with these files.
    fn of(files: &[(&str, &str)]) -> Option<u64> {
        memory_by(&|path| {
            files.iter().find(|(name, _)| *name == path).map(|(_, text)| (*text).to_owned())
        })
    }

    const TOTAL: (&str, &str) = ("/proc/meminfo", "MemTotal:        4096 kB\nMemFree:  17 kB\n");

    #[test]
    fn the_smallest_limit_holds() {
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[TOTAL]), Some(4 << 20));
        let second = ("/proc/self/cgroup", "0::/user/one\n");
        assert_eq!(
            of(&[TOTAL, second, ("/sys/fs/cgroup/user/one/memory.max", "max\n")]),
            Some(4 << 20)
        );
        assert_eq!(of(&[TOTAL, second, ("/sys/fs/cgroup/user/memory.max", "1000\n")]), Some(1000));
        assert_eq!(of(&[TOTAL, second, ("/sys/fs/cgroup/memory.max", "9000000\n")]), Some(4 << 20));
        let first = ("/proc/self/cgroup", "5:cpu,cpuacct:/\n4:memory:/docker/a\n");
        assert_eq!(
            of(&[TOTAL, first, ("/sys/fs/cgroup/memory/docker/a/memory.limit_in_bytes", "77")]),
            Some(77)
        );
        assert_eq!(
            of(&[TOTAL, first, ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "78")]),
            Some(78)
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_has_memory() {
        assert!(memory().is_some_and(|bytes| bytes > 1 << 20));
    }
}
