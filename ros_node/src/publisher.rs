//! A typed publisher.

use msgs::RosMessage;

use crate::RosNodeError;

/// Publishes messages of one type on one topic. Sending takes locks and may wait for the network: never call it from a
/// control thread.
pub struct Publisher<M: RosMessage> {
    topic: &'static str,
    publisher: ros2_client::Publisher<M>,
}

impl<M: RosMessage> Publisher<M> {
    pub(crate) fn new(topic: &'static str, publisher: ros2_client::Publisher<M>) -> Self {
        Self { topic, publisher }
    }

    /// Sends a message.
    ///
    /// # Errors
    /// [`RosNodeError::Publish`] if the middleware does not take it within a few milliseconds.
    pub fn publish(&self, message: M) -> Result<(), RosNodeError> {
        self.publisher
            .publish(message)
            .map_err(|error| RosNodeError::Publish { topic: self.topic, detail: error.to_string() })
    }
}
