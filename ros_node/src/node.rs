//! A node that answers and leaves cleanly.

use std::{
    sync::{Arc, mpsc},
    time::Duration,
};

use msgs::{
    RosMessage,
    topics::{Qos, Topic},
};
use ros2_client::{
    MessageTypeName, Name, Node, NodeName, NodeOptions,
    qos::{Durability, History, QosProfile, WhenFull},
};

use crate::{Publisher, RosNodeError, participant::Shared};

/// How long a leaving node waits for its background work.
const LEAVING: Duration = Duration::from_secs(2);

/// A node of the ROS graph. Dropped, it takes its name off the graph.
pub struct RosNode {
    name: String,
    // `None` only while it is being dropped.
    node: Option<Node>,
    spinner_ended: mpsc::Receiver<()>,
    _shared: Arc<Shared>,
}

impl RosNode {
    pub(crate) fn start(shared: Arc<Shared>, name: &str) -> Result<Self, RosNodeError> {
        let error = |detail: String| RosNodeError::Create { what: format!("the node /{name}"), detail };
        let node_name = NodeName::new("/", name).map_err(|e| error(e.to_string()))?;
        let options = NodeOptions::new().enable_rosout(true);
        let mut node = shared.context.new_node(node_name, options).map_err(|e| error(e.to_string()))?;
        let spinner = node.spinner().map_err(|e| error(e.to_string()))?;
        let (ended, spinner_ended) = mpsc::channel();
        shared.runtime.spawn(async move {
            // A spinner that cannot run leaves the node deaf but publishing; there is nobody to tell here.
            let _ = spinner.spin().await;
            let _ = ended.send(());
        });
        Ok(Self { name: name.to_owned(), node: Some(node), spinner_ended, _shared: shared })
    }

    /// Name of the node, without its namespace.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// A publisher on a topic, with the topic's quality of service.
    ///
    /// # Errors
    /// [`RosNodeError::Create`] if the middleware refuses.
    pub fn publisher<M: RosMessage>(&mut self, topic: &Topic<M>) -> Result<Publisher<M>, RosNodeError> {
        let error =
            |detail: String| RosNodeError::Create { what: format!("a publisher on {}", topic.name), detail };
        let node = self.node.as_mut().ok_or_else(|| error("the node is leaving".into()))?;
        let name = Name::parse(topic.name).map_err(|e| error(e.to_string()))?;
        let type_name = MessageTypeName::new(M::DEFINITION.package, M::DEFINITION.name);
        let qos = profile(topic.qos);
        let dds_topic = node.create_topic(&name, type_name, &qos).map_err(|e| error(e.to_string()))?;
        let publisher = node.create_publisher(&dds_topic, Some(qos)).map_err(|e| error(e.to_string()))?;
        Ok(Publisher::new(topic.name, publisher))
    }
}

impl Drop for RosNode {
    fn drop(&mut self) {
        // The node tells its spinner to stop. The spinner holds a part of the participant, so wait for it: only then does
        // the name vanish at once from other people's graphs.
        drop(self.node.take());
        let _ = self.spinner_ended.recv_timeout(LEAVING);
    }
}

fn profile(qos: Qos) -> QosProfile {
    let durability = if qos.transient_local { Durability::TransientLocal } else { Durability::Volatile };
    // A reader that does not keep up may cost the publishing thread a moment, not a tenth of a second as by default.
    QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_millis(5)))
        .durability(durability)
        .history(History::KeepLast { depth: qos.depth as usize })
}
