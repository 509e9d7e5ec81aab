//! Log lines, on the terminal and on `/rosout`.

use std::{
    io::Write,
    sync::{Arc, Mutex, PoisonError},
};

use ros2_client::{NodeLoggingHandle, RosoutRaw, ros2};

use crate::{LogLevel, NodeClock};

/// Writes log lines of one node. Clones write the same. It may wait for the network: never call it from a control thread.
#[derive(Clone)]
pub struct Logger(Arc<Inner>);

struct Inner {
    name: String,
    level: LogLevel,
    terminal: bool,
    clock: NodeClock,
    /// `None` once the node has left, or where `/rosout` is switched off.
    rosout: Mutex<Option<NodeLoggingHandle>>,
}

impl Logger {
    pub(crate) fn new(
        name: String,
        level: LogLevel,
        terminal: bool,
        clock: NodeClock,
        rosout: Option<NodeLoggingHandle>,
    ) -> Self {
        Self(Arc::new(Inner { name, level, terminal, clock, rosout: Mutex::new(rosout) }))
    }

    /// Lets go of `/rosout`.
    pub(crate) fn leave(&self) {
        self.0.rosout.lock().unwrap_or_else(PoisonError::into_inner).take();
    }

    /// Writes a line of that level.
    pub fn log(&self, level: LogLevel, text: &str) {
        let Inner { name, clock, rosout, .. } = &*self.0;
        if level < self.0.level {
            return;
        }
        let now = clock.now_ns();
        let text = &*crate::limits::line(text);
        if self.0.terminal {
            // Nobody is told if the terminal is gone.
            let _ = writeln!(
                std::io::stderr(),
                "[{level}] [{}.{:09}] [{name}]: {text}",
                now / 1_000_000_000,
                now % 1_000_000_000
            );
        }
        if let Some(handle) = &*rosout.lock().unwrap_or_else(PoisonError::into_inner) {
            let stamp =
                ros2_client::builtin_interfaces::Time::from_nanos(i64::try_from(now).unwrap_or(i64::MAX));
            let level = match level {
                LogLevel::Debug => ros2::LogLevel::Debug,
                LogLevel::Info => ros2::LogLevel::Info,
                LogLevel::Warn => ros2::LogLevel::Warn,
                LogLevel::Error => ros2::LogLevel::Error,
                LogLevel::Fatal => ros2::LogLevel::Fatal,
            };
            handle.rosout_raw(stamp, level, name, text, "", "", 0);
        }
    }

    /// For those who look for a mistake.
    pub fn debug(&self, text: &str) {
        self.log(LogLevel::Debug, text);
    }

    /// What happens.
    pub fn info(&self, text: &str) {
        self.log(LogLevel::Info, text);
    }

    /// What somebody should look at.
    pub fn warn(&self, text: &str) {
        self.log(LogLevel::Warn, text);
    }

    /// What does not work.
    pub fn error(&self, text: &str) {
        self.log(LogLevel::Error, text);
    }
}
