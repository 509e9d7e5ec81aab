//! What waits for one viewer.
//!
//! Two lanes: messages of channels, which may be lost, and answers, which may not. A viewer that
//! does not read loses its own oldest messages; one that lets its answers lie as well is shown out.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bytes::Bytes;
use tokio::sync::Notify;

/// Messages that wait at most.
const MESSAGES: usize = 8192;
/// Bytes of messages that wait at most.
const BYTES: usize = 1 << 20;
/// Answers that wait at most.
const ANSWERS: usize = 1024;
/// Bytes of answers that wait at most.
const ANSWER_BYTES: usize = 8 << 20;

/// What goes out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Out {
    /// JSON.
    Text(String),
    /// Begins with its opcode.
    Binary(Bytes),
}

impl Out {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Binary(bytes) => bytes.len(),
        }
    }
}

/// The two lanes of one viewer.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    lanes: Mutex<Lanes>,
    /// Something came, or the queue was closed.
    pub(crate) stirred: Notify,
}

#[derive(Debug, Default)]
struct Lanes {
    messages: VecDeque<Bytes>,
    bytes: usize,
    answers: VecDeque<Out>,
    answer_bytes: usize,
    dropped: u64,
    closed: bool,
}

impl Queue {
    /// A message of a channel. Never waits; the oldest go first.
    pub(crate) fn message(&self, message: Bytes) {
        let mut lanes = self.lanes();
        lanes.bytes += message.len();
        lanes.messages.push_back(message);
        while lanes.messages.len() > MESSAGES || lanes.bytes > BYTES {
            let Some(oldest) = lanes.messages.pop_front() else { break };
            lanes.bytes -= oldest.len();
            lanes.dropped += 1;
        }
        drop(lanes);
        self.stirred.notify_one();
    }

    /// An answer. A viewer that leaves no room for it is closed.
    pub(crate) fn answer(&self, answer: Out) {
        let mut lanes = self.lanes();
        lanes.answer_bytes += answer.len();
        lanes.answers.push_back(answer);
        if lanes.answers.len() > ANSWERS || lanes.answer_bytes > ANSWER_BYTES {
            *lanes = Lanes { closed: true, dropped: lanes.dropped, ..Lanes::default() };
        }
        drop(lanes);
        self.stirred.notify_one();
    }

    /// The next to go out: answers first, messages only where they may.
    pub(crate) fn take(&self, messages: bool) -> Option<Out> {
        let mut lanes = self.lanes();
        if let Some(answer) = lanes.answers.pop_front() {
            lanes.answer_bytes -= answer.len();
            return Some(answer);
        }
        let message = if messages { lanes.messages.pop_front()? } else { return None };
        lanes.bytes -= message.len();
        Some(Out::Binary(message))
    }

    /// Messages that were lost since the start.
    pub(crate) fn dropped(&self) -> u64 {
        self.lanes().dropped
    }

    pub(crate) fn is_closed(&self) -> bool {
        self.lanes().closed
    }

    fn lanes(&self) -> MutexGuard<'_, Lanes> {
        self.lanes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_messages_are_lost_and_counted() {
        let queue = Queue::default();
        for number in 0..MESSAGES + 10 {
            queue.message(Bytes::copy_from_slice(&number.to_le_bytes()));
        }
        assert_eq!(queue.dropped(), 10);
        assert_eq!(
            queue.take(true),
            Some(Out::Binary(Bytes::copy_from_slice(&10_usize.to_le_bytes())))
        );
    }

    #[test]
    fn large_messages_do_not_fill_the_memory() {
        let queue = Queue::default();
        for _ in 0..100 {
            queue.message(Bytes::from(vec![0; BYTES / 4]));
        }
        assert_eq!(queue.dropped(), 96);
        assert!(queue.lanes().bytes <= BYTES);
    }

    #[test]
    fn answers_come_first_and_are_never_lost() {
        let queue = Queue::default();
        queue.message(Bytes::from_static(b"message"));
        queue.answer(Out::Text("answer".into()));
        assert_eq!(queue.take(false), Some(Out::Text("answer".into())));
        assert_eq!(queue.take(false), None);
        assert!(!queue.is_closed());
        for _ in 0..=ANSWERS {
            queue.answer(Out::Text("answer".into()));
        }
        assert!(queue.is_closed());
        assert_eq!(queue.take(true), None);
    }
}
