//! Whether the middleware still lives.
//!
//! RustDDS 0.15 works in two threads of its own. Both end for good when their wait is interrupted (the process was stopped and
//! continued, the machine was suspended), and a panic ends them too. The process then goes on deaf: it hears no new participant, or nothing
//! at all, and is told nothing. And a damaged HEARTBEAT that announces billions of messages keeps one of them busy with listing what is missing, two
//! gigabytes a second. So the threads are looked after from outside.

use std::{collections::BTreeMap, fmt, fs, io::Write, process, thread, time::Duration};

use crate::Stop;

/// What the names of the middleware's threads begin with.
const NAME: &str = "RustDDS";
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(100);
/// Looks until the threads that are there count as all: they name themselves once they run.
const SETTLED: u32 = 5;
/// Processor time that a thread may take without once waiting for anything, while the process grows by [`GROWTH`].
const STUCK: Duration = Duration::from_secs(1);
/// Growth of the process that no messages explain [bytes].
const GROWTH: u64 = 256 << 20;
/// The same time where the process does not grow: on a machine that has no time for it, or in a flood, a thread has no reason to wait for long.
const STUCK_ANYHOW: Duration = Duration::from_secs(20);
/// Time for the motor to come to rest, and for what is recorded, once a thread is stuck. Then the process ends: no thread can be made to.
const LAST_WORDS: Duration = Duration::from_secs(3);

/// How the middleware was lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lost {
    /// A thread of that name has ended.
    Ended(String),
    /// A thread of that name computes without end. The process ends by itself, with code 1, a moment after this was noticed.
    Stuck(String),
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ended(thread) => write!(
                f,
                "a thread of the middleware ({thread}) has ended, as it does when a program was stopped and continued"
            ),
            Self::Stuck(thread) => {
                write!(
                    f,
                    "a thread of the middleware ({thread}) computes without end, as a damaged packet makes it"
                )
            }
        }
    }
}

/// What a thread was last seen at.
struct Seen {
    name: String,
    /// How often it has waited.
    waits: u64,
    /// Processor time it had taken when `waits` last changed.
    busy_since: Duration,
    /// Memory of the process then [bytes].
    memory: u64,
}

/// What the system tells of a thread.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Told {
    name: String,
    waits: u64,
    taken: Duration,
}

/// Sets `stop` when `wished` is set or the middleware is lost; returns how. Ends when `stop` is set.
///
/// Where the system does not list a process's threads under `/proc`, none is ever missed.
fn watch(wished: &Stop, stop: &Stop) -> Option<Lost> {
    let mut known = BTreeMap::new();
    let mut looks = 0;
    let mut lost = None;
    while lost.is_none() && !stop.is_set() && !wished.wait(LOOK) {
        let (now, memory) = (threads(), memory());
        if looks < SETTLED {
            looks += 1;
            for (id, told) in &now {
                known.entry(*id).or_insert_with(|| Seen::first(told, memory));
            }
        }
        lost = known.iter_mut().find_map(|(id, seen)| match now.get(id) {
            None => Some(Lost::Ended(seen.name.clone())),
            Some(told) => seen.again(told, memory).then(|| Lost::Stuck(seen.name.clone())),
        });
    }
    if let Some(lost @ Lost::Stuck(_)) = &lost {
        end_soon(lost.clone());
    }
    stop.set();
    lost
}

