//! SIGINT and SIGTERM: the wish to end.

use std::{
    sync::{Arc, Condvar, Mutex, PoisonError},
    time::{Duration, Instant},
};

use crate::RosNodeError;

/// The wish to end, as a thing that threads can wait for. Clones are one.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<(Mutex<bool>, Condvar)>);

impl Stop {
    /// One that SIGINT, SIGTERM and SIGHUP set. A process has only one.
    ///
    /// # Errors
    /// [`RosNodeError::Signals`] if the handler cannot be set.
    pub fn on_signals() -> Result<Self, RosNodeError> {
        let stop = Self::default();
        let handler = stop.clone();
        ctrlc::set_handler(move || handler.set())
            .map_err(|error| RosNodeError::Signals(error.to_string()))?;
        Ok(stop)
    }

    /// Wishes it.
    pub fn set(&self) {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.1.notify_all();
    }

    /// Whether somebody wishes it.
    #[must_use]
    pub fn is_set(&self) -> bool {
        *self.0.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for it, at most so long. Returns whether it was wished.
    #[must_use]
    pub fn wait(&self, at_most: Duration) -> bool {
        let deadline = Instant::now() + at_most;
        let mut wished = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        while !*wished {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            wished = self.0.1.wait_timeout(wished, left).unwrap_or_else(PoisonError::into_inner).0;
        }
        *wished
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_ends_with_the_wish_or_with_the_time() {
        let stop = Stop::default();
        assert!(!stop.wait(Duration::from_millis(1)));
        let other = stop.clone();
        let thread = std::thread::spawn(move || other.wait(Duration::from_secs(60)));
        stop.set();
        assert!(thread.join().unwrap() && stop.is_set());
    }
}
