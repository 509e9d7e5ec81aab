//! Bounded queues out of and into control threads: sending never waits, and wakes the thread that
//! takes.

use std::{
    sync::{
        Arc, OnceLock,
        atomic::{AtomicU64, Ordering},
    },
    thread::{self, Thread},
    time::Duration,
};

use rtrb::{Consumer, Producer, RingBuffer};

/// The thread that is to be woken by its queues. Clones are one.
#[derive(Debug, Clone, Default)]
pub struct Waker(Arc<OnceLock<Thread>>);

impl Waker {
    /// Makes the calling thread the one to be woken. Only the first call counts.
    pub fn is_this_thread(&self) {
        let _ = self.0.set(thread::current());
    }

    /// Wakes it, or lets its next sleep end at once. Never waits.
    pub fn wake(&self) {
        if let Some(thread) = self.0.get() {
            thread.unpark();
        }
    }

    /// Sleeps until it is woken, at most so long.
    pub fn sleep(at_most: Duration) {
        thread::park_timeout(at_most);
    }
}

/// The end that is put into.
#[derive(Debug)]
pub struct Sender<T> {
    producer: Producer<T>,
    waker: Waker,
    dropped: Arc<AtomicU64>,
}

impl<T> Sender<T> {
    /// Puts something in and wakes the thread at the other end. False if the queue is full: it is
    /// counted, and lost.
    pub fn send(&mut self, item: T) -> bool {
        let taken = self.producer.push(item).is_ok();
        if !taken {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
        self.waker.wake();
        taken
    }

    /// Counts what was lost, for others to see.
    #[must_use]
    pub fn dropped(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.dropped)
    }
}

impl<T> Drop for Sender<T> {
    fn drop(&mut self) {
        self.waker.wake();
    }
}

/// The end that is taken from.
#[derive(Debug)]
pub struct Receiver<T>(Consumer<T>);

impl<T> Receiver<T> {
    /// The oldest that is left, if any.
    pub fn take(&mut self) -> Option<T> {
        self.0.pop().ok()
    }

    /// The newest, if any; the others are lost.
    pub fn take_last(&mut self) -> Option<T> {
        let mut last = None;
        while let Some(item) = self.take() {
            last = Some(item);
        }
        last
    }

    /// Nothing is left and nothing will come.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.0.is_abandoned() && self.0.is_empty()
    }
}

/// A queue with room for `capacity`, whose taker sleeps by `waker`.
#[must_use]
pub fn queue<T>(capacity: usize, waker: &Waker) -> (Sender<T>, Receiver<T>) {
    let (producer, consumer) = RingBuffer::new(capacity);
    (Sender { producer, waker: waker.clone(), dropped: Arc::default() }, Receiver(consumer))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_queue_counts_and_never_waits() {
        let (mut sender, mut receiver) = queue(2, &Waker::default());
        assert_eq!([sender.send(1), sender.send(2), sender.send(3)], [true, true, false]);
        assert_eq!(sender.dropped().load(Ordering::Relaxed), 1);
        assert_eq!(receiver.take(), Some(1));
        sender.send(4);
        assert_eq!(receiver.take_last(), Some(4));
        assert!(!receiver.is_over());
        drop(sender);
        assert!(receiver.is_over());
    }

    #[test]
    fn sending_wakes_the_taker() {
        let waker = Waker::default();
        let (mut sender, mut receiver) = queue(8, &waker);
        let (begin, begun) = std::sync::mpsc::channel();
        let taker = thread::spawn(move || {
            waker.is_this_thread();
            begin.send(()).unwrap();
            loop {
                if let Some(item) = receiver.take() {
                    return item;
                }
                Waker::sleep(Duration::from_secs(60));
            }
        });
        begun.recv().unwrap();
        sender.send(5);
        assert_eq!(taker.join().unwrap(), 5);
    }
}