impl Seen {
    fn first(told: &Told, memory: u64) -> Self {
        Self { name: told.name.clone(), waits: told.waits, busy_since: told.taken, memory }
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

/// Ends the process when it had its time: leaving in order would wait for the stuck thread.
fn end_soon(lost: Lost) {
    let end = move || {
        thread::sleep(LAST_WORDS);
        // The terminal may be gone: that must not keep the process.
        let text = format!("{lost}; the process ends, with the motor at zero volts: start it again");
        let _ = writeln!(std::io::stderr(), "{text}");
        process::exit(1);
    };
    // Without a thread the process leaves as far as it can.
    let _ = thread::Builder::new().name("last words".into()).spawn(end);
}

/// The middleware's threads in this process, by their number.
fn threads() -> BTreeMap<u32, Told> {
    let Ok(tasks) = fs::read_dir("/proc/self/task") else { return BTreeMap::new() };
    tasks
        .filter_map(|task| {
            let folder = task.ok()?.path();
            let read = |file: &str| fs::read_to_string(folder.join(file)).ok();
            let name = read("comm").filter(|name| name.starts_with(NAME))?.trim_end().to_owned();
            let id = folder.file_name()?.to_str()?.parse().ok()?;
            let books =
                read("status").as_deref().and_then(waits).zip(read("schedstat").as_deref().and_then(taken));
            // Where the system keeps no such books, no thread is ever stuck.
            let (waits, taken) = books.unwrap_or_default();
            Some((id, Told { name, waits, taken }))
        })
        .collect()
}

/// Memory of this process that is resident [bytes]; nothing where the system does not tell.
fn memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    kilobytes.and_then(|told| told.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()).unwrap_or_default()
        << 10
}

/// How often a thread has waited, from its `status`.
fn waits(status: &str) -> Option<u64> {
    status.lines().find_map(|line| line.strip_prefix("voluntary_ctxt_switches:"))?.trim().parse().ok()
}

/// Processor time that a thread has taken, from its `schedstat`.
fn taken(schedstat: &str) -> Option<Duration> {
    schedstat.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// Watches the middleware's threads from a thread of its own. For programs that join by themselves; [`run`](crate::run) does it for its body.
pub struct Watch {
    stop: Stop,
    thread: Option<thread::JoinHandle<Option<Lost>>>,
}

impl Watch {
    /// Begins, once the process has joined. `wished` is the wish to end that comes from elsewhere.
    ///
    /// # Errors
    /// What the system says if it grants no thread.
    pub fn start(wished: &Stop) -> Result<Self, std::io::Error> {
        let stop = Stop::default();
        let (wished, told) = (wished.clone(), stop.clone());
        let thread = thread::Builder::new().name("middleware".into()).spawn(move || watch(&wished, &told))?;
        Ok(Self { stop, thread: Some(thread) })
    }

    /// Set when the node is to end, for whatever reason.
    #[must_use]
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// Ends it; how the middleware was lost, if it was.
    #[must_use]
    pub fn end(mut self) -> Option<Lost> {
        self.stop.set();
        self.thread.take().and_then(|thread| thread.join().ok()).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_thread_of_the_middleware_that_ends_is_missed() {
        let (end, ends) = channel::<()>();
        let (here, is_here) = channel();
        let thread = thread::Builder::new()
            .name("RustDDS in a test".into())
            .spawn(move || {
                here.send(()).unwrap();
                let _ = ends.recv();
            })
            .unwrap();
        is_here.recv().unwrap();
        let wished = Stop::default();
        let watch = Watch::start(&wished).unwrap();
        assert!(!watch.stop().wait(LOOK * (SETTLED + 3)), "all are there");
        drop(end);
        thread.join().unwrap();
        assert!(watch.stop().wait(Duration::from_secs(10)));
        assert_eq!(watch.end(), Some(Lost::Ended("RustDDS in a te".into())), "Linux keeps 15 characters");
    }

    #[test]
    fn the_wish_to_end_is_passed_on() {
        let wished = Stop::default();
        let watch = Watch::start(&wished).unwrap();
        wished.set();
        assert!(watch.stop().wait(Duration::from_secs(10)));
        assert_eq!(watch.end(), None);
    }

    #[test]
    fn a_thread_is_stuck_that_computes_and_never_waits() {
        let told = |waits, taken_ms| Told { name: "x".into(), waits, taken: Duration::from_millis(taken_ms) };
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
    fn the_books_of_the_system_are_read() {
        let here = thread::Builder::new().name("RustDDS books".into()).spawn(|| {
            thread::sleep(Duration::from_millis(5));
            threads().into_values().find(|told| told.name == "RustDDS books")
        });
        let told = here.unwrap().join().unwrap().unwrap();
        assert!(told.waits > 0 && told.taken > Duration::ZERO, "{told:?}");
        assert!(memory() > 1 << 20);
    }
}
