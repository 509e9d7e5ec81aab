//! The time that viewers are told.

use std::time::{SystemTime, UNIX_EPOCH};

/// Now [ns since the epoch].
pub(super) fn now_ns() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(now.as_nanos()).unwrap_or(u64::MAX)
}
