//! Work that shares no thread with the rest.

use std::{
    future::Future,
    io,
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use futures::{channel::oneshot, future::select};
use tokio::runtime::Builder;

/// Work on a thread of its own, with clock and executor of its own: nothing that other work waits
/// for keeps it. Dropped, the work ends.
pub(crate) struct Apart {
    end: Option<oneshot::Sender<()>>,
    thread: JoinHandle<()>,
}

impl Apart {
    /// Begins it, on a thread of that name.
    ///
    /// # Errors
    /// What the system says if it grants no thread.
    pub(crate) fn start(
        name: &str,
        work: impl Future<Output = ()> + Send + 'static,
    ) -> io::Result<Self> {
        let runtime = Builder::new_current_thread().enable_time().build()?;
        let (end, ended) = oneshot::channel();
        let run = move || {
            let work = std::pin::pin!(work);
            runtime.block_on(async { _ = select(work, ended).await });
        };
        let thread = thread::Builder::new().name(name.into()).spawn(run)?;
        Ok(Self { end: Some(end), thread })
    }

    /// Asks it to end, without waiting.
    pub(crate) fn end(&mut self) {
        self.end.take();
    }

    /// Asks it to end, and waits for that, but not longer. One that does not end is left alone.
    pub(crate) fn join(mut self, at_most: Duration) {
        self.end();
        let began = Instant::now();
        while !self.thread.is_finished() && began.elapsed() < at_most {
            thread::sleep(Duration::from_millis(1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    };

    #[test]
    fn work_ends_when_it_is_joined_and_lets_go_of_what_it_holds() {
        let held = Arc::new(AtomicBool::new(false));
        let inside = Arc::clone(&held);
        let apart = Apart::start("test", async move {
            tokio::time::sleep(Duration::from_millis(1)).await;
            inside.store(true, Ordering::Relaxed);
            std::future::pending::<()>().await;
            drop(inside);
        });
        let apart = apart.unwrap();
        while !held.load(Ordering::Relaxed) {
            thread::yield_now();
        }
        apart.join(Duration::from_secs(60));
        assert_eq!(Arc::strong_count(&held), 1);
    }
}
