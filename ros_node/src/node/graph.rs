//! Who else is there, as a node sees it.

use std::sync::atomic::Ordering;

use futures::StreamExt;
use msgs::topics::Qos;
use ros2_client::builtin_topics::ros_discovery;
use rustdds::TopicKind;

use super::topics::sent_ns;
use super::{RosNode, profile};
use crate::graph::{self, ParticipantId, ParticipantNodes};
use crate::twins::Twins;
use crate::{Graph, RosNodeError};

impl RosNode {
    /// Listens to who else is there. What is heard arrives over the next seconds, this node's own
    /// participant included.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn watch_graph(&self) -> Result<Graph, RosNodeError> {
        let graph = Graph::default();
        self.watch_into(&graph)?;
        Ok(graph)
    }

    /// The participant's own view of who is there: from the first call on it is kept, once for all
    /// its nodes, for as long as this node is there.
    pub(crate) fn graph(&self) -> Result<Graph, RosNodeError> {
        let graph = &self.shared.graph;
        if !self.shared.graph_is_watched.swap(true, Ordering::AcqRel) {
            self.watch_into(graph)?;
        }
        Ok(graph.clone())
    }

    /// Another node of this one's name in another participant, in a sentence.
    ///
    /// It is told by [`lifecycle::Lifecycle`](crate::lifecycle::Lifecycle) too, which keeps the
    /// later one of two from working.
    #[must_use]
    pub fn twin(&self) -> Option<String> {
        self.twins().ok()?.found().map(|twin| twin.to_string())
    }

    /// Subscribers of this node's topics that do not keep up now. Each loses what it does not fetch
    /// in time; the log says who it is.
    #[must_use]
    pub fn lagging_readers(&self) -> u64 {
        self.shared.lagging.count(&self.logger)
    }

    /// This process's participant.
    #[must_use]
    pub fn participant(&self) -> ParticipantId {
        self.shared.context.participant_entities_info().gid().to_bytes16()
    }

    /// Looks for other nodes of this name.
    pub(crate) fn twins(&self) -> Result<Twins, RosNodeError> {
        Ok(Twins {
            graph: self.graph()?,
            name: self.identity.qualified(),
            own: self.participant(),
            began: self.began,
        })
    }

    fn watch_into(&self, graph: &Graph) -> Result<(), RosNodeError> {
        // Many participants tell of themselves at the same moment.
        let qos = profile(Qos { depth: 100, transient_local: true });
        let participant = self.shared.context.domain_participant();
        let subscription = self.with_node("a subscription", graph::TOPIC, |node| {
            let topic = participant
                .create_topic(
                    graph::TOPIC.to_owned(),
                    graph::TYPE.to_owned(),
                    &ros_discovery::QOS_PUB,
                    TopicKind::NoKey,
                )
                .map_err(|e| e.to_string())?;
            node.create_subscription::<ParticipantNodes>(&topic, Some(qos))
                .map_err(|e| e.to_string())
        })?;
        let heard = graph.clone();
        self.spawn(async move {
            let mut stream = std::pin::pin!(subscription.async_stream());
            while let Some(next) = stream.next().await {
                // What cannot be read is of another version of ROS: that participant stays unknown.
                if let Ok((told, info)) = next {
                    heard.take(told, sent_ns(&info));
                }
            }
        });
        Ok(())
    }
}
