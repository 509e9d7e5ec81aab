//! The process's memory stays where it is, so that no cycle waits for a disk.

use std::{fs, sync::OnceLock};

use rustix::{
    mm::{MlockAllFlags, mlockall},
    process::{Resource, getrlimit},
};

/// The number of `CAP_IPC_LOCK` among the capabilities.
const IPC_LOCK: u32 = 14;

/// Locks what memory the process has and gets, where the system grants that without a limit, once
/// for the process. Returns words that say what came of it.
///
/// Pages count from their first use on, so that threads with large stacks cost nothing more. Under
/// a limit nothing is locked: what passed it later would be refused, and a program that gets no
/// memory ends.
pub(super) fn lock() -> &'static str {
    static LOCKED: OnceLock<String> = OnceLock::new();
    LOCKED.get_or_init(|| {
        let refused = |why: &str| {
            format!(
                "memory not locked, expect late cycles when the system swaps: {why}; allow it with an unlimited `memlock` limit or CAP_IPC_LOCK"
            )
        };
        if getrlimit(Resource::Memlock).current.is_some() && !may_lock() {
            return refused("there is a limit");
        }
        match mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT) {
            Ok(()) => "memory locked".to_owned(),
            Err(error) => refused(&error.to_string()),
        }
    })
}

fn may_lock() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let effective = status.lines().find_map(|line| line.strip_prefix("CapEff:"));
    let set = effective.and_then(|hex| u64::from_str_radix(hex.trim(), 16).ok());
    set.is_some_and(|set| set >> IPC_LOCK & 1 == 1)
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_says_what_came_of_it() {
        let said = super::lock();
        assert!(said == "memory locked" || said.contains("memlock"), "{said}");
        assert_eq!(said, super::lock());
    }
}
