//! Whoever looks on while this process writes bags.

use std::sync::OnceLock;

/// Is called with topic, time \[ns since the epoch\] and CDR of every message that is written, on
/// the thread that writes. It should be short, and may not panic or wait.
pub type Listener = Box<dyn Fn(&str, u64, &[u8]) + Send + Sync>;

static LISTENER: OnceLock<Listener> = OnceLock::new();

/// Has a listener hear what this process writes into bags from now on. There is one listener; false
/// if there was one before.
pub fn listen(listener: Listener) -> bool {
    LISTENER.set(listener).is_ok()
}

/// Tells it of a message.
pub(super) fn hear(topic: &str, stamp_ns: u64, bytes: &[u8]) {
    if let Some(listener) = LISTENER.get() {
        listener(topic, stamp_ns, bytes);
    }
}
