//! What the nodes of this process say, heard without the network.
//!
//! Whoever only looks at a process's own nodes need not have every message sent to itself: it is
//! told where they are published, on the thread that publishes. What changes something still goes
//! through the nodes' services, as anybody's does.

use std::sync::{Arc, OnceLock};
use std::time::{SystemTime, UNIX_EPOCH};

use msgs::RosMessage;

use crate::LogLevel;

/// One thing that a node of this process said.
pub enum Inside<'a> {
    /// A message on a topic.
    Message {
        /// Absolute name of the topic, after remapping.
        topic: &'a str,
        /// Its type, as in `sensor_msgs/msg/JointState`.
        kind: &'a str,
        /// When \[ns since the epoch\].
        stamp_ns: u64,
        /// Makes the message as CDR; `None` if that cannot be.
        cdr: &'a dyn Fn() -> Option<Vec<u8>>,
    },
    /// A line of the log.
    Line {
        /// The logger's name.
        node: &'a str,
        /// How much it matters.
        level: LogLevel,
        /// When \[ns since the epoch\].
        stamp_ns: u64,
        /// The line.
        text: &'a str,
    },
}

/// Whoever listens. It is called on the threads that publish, never on a control thread; it should
/// be short, and may not panic or wait.
pub type Listener = Arc<dyn Fn(Inside<'_>) + Send + Sync>;

/// The listener of one participant, once there is one.
#[derive(Clone, Default)]
pub(crate) struct Ears(Arc<OnceLock<Listener>>);

impl Ears {
    /// Sets the listener; false if there is one.
    pub(crate) fn listen(&self, listener: Listener) -> bool {
        self.0.set(listener).is_ok()
    }

    pub(crate) fn hear(&self, said: Inside<'_>) {
        if let Some(listener) = self.0.get() {
            listener(said);
        }
    }
}

/// Tells [`Ears`] of the messages of one publisher.
pub(crate) struct Told<M> {
    ears: Ears,
    kind: String,
    encode: fn(&M) -> Option<Vec<u8>>,
}

impl<M: RosMessage> Told<M> {
    pub(crate) fn new(ears: Ears) -> Self {
        Self { ears, kind: M::type_name(), encode: |message| msgs::cdr::encode(message).ok() }
    }
}

impl<M> Told<M> {
    pub(crate) fn tell(&self, topic: &str, message: &M) {
        if self.ears.0.get().is_none() {
            return;
        }
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let stamp_ns = u64::try_from(now.as_nanos()).unwrap_or(u64::MAX);
        let cdr = || (self.encode)(message);
        self.ears.hear(Inside::Message { topic, kind: &self.kind, stamp_ns, cdr: &cdr });
    }
}
