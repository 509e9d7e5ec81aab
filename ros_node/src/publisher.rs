//! A typed publisher.

use ros2_client::Message;

use crate::RosNodeError;

/// Publishes messages of one type on one topic. Sending takes locks and may wait for the network:
/// never call it from a control thread.
pub struct Publisher<M: Message> {
    topic: String,
    publisher: ros2_client::Publisher<M>,
}

impl<M: Message> Publisher<M> {
    pub(crate) fn new(topic: String, publisher: ros2_client::Publisher<M>) -> Self {
        Self { topic, publisher }
    }

    /// Absolute name of the topic, after remapping.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// Sends a message.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take it within a few milliseconds.
    pub fn publish(&self, message: M) -> Result<(), RosNodeError> {
        self.publisher.publish(message).map_err(|error| RosNodeError::Publish {
            topic: self.topic.clone(),
            detail: error.to_string(),
        })
    }
}
