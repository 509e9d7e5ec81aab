//! A typed publisher.

use ros2_client::Message;

use crate::RosNodeError;
use crate::inside::Told;

/// Publishes messages of one type on one topic. Sending takes locks and may wait for the network:
/// never call it from a control thread.
pub struct Publisher<M: Message> {
    topic: String,
    publisher: ros2_client::Publisher<M>,
    /// Those who listen in this process, for messages whose bytes are known.
    told: Option<Told<M>>,
}

impl<M: Message> Publisher<M> {
    pub(crate) fn new(topic: String, publisher: ros2_client::Publisher<M>) -> Self {
        Self { topic, publisher, told: None }
    }

    /// Has those hear it who listen in this process.
    pub(crate) fn heard_inside(mut self, told: Told<M>) -> Self {
        self.told = Some(told);
        self
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
        if let Some(told) = &self.told {
            told.tell(&self.topic, &message);
        }
        self.publisher.publish(message).map_err(|error| RosNodeError::Publish {
            topic: self.topic.clone(),
            detail: error.to_string(),
        })
    }
}
