//! Who else is there: the nodes of a domain, as every participant tells them.
//!
//! Each participant of ROS 2 says on the topic `ros_discovery_info`, reliably and for latecomers, which nodes it has; what it says later replaces what it
//! said before.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

use ros2_client::{Message, builtin_topics::ros_discovery};
use serde::{Deserialize, Serialize};

/// The graph's identifier of a participant.
pub type ParticipantId = [u8; 16];

/// One node as its participant tells it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct SeenNode {
    /// Namespace and name, as in `/axis_1/controller`.
    pub name: String,
    /// The participant it belongs to.
    pub participant: ParticipantId,
}

/// The nodes that were heard of. Clones are one.
#[derive(Debug, Clone, Default)]
pub struct Graph(Arc<Mutex<BTreeMap<ParticipantId, Vec<String>>>>);

impl Graph {
    /// Takes what a participant says of itself.
    pub(crate) fn take(&self, told: ParticipantNodes) {
        let names = told.nodes.iter().map(|node| join(&node.namespace, &node.name)).collect();
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(told.participant, names);
    }

    /// Every node, in the order of names; a node that two participants have is there twice.
    #[must_use]
    pub fn nodes(&self) -> Vec<SeenNode> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut nodes: Vec<SeenNode> = known
            .iter()
            .flat_map(|(participant, names)| {
                names.iter().map(|name| SeenNode { name: name.clone(), participant: *participant })
            })
            .collect();
        nodes.sort();
        nodes
    }
}

fn join(namespace: &str, name: &str) -> String {
    format!("{}/{name}", namespace.trim_end_matches('/'))
}

/// `rmw_dds_common/msg/ParticipantEntitiesInfo` as it travels.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct ParticipantNodes {
    participant: ParticipantId,
    nodes: Vec<NodeEntities>,
}

impl Message for ParticipantNodes {}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct NodeEntities {
    namespace: String,
    name: String,
    readers: Vec<ParticipantId>,
    writers: Vec<ParticipantId>,
}

/// Name of the topic as DDS has it.
pub(crate) const TOPIC: &str = ros_discovery::TOPIC_NAME;
/// Its type as DDS has it.
pub(crate) const TYPE: &str = ros_discovery::TYPE_NAME;

#[cfg(test)]
mod tests {
    use super::*;

    fn told(participant: u8, nodes: &[(&str, &str)]) -> ParticipantNodes {
        let node = |&(namespace, name): &(&str, &str)| NodeEntities {
            namespace: namespace.into(),
            name: name.into(),
            readers: Vec::new(),
            writers: Vec::new(),
        };
        ParticipantNodes { participant: [participant; 16], nodes: nodes.iter().map(node).collect() }
    }

    #[test]
    fn what_a_participant_says_later_replaces_what_it_said_before() {
        let graph = Graph::default();
        graph.take(told(1, &[("/", "b"), ("/axis_1", "b")]));
        graph.take(told(2, &[("/", "b")]));
        let names = || graph.nodes().into_iter().map(|node| node.name).collect::<Vec<_>>();
        assert_eq!(names(), ["/axis_1/b", "/b", "/b"]);
        graph.take(told(1, &[]));
        assert_eq!(graph.nodes(), [SeenNode { name: "/b".into(), participant: [2; 16] }]);
    }
}
