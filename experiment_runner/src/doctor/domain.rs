//! Joins the domain for some seconds and writes down who is there and what they say of their health.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use msgs::{diagnostic_msgs::DiagnosticStatus, topics};
use ros_node::{Discovery, Participant, RosNodeError, SeenNode, Stop};

/// Time in which everybody is found: a participant of Fast DDS that was there first takes 1.2 s.
const DISCOVERY: Duration = Duration::from_secs(3);
/// Time for three reports of a node's health, which come once a second.
const HEALTH: Duration = Duration::from_millis(3500);

/// What was heard on a domain.
#[derive(Debug, Clone, Default)]
pub(super) struct Heard {
    /// The other nodes.
    pub(super) nodes: Vec<SeenNode>,
    /// What each component said of itself, in order; by its name in `/diagnostics`.
    pub(super) health: BTreeMap<String, Vec<DiagnosticStatus>>,
}

/// Joins, listens and leaves.
///
/// # Errors
/// [`RosNodeError`] if the network cannot be joined.
pub(super) fn listen(discovery: &Discovery, stop: &Stop) -> Result<Heard, RosNodeError> {
    let participant = Participant::join(discovery)?;
    let node = participant.node(&format!("frictionlab_doctor_{}", std::process::id()))?;
    let own = node.identity().qualified();
    let graph = node.watch_graph()?;
    let health: Arc<Mutex<BTreeMap<String, Vec<DiagnosticStatus>>>> = Arc::default();
    let heard = Arc::clone(&health);
    node.subscribe(&topics::DIAGNOSTICS, move |message| {
        let mut heard = heard.lock().unwrap_or_else(PoisonError::into_inner);
        for status in message.status {
            heard.entry(status.name.clone()).or_default().push(status);
        }
    })?;
    let others = || graph.nodes().into_iter().filter(|seen| seen.name != own).collect::<Vec<_>>();
    let mut interrupted = stop.wait(DISCOVERY);
    // Only the laboratory's nodes tell their health.
    let reporting = |nodes: &[SeenNode]| nodes.iter().any(|node| super::participants::is_ours(&node.name));
    if !interrupted && reporting(&others()) {
        let began = Instant::now();
        while !interrupted && began.elapsed() < HEALTH {
            interrupted = stop.wait(Duration::from_millis(100));
        }
    }
    let nodes = others();
    let health = std::mem::take(&mut *health.lock().unwrap_or_else(PoisonError::into_inner));
    Ok(Heard { nodes, health })
}
