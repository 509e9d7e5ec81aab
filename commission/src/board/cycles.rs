//! The cycles of the rig, for whoever draws them while they go by.

use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use rig_driver::Measurement;

/// Cycles that wait at most: 4 s at 1 kHz. What is more is lost.
const WAITING: usize = 4096;

/// A cycle that went by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Rig time of the commission before the turn that it is of \[s\].
    pub before: f64,
    /// What was seen; its time counts from the beginning of the turn.
    pub seen: Measurement,
    /// Where the shaft was to be and where it was \[rad\], in a turn that follows something.
    pub followed: Option<(f64, f64)>,
}

/// Where cycles go by; nowhere until somebody listens.
#[derive(Debug, Default)]
pub(super) struct Cycles(OnceLock<SyncSender<Cycle>>);

impl Cycles {
    /// Lets somebody listen; none where somebody does already.
    pub(super) fn listen(&self) -> Option<Receiver<Cycle>> {
        let (sender, receiver) = sync_channel(WAITING);
        self.0.set(sender).ok().map(|()| receiver)
    }

    /// A cycle goes by. For the thread of the loop: it waits for nobody, and allocates nothing.
    pub(super) fn pass(&self, cycle: Cycle) {
        if let Some(sender) = self.0.get() {
            // Who listens is behind, or has gone.
            let _ = sender.try_send(cycle);
        }
    }
}
