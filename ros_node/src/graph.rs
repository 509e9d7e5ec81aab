//! Who else is there: the nodes of a domain, as every participant tells them.
//!
//! Each participant of ROS 2 says on the topic `ros_discovery_info`, reliably and for latecomers,
//! which nodes it has; what it says later replaces what it said before. It is what they say of
//! themselves: without DDS Security nobody vouches for it.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use ros2_client::{Gid, Message, builtin_topics::ros_discovery};
use rustdds::GUID;
use serde::{Deserialize, Serialize};

use crate::one_writer::WriterId;

/// The graph's identifier of a participant.
pub type ParticipantId = [u8; 16];

/// What all participants together may tell: what is more is left out, so that strangers do not fill
/// the memory \[bytes\].
const MOST: usize = 8 << 20;
/// Writers that left which are remembered.
const LEFT: usize = 256;

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
pub struct Graph(Arc<Mutex<Known>>);

#[derive(Debug, Default)]
struct Known {
    participants: BTreeMap<ParticipantId, Vec<KnownNode>>,
    /// What they take \[bytes\].
    size: usize,
    left: VecDeque<WriterId>,
}

#[derive(Debug)]
struct KnownNode {
    name: String,
    writers: Vec<ParticipantId>,
    readers: Vec<ParticipantId>,
    /// When it was told of first, by the teller's clock \[ns since the epoch\]; none if the teller
    /// did not say.
    since: Option<u64>,
}

impl Known {
    fn forget(&mut self, participant: &ParticipantId) -> Option<Vec<KnownNode>> {
        let nodes = self.participants.remove(participant);
        self.size -= nodes.as_deref().map_or(0, size);
        nodes
    }
}

/// What a participant's nodes take \[bytes\].
fn size(nodes: &[KnownNode]) -> usize {
    let one = |node: &KnownNode| {
        size_of::<KnownNode>()
            + node.name.len()
            + size_of_val(&*node.writers)
            + size_of_val(&*node.readers)
    };
    size_of::<ParticipantId>() + nodes.iter().map(one).sum::<usize>()
}

impl Graph {
    /// Takes what a participant says of itself, at that time of its clock \[ns since the epoch\].
    pub(crate) fn take(&self, told: ParticipantNodes, at: Option<u64>) {
        let mut known = self.known();
        let before = known.forget(&told.participant);
        let since = |name: &str| {
            let same = before.iter().flatten().find(|node| node.name == name);
            same.map_or(at, |same| same.since)
        };
        let nodes = told.nodes.into_iter().map(|node| {
            let name = join(&node.namespace, &node.name);
            KnownNode { since: since(&name), name, writers: node.writers, readers: node.readers }
        });
        let nodes: Vec<_> = nodes.collect();
        let size = size(&nodes);
        if !nodes.is_empty() && known.size + size <= MOST {
            known.size += size;
            known.participants.insert(told.participant, nodes);
        }
    }

    /// Participants were lost.
    pub(crate) fn lost(&self, is_lost: impl Fn(&GUID) -> bool) {
        let mut known = self.known();
        let lost: Vec<_> = known
            .participants
            .keys()
            .filter(|id| is_lost(&GUID::from(Gid::from(**id))))
            .copied()
            .collect();
        for id in lost {
            known.forget(&id);
        }
    }

    /// A writer was lost.
    pub(crate) fn lost_writer(&self, writer: WriterId) {
        let left = &mut self.known().left;
        if left.len() == LEFT {
            left.pop_front();
        }
        left.push_back(writer);
    }

    /// Whether a writer is known to have left.
    #[must_use]
    pub fn has_left(&self, writer: WriterId) -> bool {
        self.known().left.contains(&writer)
    }

    /// Every node, in the order of names; a node that two participants have is there twice.
    #[must_use]
    pub fn nodes(&self) -> Vec<SeenNode> {
        let known = self.known();
        let mut nodes: Vec<SeenNode> = known
            .participants
            .iter()
            .flat_map(|(participant, nodes)| {
                nodes
                    .iter()
                    .map(|node| SeenNode { name: node.name.clone(), participant: *participant })
            })
            .collect();
        nodes.sort();
        nodes
    }

    /// The node that a writer belongs to, as its participant tells it.
    #[must_use]
    pub fn node_of(&self, writer: WriterId) -> Option<String> {
        self.owner(writer.0, |node| &node.writers)
    }

    /// The node that a reader belongs to, as its participant tells it.
    #[cfg_attr(not(feature = "mended"), allow(dead_code))]
    pub(crate) fn node_of_reader(&self, reader: [u8; 16]) -> Option<String> {
        self.owner(reader, |node| &node.readers)
    }

