//! Work on behalf of a call: on a thread of its own, without the interpreter's lock, ended by
//! ctrl-C, its errors and panics turned into exceptions.

use std::any::Any;
use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use work::progress::Progress;

use crate::errors::{exception, mistake};

/// How long ctrl-C waits until somebody looks.
const LOOK: Duration = Duration::from_millis(20);
/// How long work that was told to end may take for it; then it is left alone to end by itself.
const END: Duration = Duration::from_millis(500);

type Outcome<T> = Result<anyhow::Result<T>, String>;

/// Does `work`, which looks now and then whether it is to end.
///
/// # Errors
/// The exception of its error; `KeyboardInterrupt` after ctrl-C.
pub fn call<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let cancel = Arc::new(AtomicBool::new(false));
    let (sends, mut receives) = channel();
    let theirs = Arc::clone(&cancel);
    let started = thread::Builder::new().name("frictionlab".to_owned()).spawn(move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| work(&theirs)));
        // Whoever was interrupted no longer listens.
        let _ = sends.send(outcome.map_err(said));
    });
    started.map_err(|error| mistake(py, &format!("no thread could be started: {error}")))?;
    loop {
        let (outcome, back) = wait(py, receives, LOOK);
        receives = back;
        match outcome {
            Ok(Ok(result)) => return result.map_err(|error| exception(py, &error)),
            Ok(Err(panic)) => return Err(mistake(py, &panic)),
            Err(RecvTimeoutError::Disconnected) => return Err(mistake(py, "the work vanished")),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(interrupt) = py.check_signals() {
                    cancel.store(true, Ordering::Relaxed);
                    let _ = wait(py, receives, END);
                    return Err(interrupt);
                }
            }
        }
    }
}

/// Waits without the interpreter's lock.
fn wait<T: Send>(
    py: Python<'_>,
    receives: Receiver<Outcome<T>>,
    longest: Duration,
) -> (Result<Outcome<T>, RecvTimeoutError>, Receiver<Outcome<T>>) {
    py.detach(move || (receives.recv_timeout(longest), receives))
}

/// Does something short on this thread, with the lock.
///
/// # Errors
/// The exception of its error, or of its panic.
pub fn at_once<T>(py: Python<'_>, work: impl FnOnce() -> anyhow::Result<T>) -> PyResult<T> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(result) => result.map_err(|error| exception(py, &error)),
        Err(panic) => Err(mistake(py, &said(panic))),
    }
}

/// Nobody sees how far it is.
pub fn silent() -> Progress {
    Progress::counting(1, "", true)
}

/// Threads: all cores, if nobody says how many.
pub fn workers(jobs: Option<NonZero<u16>>) -> usize {
    jobs.map_or_else(
        || thread::available_parallelism().map_or(1, usize::from),
        |jobs| usize::from(jobs.get()),
    )
}

/// What a panic says.
fn said(panic: Box<dyn Any + Send>) -> String {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(text), _) => (*text).to_owned(),
        (_, Some(text)) => text.clone(),
        _ => "it panicked".to_owned(),
    }
}
