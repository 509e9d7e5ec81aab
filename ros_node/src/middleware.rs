//! Whether the middleware still lives.
//!
//! RustDDS 0.15 works in two threads of its own. Both end for good when their wait is interrupted (the process was stopped and
//! continued, the machine was suspended), and a panic ends them too. The process then goes on deaf: it hears no new participant, or nothing
//! at all, and is told nothing. So the threads are looked after from outside.

use std::{collections::BTreeMap, fs, thread, time::Duration};

use crate::Stop;

/// What the names of the middleware's threads begin with.
const NAME: &str = "RustDDS";
/// Time between two looks.
const LOOK: Duration = Duration::from_millis(100);
/// Looks until the threads that are there count as all: they name themselves once they run.
const SETTLED: u32 = 5;

/// Sets `stop` when `wished` is set or one of the middleware's threads has gone; returns the name of that one. Ends when `stop` is set.
///
/// Where the system does not list a process's threads under `/proc`, none is ever missed.
pub(crate) fn watch(wished: &Stop, stop: &Stop) -> Option<String> {
    let mut known = BTreeMap::new();
    let mut looks = 0;
    let mut lost = None;
    while lost.is_none() && !stop.is_set() && !wished.wait(LOOK) {
        let now = threads();
        if looks < SETTLED {
            looks += 1;
            known.extend(now.clone());
        }
        lost = known.iter().find(|(id, _)| !now.contains_key(id)).map(|(_, name)| name.clone());
    }
    stop.set();
    lost
}

/// The middleware's threads in this process, by their number.
fn threads() -> BTreeMap<u32, String> {
    let Ok(tasks) = fs::read_dir("/proc/self/task") else { return BTreeMap::new() };
    tasks
        .filter_map(|task| {
            let task = task.ok()?;
            let name = fs::read_to_string(task.path().join("comm")).ok()?;
            let id = task.file_name().to_str()?.parse().ok()?;
            name.starts_with(NAME).then(|| (id, name.trim_end().to_owned()))
        })
        .collect()
}

/// Watches the middleware's threads from a thread of its own. For programs that join by themselves; [`run`](crate::run) does it for its body.
pub struct Watch {
    stop: Stop,
    thread: Option<thread::JoinHandle<Option<String>>>,
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

    /// Ends it; the middleware's thread that was lost, if it was one.
    #[must_use]
    pub fn end(mut self) -> Option<String> {
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
        assert_eq!(watch.end().as_deref(), Some("RustDDS in a te"), "Linux keeps 15 characters");
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
