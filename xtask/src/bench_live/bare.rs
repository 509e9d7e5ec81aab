//! A loop that does nothing but sleep to its next deadline.

use std::time::Duration;

use rustix::io::Errno;
use rustix::thread::clock_nanosleep_absolute;
use rustix::time::{ClockId, Timespec, clock_gettime};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use super::errors::PeriodErrors;

/// That of the control thread.
const PRIORITY: u8 = 50;
const SECOND: u64 = 1_000_000_000;

/// Runs the loop on the calling thread, which gets real-time priority if the system grants it.
pub(super) fn run(period: Duration, cycles: u64) -> PeriodErrors {
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let realtime = ThreadPriorityValue::try_from(PRIORITY).is_ok_and(|priority| {
        set_thread_priority_and_policy(
            thread_native_id(),
            ThreadPriority::Crossplatform(priority),
            policy,
        )
        .is_ok()
    });
    let period = period.as_nanos() as u64;
    let mut errors = Vec::with_capacity(cycles as usize);
    let mut deadline = now() + period;
    let mut before = None;
    for _ in 0..cycles {
        let until =
            Timespec { tv_sec: (deadline / SECOND) as _, tv_nsec: (deadline % SECOND) as _ };
        // A signal wakes the thread early.
        while clock_nanosleep_absolute(ClockId::Monotonic, &until) == Err(Errno::INTR) {}
        let start = now();
        if let Some(before) = before.replace(start) {
            errors.push(period.abs_diff(start - before));
        }
        deadline += period;
    }
    PeriodErrors::of(errors, period, realtime)
}

fn now() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec.unsigned_abs() * SECOND + now.tv_nsec.unsigned_abs()
}
