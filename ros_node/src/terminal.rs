//! Lines for the terminal that nobody waits for.
//!
//! Standard error and standard output may be a pipe that nobody reads: then a write waits for ever,
//! and holds a lock for which all others wait. So only one thread of each writes, from a bounded
//! queue ([`Outbox`]). A full queue costs lines, which are counted and told.

use std::{io::Write, panic, sync::OnceLock, thread, time::Duration};

use crate::outbox::{Out, Outbox};

/// Lines that wait.
const WAITING: usize = 1024;
/// Longest wait for the lines at a clean end.
const LAST_LINES: Duration = Duration::from_secs(1);

/// Where a line goes.
#[derive(Debug, Clone, Copy)]
enum To {
    Out,
    Err,
}

fn queue(to: To) -> &'static Outbox<String> {
    static OUT: OnceLock<Outbox<String>> = OnceLock::new();
    static ERR: OnceLock<Outbox<String>> = OnceLock::new();
    let (queue, name) = match to {
        To::Out => (&OUT, "stdout"),
        To::Err => (&ERR, "stderr"),
    };
    queue.get_or_init(|| Outbox::start(name, WAITING, move |out| write(to, out)))
}

fn write(to: To, out: Out<String>) {
    let line = match out {
        Out::Item(line) => line + "\n",
        Out::Dropped(count) => {
            format!("{count} log lines were dropped: whoever reads them did not keep up\n")
        }
    };
    // Nobody is told if the terminal is gone. One write a line, so that lines stay whole.
    let _ = match to {
        To::Out => std::io::stdout().write_all(line.as_bytes()),
        To::Err => std::io::stderr().write_all(line.as_bytes()),
    };
}

/// A line for standard error, sooner or later. Never waits.
pub fn tell(line: impl Into<String>) {
    queue(To::Err).put(line.into());
}

/// A line for standard output, sooner or later. Never waits.
pub fn say(line: impl Into<String>) {
    queue(To::Out).put(line.into());
}

/// Waits until the lines are out, for a second at most: before a program ends in order, or writes
/// by itself.
pub fn flush() {
    flush_within(LAST_LINES);
}

pub(crate) fn flush_within(at_most: Duration) {
    queue(To::Out).flush(at_most);
    queue(To::Err).flush(at_most);
}

/// From now on panics are told by [`tell`]: a thread that panics must not wait for the terminal
/// before it lets go of what it holds.
pub fn tell_panics() {
    panic::set_hook(Box::new(|panic| {
        let thread = thread::current();
        let name = thread.name().unwrap_or("without a name");
        tell(format!("the thread {name} {panic}\n{}", std::backtrace::Backtrace::capture()));
    }));
}
