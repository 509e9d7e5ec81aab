//! Joins the domain for some seconds and writes down who is there and what they say of their
//! health.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use msgs::{diagnostic_msgs::DiagnosticStatus, topics};
use ros_node::{
    Arguments, Discovery, Participant, RosNodeError, SeenNode, Stop, lifecycle::RemoteLifecycle,
};

use super::heard::{Heard, is_ours};
use super::security;

/// Time in which everybody is found: a participant of Fast DDS that was there first takes 1.2 s.
const DISCOVERY: Duration = Duration::from_secs(3);
/// Time for an answer.
const ANSWER: Duration = Duration::from_secs(2);
/// Time for three reports of a node's health, which come once a second.
const HEALTH: Duration = Duration::from_millis(3500);

/// Joins, listens and leaves.
///
/// # Errors
/// [`RosNodeError`] if the network cannot be joined.
pub(super) fn listen(discovery: &Discovery, stop: &Stop) -> Result<Heard, RosNodeError> {
    let participant =
        Participant::join_with(discovery, Arguments::default().or_enclave(security::ENCLAVE))?;
    // In the clear everybody is seen, also those that a secured participant is not told of.
    let secured = participant.enclave().is_some();
    let scout = if secured {
        Some(Participant::join_with(
            discovery,
            Arguments { in_the_clear: true, ..Arguments::default() },
        )?)
    } else {
        None
    };
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
    let reporting = |nodes: &[SeenNode]| nodes.iter().any(|node| is_ours(&node.name));
    if !interrupted && reporting(&others()) {
        let began = Instant::now();
        while !interrupted && began.elapsed() < HEALTH {
            interrupted = stop.wait(Duration::from_millis(100));
        }
    }
    let nodes = others();
    let health = std::mem::take(&mut *health.lock().unwrap_or_else(PoisonError::into_inner));
    let mut participants = scout.as_ref().map(|scout| scout.others().known()).unwrap_or_default();
    for (who, other) in participant.others().known() {
        participants.entry(who).or_insert_with(|| other.clone()).standing = other.standing;
    }
    for own in [Some(&participant), scout.as_ref()].into_iter().flatten() {
        participants.remove(&own.prefix());
    }
    let mut heard = Heard { nodes, health, states: BTreeMap::new(), secured, participants };
    for name in heard.silent().into_iter().filter(|_| !interrupted) {
        // Whoever does not answer has no state that could be told.
        let state =
            RemoteLifecycle::new(&node, &name).and_then(|lifecycle| lifecycle.phase(ANSWER));
        if let Ok(state) = state {
            heard.states.insert(name, state.label());
        }
    }
    Ok(heard)
}
