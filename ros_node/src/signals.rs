//! SIGINT, SIGTERM and SIGHUP: the wish to end, and an end that comes whatever is stuck.

use std::{
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

use crate::{RosNodeError, ending};

/// Time from the first signal in which a program ends, if it does not say another
/// ([`ends_within`]).
pub const ENDS_WITHIN: Duration = Duration::from_secs(5);
/// The same for programs that have a bag to write.
pub const ENDS_WITHIN_WRITING: Duration = Duration::from_secs(10);
/// Exit code of a program that ctrl-C ended: 128 plus the number of SIGINT, as shells tell it.
/// Other signals have theirs.
pub const FORCED: u8 = 130;
/// Signals that come so soon after the first count as the same: a closing terminal sends several.
const SAME: Duration = Duration::from_millis(100);

/// [`ENDS_WITHIN`] or what the program says \[ms\].
static WITHIN_MS: AtomicU64 = AtomicU64::new(ENDS_WITHIN.as_millis() as u64);

/// The first signal that came; 0 for none.
static FIRST: AtomicU8 = AtomicU8::new(0);

/// Exit code of a program that a signal ended, 128 plus its number: 130 for SIGINT, 143 for
/// SIGTERM, 129 for SIGHUP; [`FORCED`] if none came.
#[must_use]
pub fn signal_exit_code() -> u8 {
    match FIRST.load(Ordering::Acquire) {
        0 => FORCED,
        signal => code_of(signal),
    }
}

const fn code_of(signal: u8) -> u8 {
    128_u8.saturating_add(signal)
}

/// Sets how long this program may take to end after the first signal.
pub fn ends_within(time: Duration) {
    WITHIN_MS.store(u64::try_from(time.as_millis()).unwrap_or(u64::MAX), Ordering::Relaxed);
}

/// The wish to end, as a thing that threads can wait for. Clones are one.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    wished: Arc<AtomicBool>,
    lock: Mutex<()>,
    changed: Condvar,
}

impl Stop {
    /// One that SIGINT, SIGTERM and SIGHUP set. A process has only one.
    ///
    /// The first signal is the wish to end. If the process is still there [`ENDS_WITHIN`] later, or
    /// when a second signal comes, it ends at once with the code of that signal, after what is to
    /// be done [before](crate::before_forced_exit): whatever is stuck.
    ///
    /// # Errors
    /// [`RosNodeError::Signals`] if the handler cannot be set.
    pub fn on_signals() -> Result<Self, RosNodeError> {
        let stop = Self::default();
        let (signal, signals) = channel();
        let told = stop.clone();
        // There from the start: whoever has run out of threads or memory can still be ended.
        thread::Builder::new()
            .name("signals".into())
            .spawn(move || follow(&signals, &told))
            .map_err(|error| RosNodeError::Signals(error.to_string()))?;
        listen(signal).map_err(RosNodeError::Signals)?;
        Ok(stop)
    }

    /// Wishes it.
    pub fn set(&self) {
        self.0.wished.store(true, Ordering::Release);
        drop(self.0.lock.lock().unwrap_or_else(PoisonError::into_inner));
        self.0.changed.notify_all();
    }

    /// Whether somebody wishes it.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.0.wished.load(Ordering::Acquire)
    }

    /// The same as a flag, for those who only look at it.
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0.wished)
    }

    /// Waits for it, at most so long. Returns whether it was wished.
    #[must_use]
    pub fn wait(&self, at_most: Duration) -> bool {
        let deadline = Instant::now() + at_most;
        let mut lock = self.0.lock.lock().unwrap_or_else(PoisonError::into_inner);
        while !self.is_set() {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            lock =
                self.0.changed.wait_timeout(lock, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        self.is_set()
    }
}

/// Sends the number of each signal on.
#[cfg(unix)]
fn listen(tell: Sender<u8>) -> Result<(), String> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM, SIGHUP])
        .map_err(|error| error.to_string())?;
    let pass_on = move || {
        for signal in signals.forever() {
            let Ok(signal) = u8::try_from(signal) else { continue };
            if tell.send(signal).is_err() {
                return;
            }
        }
    };
    thread::Builder::new()
        .name("signals-in".into())
        .spawn(pass_on)
        .map_err(|error| error.to_string())?;
    Ok(())
}

/// The same where there is only ctrl-C, which counts as SIGINT.
#[cfg(not(unix))]
fn listen(tell: Sender<u8>) -> Result<(), String> {
    ctrlc::set_handler(move || _ = tell.send(2)).map_err(|error| error.to_string())
}

/// Passes the first signal on, and ends the process at the second or when the time is over.
fn follow(signals: &Receiver<u8>, stop: &Stop) {
    let Ok(first) = signals.recv() else { return };
    FIRST.store(first, Ordering::Release);
    stop.set();
    let began = Instant::now();
    let within = || Duration::from_millis(WITHIN_MS.load(Ordering::Relaxed));
    loop {
        match signals.recv_timeout(within().saturating_sub(began.elapsed())) {
            Ok(_) if began.elapsed() < SAME => {}
            Ok(signal) => ending::force(code_of(signal), "ended by force, by a second signal"),
            Err(RecvTimeoutError::Timeout) => {
                let seconds = within().as_secs();
                ending::force(
                    code_of(first),
                    &format!("ended by force: something is stuck {seconds} s after the signal"),
                )
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_ends_with_the_wish_or_with_the_time() {
        let stop = Stop::default();
        assert!(!stop.wait(Duration::from_millis(1)));
        let (other, flag) = (stop.clone(), stop.flag());
        let thread = std::thread::spawn(move || other.wait(Duration::from_secs(60)));
        stop.set();
        assert!(thread.join().unwrap() && stop.is_set() && flag.load(Ordering::Relaxed));
    }
}
