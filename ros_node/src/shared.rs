//! What the participant of a process and its nodes hold together.

use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::atomic::{AtomicBool, AtomicU8};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use ros2_client::Context;
use tokio::runtime::Runtime;

use crate::apart::Apart;
use crate::hearing::Hearers;
use crate::inside::Ears;
use crate::lagging::Lagging;
use crate::middleware::Leave;
use crate::security::{Others, Protection};
use crate::{Arguments, Graph, terminal};

/// States in which the managed nodes of a process were last, by their absolute names.
pub(crate) type LastPhases = Mutex<BTreeMap<String, Arc<AtomicU8>>>;

/// What participant and nodes hold together. The fields are dropped in this order: the runtime
/// last, so that nothing runs on a participant that is gone.
pub(crate) struct Shared {
    pub(crate) context: Context,
    pub(crate) runtime: Workers,
    pub(crate) arguments: Arguments,
    /// Who can hear the answers of the nodes' services.
    pub(crate) hearers: Arc<Hearers>,
    /// Hears of others, apart: answers wait for it. `None` only while this is being dropped.
    pub(crate) following: Option<Apart>,
    /// Subscribers that do not keep up.
    pub(crate) lagging: Arc<Lagging>,
    /// Who else is there; it is filled once somebody wants to know.
    pub(crate) graph: Graph,
    pub(crate) graph_is_watched: AtomicBool,
    /// Who listens to the nodes of this process.
    pub(crate) ears: Ears,
    /// Of the life before; empty in the first.
    pub(crate) last_phases: Arc<LastPhases>,
    pub(crate) protection: Protection,
    pub(crate) others: Arc<Others>,
    /// Anybody on the network can command the nodes, and nobody has been told.
    pub(crate) open: AtomicBool,
    /// A node has said what it makes of `RMW_IMPLEMENTATION`.
    pub(crate) rmw_is_told: AtomicBool,
    /// Ends when all else is gone.
    pub(crate) leave: Leave,
}

/// The threads of the nodes' background work. Dropped, they end, but one that is stuck is not
/// waited for.
pub(crate) struct Workers(pub(crate) Option<Runtime>);

impl Deref for Workers {
    type Target = Runtime;

    fn deref(&self) -> &Runtime {
        self.0.as_ref().expect("there until it is dropped")
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        if let Some(runtime) = self.0.take() {
            runtime.shutdown_timeout(LEAVING);
        }
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.leave.begin();
        // It holds a part of the participant, which leaves when nobody holds it any more.
        if let Some(following) = self.following.take() {
            following.join(LEAVING);
        }
        // What the nodes said last.
        terminal::flush();
    }
}

/// Longest wait for what follows the participant's events to end.
const LEAVING: Duration = Duration::from_secs(1);
