//! Whether the middleware still lives.
//!
//! RustDDS 0.15 works in two threads of its own. Both end for good when their wait is interrupted
//! (the process was stopped and continued, the machine was suspended), and a panic ends them too.
//! The process then goes on deaf: it hears no new participant, or nothing at all, and is told
//! nothing. And a damaged HEARTBEAT that announces billions of messages keeps one of them busy with
//! listing what is missing, two gigabytes a second. So the threads are looked after from outside.

mod guard;
mod threads;

use std::{collections::BTreeMap, fmt, thread, time::Duration};

use crate::Stop;

pub(crate) use guard::{Leave, begin as guard};

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(100);
/// Looks until the threads that are there count as all: they name themselves once they run.
const SETTLED: u32 = 5;

/// How the middleware was lost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Lost {
    /// A thread of that name has ended.
    Ended(String),
    /// A thread of that name computes without end. The process ends by itself, with code 1, a
    /// moment after this was noticed.
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

/// Sets `stop` when `wished` is set or the middleware is lost; returns how. Ends when `stop` is
/// set.
///
/// Where the system does not list a process's threads under `/proc`, none is ever missed.
fn watch(wished: &Stop, stop: &Stop) -> Option<Lost> {
    let mut known = BTreeMap::new();
    let mut looks = 0;
    let mut lost = None;
    while lost.is_none() && !stop.is_set() && !wished.wait(LOOK) {
        lost = guard::stuck();
        let Some(now) = threads::threads() else { continue };
        if looks < SETTLED {
            looks += 1;
            known.extend(now.iter().map(|(id, told)| (*id, told.name.clone())));
        }
        let ended = known.iter().find(|(id, _)| !now.contains_key(id));
        lost = lost.or_else(|| ended.map(|(_, name)| Lost::Ended(name.clone())));
    }
    stop.set();
    lost
}

/// Watches the middleware's threads from a thread of its own. For programs that join by themselves;
/// [`run`](crate::run) does it for its body.
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
        let thread = thread::Builder::new()
            .name("middleware".into())
            .spawn(move || watch(&wished, &told))?;
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

    /// Linux keeps 15 characters of a name.
    const NAME: &str = "RustDDS in a te";

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
        let settled = |_| {
            let watch = Watch::start(&wished).unwrap();
            if !watch.stop().wait(LOOK * (SETTLED + 3)) {
                return Some(watch);
            }
            // A participant of another test in this process has left.
            assert_ne!(watch.end(), Some(Lost::Ended(NAME.into())), "it is there");
            None
        };
        let watch = (0..50).find_map(settled).expect("a moment in which no participant leaves");
        drop(end);
        thread.join().unwrap();
        assert!(watch.stop().wait(Duration::from_secs(10)));
        let ended = watch.end();
        assert!(matches!(ended, Some(Lost::Ended(_))), "{ended:?}");
    }

    #[test]
    fn the_wish_to_end_is_passed_on() {
        let wished = Stop::default();
        let watch = Watch::start(&wished).unwrap();
        wished.set();
        assert!(watch.stop().wait(Duration::from_secs(10)));
        assert_eq!(watch.end(), None);
    }
}
