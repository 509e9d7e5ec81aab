//! Absolute deadlines on the monotonic clock, and the priority to meet them.

use rustix::{
    io::Errno,
    thread::clock_nanosleep_absolute,
    time::{ClockId, Timespec, clock_gettime},
};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

const NANOSECONDS: u64 = 1_000_000_000;

/// The middle of the real-time priorities: above everything ordinary, below the kernel's own
/// threads.
pub const PRIORITY: u8 = 50;

/// A loop that is further behind than this does not catch up any more \[ns\].
const HOPELESS: u64 = NANOSECONDS / 10;

/// Time on the monotonic clock \[ns\].
pub fn now_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    // The monotonic clock counts from the start of the system: never negative.
    now.tv_sec.unsigned_abs() * NANOSECONDS + now.tv_nsec.unsigned_abs()
}

/// A row of deadlines one period apart.
#[derive(Debug)]
pub struct Deadlines {
    next: u64,
    period: u64,
}

impl Deadlines {
    /// Deadlines from `first` \[ns on the monotonic clock\], `period` \[ns\] apart.
    pub fn new(first: u64, period: u64) -> Self {
        Self { next: first, period }
    }

    /// Sleeps until the next deadline. Returns the time now \[ns\], and whether the deadline was
    /// missed by a whole period.
    ///
    /// A loop that is late runs at once, so that the number of cycles stays that of the clock; one
    /// that is hopelessly late, as after the machine slept, starts a new row.
    pub fn wait(&mut self) -> (u64, bool) {
        let deadline = Timespec {
            tv_sec: (self.next / NANOSECONDS) as _,
            tv_nsec: (self.next % NANOSECONDS) as _,
        };
        // A signal wakes the thread early; any other error is no reason to stop the loop, which
        // then runs too early once.
        while clock_nanosleep_absolute(ClockId::Monotonic, &deadline) == Err(Errno::INTR) {}
        let now = now_ns();
        let late = self.account(now);
        (now, late)
    }

    fn account(&mut self, now: u64) -> bool {
        let behind = now.saturating_sub(self.next);
        self.next = if behind > HOPELESS { now + self.period } else { self.next + self.period };
        behind >= self.period
    }
}

/// The system grants no real-time scheduling.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct RealtimeRefused(
    /// What it says.
    pub String,
);

/// Asks for first-in-first-out real-time scheduling of the calling thread, at priority
/// [`PRIORITY`].
///
/// # Errors
/// [`RealtimeRefused`] with what the system says.
pub fn realtime() -> Result<(), RealtimeRefused> {
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    ThreadPriorityValue::try_from(PRIORITY)
        .and_then(|priority| {
            set_thread_priority_and_policy(
                thread_native_id(),
                ThreadPriority::Crossplatform(priority),
                policy,
            )
            .map_err(|error| format!("{error:?}"))
        })
        .map_err(RealtimeRefused)
}

/// Asks for [`realtime`] scheduling of the calling thread. Returns a line that says what came of
/// it.
pub fn request_realtime() -> String {
    match realtime() {
        Ok(()) => format!("control thread: real time (SCHED_FIFO, priority {PRIORITY})"),
        Err(error) => format!(
            "control thread: ordinary priority, expect late cycles under load: SCHED_FIFO was refused ({error}); \
             allow it with an `rtprio` limit of {PRIORITY} or CAP_SYS_NICE"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_cycles_catch_up_and_hopeless_ones_do_not() {
        let mut row = Deadlines::new(1_000_000, 1_000_000);
        assert!(!row.account(1_000_100), "a cycle that starts within its period is in time");
        assert_eq!(row.next, 2_000_000);
        assert!(row.account(3_000_000), "a cycle a whole period late is late");
        assert_eq!(row.next, 3_000_000, "and the row goes on as if it had been in time");
        assert!(row.account(3_000_000 + HOPELESS + 1));
        assert_eq!(row.next, 4_000_000 + HOPELESS + 1, "a new row");
    }

    #[test]
    fn waiting_ends_at_the_deadline_and_not_before() {
        let first = now_ns() + 2_000_000;
        let (now, _) = Deadlines::new(first, 1_000_000).wait();
        assert!(now >= first);
    }
}
