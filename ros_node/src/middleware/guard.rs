//! What ends a process whose middleware is stuck or takes the machine's memory.
//!
//! It begins with the first participant and lasts as long as the process: leaving waits for the
//! middleware's threads too.

use std::{
    collections::BTreeMap,
    env,
    sync::{Mutex, Once, OnceLock, PoisonError},
    thread,
    time::{Duration, Instant},
};

use super::{
    LOOK, Lost,
    threads::{Told, memory, threads},
};
use crate::ending;

/// Processor time that a thread may take without once waiting for anything, while the process grows
/// by [`GROWTH`].
const STUCK: Duration = Duration::from_secs(1);
/// Growth of the process that no messages explain \[bytes\].
const GROWTH: u64 = 256 << 20;
/// The same time where the process does not grow: on a machine that has no time for it, or in a
/// flood, a thread has no reason to wait for long.
const STUCK_ANYHOW: Duration = Duration::from_secs(20);
/// Time for the motor to come to rest, and for what is recorded, once a thread is stuck. Then the
/// process ends: no thread can be made to.
const LAST_WORDS: Duration = Duration::from_secs(3);
/// Growth of the process since it joined at which it ends at once \[bytes\], unless [`LIMIT`] says
/// another.
const MEMORY: u64 = 2 << 30;
/// The variable of the environment with that growth \[MiB\].
const LIMIT: &str = "FRICTION_MEMORY";
/// Longest time for the middleware to let go when a participant leaves.
const LEAVING: Duration = Duration::from_secs(10);
/// The code with which the process ends.
const CODE: u8 = 1;

/// Once known, the process ends soon.
static STUCK_IN: OnceLock<Lost> = OnceLock::new();
/// Participants that leave: until when they may.
static LEAVE: Mutex<Vec<(u64, Instant)>> = Mutex::new(Vec::new());

/// The thread that is stuck, if one is.
pub(super) fn stuck() -> Option<Lost> {
    STUCK_IN.get().cloned()
}

/// Begins it, once.
pub(crate) fn begin() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let limit = limit(env::var(LIMIT).ok().as_deref());
        let most = memory().saturating_add(limit);
        // Without a thread the process goes on as far as it can.
        let _ = thread::Builder::new().name("guard".into()).spawn(move || guard(limit, most));
    });
}

/// Growth that is allowed \[bytes\], from the variable's value.
fn limit(value: Option<&str>) -> u64 {
    value
        .and_then(|text| text.trim().parse::<u64>().ok())
        .map_or(MEMORY, |mebibytes| mebibytes.saturating_mul(1 << 20))
}

fn guard(limit: u64, most: u64) {
    let mut known = BTreeMap::<u32, Seen>::new();
    let mut found = None::<(Lost, Instant)>;
    loop {
        thread::sleep(LOOK);
        let memory = memory();
        if memory > most {
            let grown = limit >> 20;
            ending::force(
                CODE,
                &format!(
                    "the process has grown by more than {grown} MiB, as hostile packets make it, and ends, with the motor at zero volts: start it \
                     again. {LIMIT} sets another limit [MiB]"
                ),
            );
        }
        if let Some((lost, since)) = &found {
            if since.elapsed() >= LAST_WORDS {
                ending::force(
                    CODE,
                    &format!(
                        "{lost}; the process ends, with the motor at zero volts: start it again"
                    ),
                );
            }
        } else if let Some(now) = threads() {
            known.retain(|id, _| now.contains_key(id));
            for (id, told) in &now {
                let seen = known.entry(*id).or_insert_with(|| Seen::first(told, memory));
                if seen.again(told, memory) {
                    let lost = Lost::Stuck(told.name.clone());
                    let _ = STUCK_IN.set(lost.clone());
                    found.get_or_insert((lost, Instant::now()));
                }
            }
        }
        let leave = LEAVE.lock().unwrap_or_else(PoisonError::into_inner);
        if leave.iter().any(|(_, until)| Instant::now() >= *until) {
            drop(leave);
            let seconds = LEAVING.as_secs();
            ending::force(
                CODE,
                &format!(
                    "the middleware did not let go within {seconds} s; the process ends by force"
                ),
            );
        }
    }
}

/// What a thread was last seen at.
struct Seen {
    /// How often it has waited.
    waits: u64,
    /// Processor time it had taken when `waits` last changed.
    busy_since: Duration,
    /// Memory of the process then \[bytes\].
    memory: u64,
}

impl Seen {
    fn first(told: &Told, memory: u64) -> Self {
        Self { waits: told.waits, busy_since: told.taken, memory }
    }

    /// Whether it is stuck.
    fn again(&mut self, told: &Told, memory: u64) -> bool {
        if told.waits != self.waits {
            (self.waits, self.busy_since, self.memory) = (told.waits, told.taken, memory);
        }
        let busy = told.taken.saturating_sub(self.busy_since);
        busy >= STUCK_ANYHOW || (busy >= STUCK && memory.saturating_sub(self.memory) >= GROWTH)
    }
}

/// A participant's leave. From [`begin`](Self::begin) until it is dropped the middleware has a
/// stated time, then the process ends.
pub(crate) struct Leave(u64);

impl Leave {
    pub(crate) fn new() -> Self {
        use std::sync::atomic::{AtomicU64, Ordering};
        static NUMBERS: AtomicU64 = AtomicU64::new(0);
        Self(NUMBERS.fetch_add(1, Ordering::Relaxed))
    }

    /// Its time begins.
    pub(crate) fn begin(&self) {
        LEAVE
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push((self.0, Instant::now() + LEAVING));
    }
}

impl Drop for Leave {
    fn drop(&mut self) {
        LEAVE
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .retain(|(number, _)| *number != self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_is_stuck_that_computes_and_never_waits() {
        let told = |waits, taken_ms| Told {
            name: "x".into(),
            waits,
            taken: Duration::from_millis(taken_ms),
        };
        const SMALL: u64 = 1 << 20;
        let mut seen = Seen::first(&told(5, 100_000), SMALL);
        assert!(!seen.again(&told(5, 100_999), GROWTH + SMALL), "not for long");
        assert!(!seen.again(&told(6, 103_000), GROWTH + SMALL), "it has waited in between");
        assert!(!seen.again(&told(6, 103_100), 3 * GROWTH), "it waits still, however long");
        assert!(!seen.again(&told(6, 105_000), GROWTH + 2 * SMALL), "busy with messages");
        assert!(seen.again(&told(6, 105_000), 3 * GROWTH));
        assert!(seen.again(&told(6, 123_000), SMALL));
    }

    #[test]
    fn the_limit_is_two_gibibytes_unless_the_environment_says_another() {
        assert_eq!(
            [limit(None), limit(Some("x")), limit(Some(" 512 "))],
            [2 << 30, 2 << 30, 512 << 20]
        );
    }
}