    fn owner(&self, endpoint: [u8; 16], of: fn(&KnownNode) -> &[ParticipantId]) -> Option<String> {
        let known = self.known();
        // The entity of a participant itself has another ending; what comes before is the same.
        let its = known.participants.iter().filter(|(id, _)| id[..12] == endpoint[..12]);
        let mut nodes = its.flat_map(|(_, nodes)| nodes);
        let found = nodes.clone().find(|node| of(node).contains(&endpoint));
        let alone = || nodes.next().filter(|_| nodes.next().is_none());
        found.or_else(alone).map(|node| node.name.clone())
    }

    /// Nodes of that name in other participants than `own`, each with the time at which it was
    /// first told of by its own clock \[ns since the epoch\].
    pub(crate) fn namesakes(
        &self,
        name: &str,
        own: ParticipantId,
    ) -> Vec<(ParticipantId, Option<u64>)> {
        let known = self.known();
        let others = known.participants.iter().filter(|(id, _)| **id != own);
        let named = others.flat_map(|(id, nodes)| {
            nodes.iter().filter(|node| node.name == name).map(|node| (*id, node.since))
        });
        named.collect()
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
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
            readers: vec![reader(participant, name.as_bytes()[0])],
            writers: vec![writer(participant, name.as_bytes()[0]).0],
        };
        ParticipantNodes { participant: [participant; 16], nodes: nodes.iter().map(node).collect() }
    }

    fn writer(participant: u8, number: u8) -> WriterId {
        let mut id = [participant; 16];
        id[12..].copy_from_slice(&[0, 0, number, 3]);
        WriterId(id)
    }

    fn reader(participant: u8, number: u8) -> [u8; 16] {
        let mut id = writer(participant, number).0;
        id[15] = 4;
        id
    }

    #[test]
    fn what_a_participant_says_later_replaces_what_it_said_before() {
        let graph = Graph::default();
        graph.take(told(1, &[("/", "b"), ("/axis_1", "b")]), None);
        graph.take(told(2, &[("/", "b")]), None);
        let names = || graph.nodes().into_iter().map(|node| node.name).collect::<Vec<_>>();
        assert_eq!(names(), ["/axis_1/b", "/b", "/b"]);
        graph.take(told(1, &[]), None);
        assert_eq!(graph.nodes(), [SeenNode { name: "/b".into(), participant: [2; 16] }]);
        graph.lost(|id| *id == GUID::from(Gid::from([2; 16])));
        assert_eq!(graph.nodes(), []);
    }

    #[test]
    fn a_writer_has_the_name_of_its_node() {
        let graph = Graph::default();
        graph.take(told(1, &[("/", "controller"), ("/", "observer")]), None);
        graph.take(told(2, &[("/", "one")]), None);
        assert_eq!(graph.node_of(writer(1, b'o')).as_deref(), Some("/observer"));
        assert_eq!(graph.node_of(writer(1, b'x')), None, "one of two nodes");
        assert_eq!(
            graph.node_of(writer(2, b'x')).as_deref(),
            Some("/one"),
            "the only node there is"
        );
        assert_eq!(graph.node_of(writer(3, b'o')), None);
        assert_eq!(graph.node_of_reader(reader(1, b'o')).as_deref(), Some("/observer"));
        assert_eq!(graph.node_of_reader(reader(1, b'x')), None, "one of two nodes");
    }

    #[test]
    fn a_node_is_as_old_as_the_first_that_was_told_of_it() {
        let graph = Graph::default();
        graph.take(told(1, &[("/", "rig")]), Some(5));
        graph.take(told(1, &[("/", "rig"), ("/", "more")]), Some(9));
        graph.take(told(2, &[("/", "rig")]), Some(7));
        assert_eq!(graph.namesakes("/rig", [2; 16]), [([1; 16], Some(5))]);
        assert_eq!(graph.namesakes("/more", [2; 16]), [([1; 16], Some(9))]);
        assert_eq!(graph.namesakes("/rig", [1; 16]), [([2; 16], Some(7))]);
    }

    #[test]
    fn many_participants_fill_no_memory() {
        let graph = Graph::default();
        for number in 0..200_000u32 {
            let mut one = told(1, &[("/", "b")]);
            one.participant[..4].copy_from_slice(&number.to_be_bytes());
            graph.take(one, None);
        }
        let many = graph.nodes().len();
        assert!(many > 10_000 && many < 200_000 && graph.known().size <= MOST, "{many}");
        let mut long = told(1, &[("/", "b")]);
        long.nodes[0].name = "b".repeat(2 * MOST);
        graph.take(long, None);
        assert_eq!(graph.nodes().len(), many);
        graph.lost(|_| true);
        assert_eq!((graph.nodes().len(), graph.known().size), (0, 0));
        (0..1000).for_each(|_| graph.lost_writer(writer(1, 1)));
        graph.lost_writer(writer(1, 2));
        assert!(graph.has_left(writer(1, 2)) && graph.known().left.len() == LEFT);
    }
}
