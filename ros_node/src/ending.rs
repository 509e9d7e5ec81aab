//! The end of a process that does not end in order.
//!
//! Leaving in order needs threads that may be stuck: in a packet that the middleware computes over
//! without end, in a write to a terminal that nobody reads. So a process can be ended by force.
//! First come a few short acts, as to put the motor at zero volts.

use std::{
    process,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::channel,
    },
    thread,
    time::{Duration, Instant},
};

use crate::terminal;

/// Time that all acts have together.
const ACTS: Duration = Duration::from_millis(500);
/// Time for the last line.
const LINE: Duration = Duration::from_millis(100);
/// Time after which the process is killed if even the exit waits for something.
const KILL: Duration = Duration::from_millis(1500);

type Act = dyn Fn() + Send + Sync;

static BEFORE: Mutex<Vec<Arc<Act>>> = Mutex::new(Vec::new());

/// Has `act` done once before the process is ended by force, on a thread of its own, beside the
/// other acts. They all have half a second; then the process ends, whatever they do. An act stays
/// for the life of the process: let it hold what it acts on by a [`Weak`](std::sync::Weak).
///
/// By force ends a process that a signal does not end in time, a second signal, and a middleware
/// that is stuck.
pub fn before_forced_exit(act: impl Fn() + Send + Sync + 'static) {
    BEFORE.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::new(act));
}

/// Does all acts, each once, and waits for them, but not longer than [`ACTS`].
fn act() {
    let acts: Vec<_> = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).drain(..).collect();
    let (done, is_done) = channel();
    let mut waiting = 0;
    for act in acts {
        let (on_thread, done) = (Arc::clone(&act), done.clone());
        let spawned = thread::Builder::new().name("forced exit".into()).spawn(move || {
            on_thread();
            let _ = done.send(());
        });
        match spawned {
            Ok(_) => waiting += 1,
            // The system is out of threads: here then.
            Err(_) => act(),
        }
    }
    drop(done);
    let began = Instant::now();
    for _ in 0..waiting {
        // One that panicked sends nothing: the end of the channel says so.
        if is_done.recv_timeout(ACTS.saturating_sub(began.elapsed())).is_err() {
            break;
        }
    }
}

/// Ends the process with that code, after the acts. `why` is told if the terminal takes it.
pub(crate) fn force(code: u8, why: &str) -> ! {
    static BEGUN: AtomicBool = AtomicBool::new(false);
    if BEGUN.swap(true, Ordering::AcqRel) {
        // Another thread is at it, and ends the process.
        loop {
            thread::sleep(KILL);
        }
    }
    // An exit flushes what was printed, and may wait for it.
    let kill = || {
        thread::sleep(KILL);
        let _ =
            rustix::process::kill_process(rustix::process::getpid(), rustix::process::Signal::KILL);
    };
    // Without a thread the exit has to do.
    let _ = thread::Builder::new().name("kill".into()).spawn(kill);
    act();
    terminal::tell(why);
    terminal::flush_within(LINE);
    process::exit(code.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicU32;

    #[test]
    fn acts_are_done_once_and_one_that_hangs_does_not_keep_the_others() {
        static DONE: AtomicU32 = AtomicU32::new(0);
        let (hang, hangs) = channel::<()>();
        let hangs = Mutex::new(hangs);
        before_forced_exit(move || _ = hangs.lock().unwrap().recv());
        before_forced_exit(|| panic!("an act that fails"));
        before_forced_exit(|| _ = DONE.fetch_add(1, Ordering::Relaxed));
        let began = Instant::now();
        act();
        assert_eq!(DONE.load(Ordering::Relaxed), 1);
        assert!(began.elapsed() >= ACTS, "it waits for the one that hangs");
        assert!(began.elapsed() < Duration::from_secs(20), "but not for ever");
        act();
        assert_eq!(DONE.load(Ordering::Relaxed), 1);
        drop(hang);
    }
}
