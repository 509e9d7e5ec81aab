//! A bounded queue with a thread at its end: putting in never waits, whatever the thread waits for.

use std::{
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

/// The end that is put into. Clones are one.
pub(crate) struct Outbox<T> {
    queue: SyncSender<T>,
    counts: Arc<Counts>,
}

impl<T> Clone for Outbox<T> {
    fn clone(&self) -> Self {
        Self { queue: self.queue.clone(), counts: Arc::clone(&self.counts) }
    }
}

/// What went through.
#[derive(Default)]
struct Counts {
    put: AtomicU64,
    done: AtomicU64,
    dropped: AtomicU64,
}

/// What the thread gets.
pub(crate) enum Out<T> {
    /// Something that was put in.
    Item(T),
    /// So many were dropped before it, as the queue was full.
    Dropped(u64),
}

impl<T: Send + 'static> Outbox<T> {
    /// One with room for `capacity`. `write` gets everything on a thread of that name, which ends
    /// when all of this are gone. Without a thread all is dropped.
    pub(crate) fn start(
        name: &str,
        capacity: usize,
        write: impl FnMut(Out<T>) + Send + 'static,
    ) -> Self {
        let (queue, items) = sync_channel(capacity);
        let counts = Arc::<Counts>::default();
        let books = Arc::clone(&counts);
        let thread =
            thread::Builder::new().name(name.into()).spawn(move || empty(&items, &books, write));
        // Its end of the queue is gone then, so that nothing is waited for.
        drop(thread);
        Self { queue, counts }
    }

    /// Puts something in; false if there is no room: then it is counted, and lost.
    pub(crate) fn put(&self, item: T) -> bool {
        // Before it can be done, so that nobody sees more done than put.
        self.counts.put.fetch_add(1, Ordering::Release);
        let taken = self.queue.try_send(item).is_ok();
        if !taken {
            self.counts.done.fetch_add(1, Ordering::Release);
            self.counts.dropped.fetch_add(1, Ordering::Relaxed);
        }
        taken
    }

    /// Waits until everything that was put in before is out, but not longer. Whether it is.
    pub(crate) fn flush(&self, at_most: Duration) -> bool {
        let began = Instant::now();
        let put = self.counts.put.load(Ordering::Acquire);
        while self.counts.done.load(Ordering::Acquire) < put {
            if began.elapsed() >= at_most {
                return false;
            }
            thread::sleep(Duration::from_millis(1));
        }
        true
    }
}

fn empty<T>(items: &Receiver<T>, counts: &Counts, mut write: impl FnMut(Out<T>)) {
    while let Ok(item) = items.recv() {
        write(Out::Item(item));
        let dropped = counts.dropped.swap(0, Ordering::Relaxed);
        if dropped > 0 {
            write(Out::Dropped(dropped));
        }
        counts.done.fetch_add(1, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_full_outbox_drops_and_counts_and_never_waits() {
        let (may, allowed) = channel::<()>();
        let (wrote, written) = channel();
        let outbox = Outbox::start("test", 2, move |out| {
            if matches!(out, Out::Item(_)) {
                let _ = allowed.recv();
            }
            let _ = wrote.send(match out {
                Out::Item(item) => item,
                Out::Dropped(count) => 1000 + count,
            });
        });
        assert!(outbox.put(1));
        // The thread holds the first one sooner or later, then two have room.
        while !outbox.put(2) {
            thread::yield_now();
        }
        let mut taken = 2;
        let began = Instant::now();
        for item in 3..100 {
            taken += u64::from(outbox.put(item));
        }
        assert!(taken <= 4 && began.elapsed() < Duration::from_secs(10));
        assert!(!outbox.flush(Duration::from_millis(10)), "the thread is stuck");
        drop(may);
        assert!(outbox.flush(Duration::from_secs(10)));
        let all: Vec<u64> = written.try_iter().collect();
        assert_eq!(all.iter().filter(|item| **item < 1000).count() as u64, taken);
        let dropped: u64 = all.iter().filter(|item| **item >= 1000).map(|item| item - 1000).sum();
        assert!(dropped >= 99 - taken, "{all:?}");
    }

    #[test]
    fn what_was_put_in_is_out_after_a_flush() {
        let (wrote, written) = channel();
        let outbox = Outbox::start("test", 100, move |out| {
            if let Out::Item(item) = out {
                let _ = wrote.send(item);
            }
        });
        (0..50).for_each(|item| assert!(outbox.put(item)));
        assert!(outbox.flush(Duration::from_secs(10)));
        assert_eq!(written.try_iter().collect::<Vec<_>>(), (0..50).collect::<Vec<_>>());
    }
}
